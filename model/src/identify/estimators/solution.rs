//! Result of an estimator.

use super::options::{Estimator, Lmi};
use crate::identify::error::IdentifyError;
use ::identify::feasible::Feasible;
use ::identify::least_squares::{Estimate, Triangle};
use physics::effects::Term;
use serde::{Deserialize, Serialize};

/// Report of an estimation, for `model.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EstimatorReport {
    /// Estimator that was used.
    pub estimator: Estimator,
    /// Condition on possible links that was imposed.
    pub lmi: Lmi,
    /// Ridge relative to the norm of each column.
    pub ridge: f64,
    /// Name of the prior towards which the ridge pulled; none: zero.
    pub prior: Option<String>,
    /// Prior deviation of the given inertias, relative to each link's size; none: no prior.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub given_part: Option<f64>,
    /// Covariance of the torque noise between joints, N²·m²; diagonal for independent joints.
    pub noise: Vec<Vec<f64>>,
    /// Part of each joint's rows that was left out as outliers.
    pub left_out: Vec<f64>,
    /// Exponent of speed in each joint's friction, where it was estimated.
    pub exponents: Vec<Option<f64>>,
    /// Number of least-squares problems solved.
    pub solutions: usize,
    /// Whether every loop ended by its tolerance.
    pub converged: bool,
    /// Step between the samples that were used.
    pub every: usize,
}

/// Solution of an estimation: all parameters (base parameters, then each joint's terms) with their report.
pub struct Solution {
    /// Estimate of the parameters; that of possible links where these were required.
    pub estimate: Estimate,
    /// Parameters of the last step without the condition of possible links.
    pub free: Vec<f64>,
    /// Terms of each joint; those given, except for exponents found.
    pub terms: Vec<Vec<Term>>,
    /// Standard deviation of each joint's residual on the fitted samples, N·m (N); zero for a joint without any.
    pub residual_std: Vec<f64>,
    /// Triangle of the weighted rows.
    pub triangle: Triangle,
    /// Standard parameters of the possible links, then terms; none where these were not required.
    pub feasible: Option<Feasible>,
    /// Report of the estimation.
    pub report: EstimatorReport,
}

/// Index of the first parameter of each joint's terms, and the total number of parameters.
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

/// `estimate` with its parameters replaced by those of possible links.
pub(super) fn made_possible(
    mut estimate: Estimate,
    feasible: &Feasible,
) -> Result<Estimate, IdentifyError> {
    estimate.parameters.clone_from(&feasible.base);
    let covariance = estimate.covariance.clone();
    Ok(estimate.with_covariance(covariance)?)
}
