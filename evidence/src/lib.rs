//! Decides which hypotheses a set of data supports, by one rule: posterior odds = evidence × prior odds.
//!
//! A hypothesis says that some parameters differ from their given values; what it frees has a Gaussian prior, everything
//! else keeps its value. The log likelihood is quadratic about a fit ([`Quadratic`]), so that the evidence of every
//! set of hypotheses is in closed form (Laplace's method; MacKay, 2003, chapter 28). Nothing here knows of
//! robots, torque or motion.
#![forbid(unsafe_code)]

mod quadratic;
mod search;

pub use quadratic::{Mode, Prior, Quadratic};
pub use search::{Decision, Family, Hypothesis, Swap, about, decide, log_prior};
