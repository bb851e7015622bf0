//! Bayesian comparison of sets of hypotheses on one set of data: posterior odds = ratio of evidences × prior odds.
//!
//! A hypothesis says that some parameters differ from their given values. Under it these parameters have a Gaussian
//! prior, and all others keep their given values. The log likelihood is quadratic about a fit ([`Quadratic`]). The
//! evidence of every set of hypotheses therefore has a closed form (Laplace approximation; MacKay, 2003, chapter 28).
//! Nothing here knows of robots, torque or motion.
#![forbid(unsafe_code)]

mod quadratic;
mod search;
mod temper;

pub use quadratic::{Mode, Prior, Quadratic};
pub use search::{Decision, Family, Hypothesis, Problem, Swap, log_prior};
pub use temper::tempered;
