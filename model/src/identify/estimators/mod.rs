//! The estimators of `physics::identify` on recordings.
//!
//! Ordinary and weighted least squares need the normal equations alone, whatever the number of samples;
//! reweighted and iterative ones keep the rows in memory.

mod passes;
mod possible;
mod prior;
mod rows;

pub use possible::constrained;
pub use prior::Known;

use crate::identify::design::Data;
use crate::identify::error::IdentifyError;
use crate::identify::shrinkage::GivenInertias;
use ndarray::Array2;
use physics::effects::Term;
use physics::identify::feasible::Feasible;
use physics::identify::iterative::Weight;
use physics::identify::least_squares::{Estimate, Prior, SolveOptions, Triangle};
use serde::{Deserialize, Serialize};

/// Which estimator.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Estimator {
    /// Ordinary least squares: every joint's torque error counts the same.
    Ols,
    /// Rows weighted by their joint's residual deviation.
    #[default]
    Wls,
    /// As `Wls`, and rows reweighted by their own residual until outliers have no say.
    Irls,
    /// The iterative approach of Han et al. (2020): covariance between joints, outliers, and on joints whose friction
    /// is viscous and Coulomb alone the exponent of speed.
    Iterative,
}

/// When every link must be a possible body.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Lmi {
    /// Never.
    #[default]
    Off,
    /// In the last step.
    Last,
    /// In every step.
    Every,
}

/// Ridge without a prior.
const RIDGE: f64 = 3e-5;
/// Ridge towards a prior: a column of which the others leave less than this part to itself keeps the prior's value.
const PRIOR_RIDGE: f64 = 0.1;

/// How parameters are estimated.
#[derive(Clone, Debug)]
pub struct EstimatorOptions {
    /// The estimator. Default [`Estimator::Wls`].
    pub estimator: Estimator,
    /// Weight function of [`Estimator::Irls`] and [`Estimator::Iterative`]. Default: hard, 3 deviations.
    pub weight: Weight,
    /// Physical feasibility. Default off.
    pub lmi: Lmi,
    /// What the ridge pulls towards. Default none: zero.
    pub prior: Option<Known>,
    /// Ridge relative to the norm of each column. Default 3e-5, with a prior 0.1.
    pub ridge: Option<f64>,
    /// How far the given inertias count; least squares without outliers alone. Default: not at all.
    pub given: Option<GivenInertias>,
}

impl Default for EstimatorOptions {
    fn default() -> Self {
        Self {
            estimator: Estimator::default(),
            weight: Weight::Hard { threshold: 3.0 },
            lmi: Lmi::default(),
            prior: None,
            ridge: None,
            given: None,
        }
    }
}

impl EstimatorOptions {
    /// The same with the fastest estimator, for a first look.
    pub fn quick(&self) -> Self {
        Self {
            estimator: Estimator::Wls,
            lmi: Lmi::Off,
            ..self.clone()
        }
    }

    fn ridge(&self) -> f64 {
        let default = if self.prior.is_some() {
            PRIOR_RIDGE
        } else {
            RIDGE
        };
        self.ridge.unwrap_or(default)
    }

    /// For `base` base parameters and these terms.
    fn solve_options(&self, base: usize, terms: &[Vec<Term>]) -> SolveOptions {
        SolveOptions {
            ridge: self.ridge(),
            prior: self.prior.as_ref().map(|known| {
                let mean = known.mean(base, terms);
                // The ridge is what pulls, in units of the columns; deviations are not known.
                let std = vec![f64::INFINITY; mean.len()];
                Prior { mean, std }
            }),
            ..SolveOptions::default()
        }
    }
}

/// How an estimate was made, for `model.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EstimatorReport {
    /// The estimator.
    pub estimator: Estimator,
    /// Physical feasibility.
    pub lmi: Lmi,
    /// Ridge relative to the norm of each column.
    pub ridge: f64,
    /// What the ridge pulled towards; none: zero.
    pub prior: Option<String>,
    /// Part of each link's size by which its parameters were expected to differ from the given ones; none: freely.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub given_part: Option<f64>,
    /// Covariance of the torque noise between joints, N²·m²; of independent joints, diagonal.
    pub noise: Vec<Vec<f64>>,
    /// Part of each joint's rows that was left out as outliers.
    pub left_out: Vec<f64>,
    /// Exponent of speed in each joint's friction, where it was estimated.
    pub exponents: Vec<Option<f64>>,
    /// Least-squares problems solved.
    pub solutions: usize,
    /// Whether every loop ended by its tolerance.
    pub converged: bool,
    /// Every how many samples one was used.
    pub every: usize,
}

/// An estimate of all parameters: base parameters, then each joint's terms.
pub struct Solution {
    /// The estimate, of possible links where these were asked for.
    pub estimate: Estimate,
    /// Parameters of the last step without that condition.
    pub free: Vec<f64>,
    /// Terms of each joint; those given, but for exponents found.
    pub terms: Vec<Vec<Term>>,
    /// Deviation of each joint's residual on the samples fitted; zero for a joint without any.
    pub residual_std: Vec<f64>,
    /// Triangle of the weighted rows.
    pub triangle: Triangle,
    /// The possible links, where asked for: standard parameters, then terms.
    pub feasible: Option<Feasible>,
    /// How it was made.
    pub report: EstimatorReport,
}

/// Estimates base parameters and `terms`; `load` is the torque that load-dependent terms see.
///
/// # Errors
/// Nothing to fit, or a system that cannot be solved.
pub fn solve(
    data: &Data,
    terms: Vec<Vec<Term>>,
    load: &[Array2<f64>],
    options: &EstimatorOptions,
) -> Result<Solution, IdentifyError> {
    match options.estimator {
        Estimator::Ols | Estimator::Wls => passes::solve(data, terms, load, options),
        Estimator::Irls | Estimator::Iterative => rows::solve(data, terms, load, options),
    }
}

/// Index of the first parameter of each joint's terms, and of the first one beyond all.
pub(crate) fn offsets(base: usize, terms: &[Vec<Term>]) -> (Vec<usize>, usize) {
    let mut next = base;
    let firsts = terms
        .iter()
        .map(|list| {
            let first = next;
            next += list.len();
            first
        })
        .collect();
    (firsts, next)
}

/// `estimate` with the parameters of possible links.
fn made_possible(mut estimate: Estimate, feasible: &Feasible) -> Result<Estimate, IdentifyError> {
    estimate.parameters.clone_from(&feasible.base);
    let covariance = estimate.covariance.clone();
    Ok(estimate.with_covariance(covariance)?)
}
