//! What an estimator gives.

use super::options::{Estimator, Lmi};
use crate::identify::error::IdentifyError;
use ::identify::feasible::Feasible;
use ::identify::least_squares::{Estimate, Triangle};
use physics::effects::Term;
use serde::{Deserialize, Serialize};

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
pub(super) fn made_possible(
    mut estimate: Estimate,
    feasible: &Feasible,
) -> Result<Estimate, IdentifyError> {
    estimate.parameters.clone_from(&feasible.base);
    let covariance = estimate.covariance.clone();
    Ok(estimate.with_covariance(covariance)?)
}
