//! Options of the estimation.

use super::prior::Known;
use crate::identify::shrinkage::GivenInertias;
use ::identify::iterative::Weight;
use ::identify::least_squares::{Prior, SolveOptions};
use physics::effects::Term;
use serde::{Deserialize, Serialize};

/// Estimator of the parameters by least squares.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Estimator {
    /// Ordinary least squares: equal weight for every joint's torque error.
    Ols,
    /// Weighted least squares: rows weighted by the inverse standard deviation of their joint's residual.
    #[default]
    Wls,
    /// Weighted least squares as `Wls`, with rows reweighted by their own residual until outliers have no influence.
    Irls,
    /// Iterative approach of Han et al. (2020): covariance between joints, outliers, and on joints whose friction
    /// is viscous and Coulomb alone the exponent of speed.
    Iterative,
}

/// Condition that every link is a possible body.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Lmi {
    /// Condition never imposed.
    #[default]
    Off,
    /// Imposed in the last step.
    Last,
    /// Condition imposed in every step.
    Every,
}

/// Ridge without a prior, relative to the norm of each column.
const RIDGE: f64 = 3e-5;

/// Ridge towards a prior, relative to the norm of each column. A column keeps the prior's value where less than
/// this part of it is independent of the others.
const PRIOR_RIDGE: f64 = 0.1;

/// Options of the estimation.
#[derive(Clone, Debug)]
pub struct EstimatorOptions {
    /// Estimator to use. Default [`Estimator::Wls`].
    pub estimator: Estimator,
    /// Weight function of [`Estimator::Irls`] and [`Estimator::Iterative`]. Default: hard, 3 standard deviations.
    pub weight: Weight,
    /// Condition on possible links. Default off.
    pub lmi: Lmi,
    /// Prior parameters towards which the ridge pulls. Default none: zero.
    pub prior: Option<Known>,
    /// Ridge relative to the norm of each column. Default 3e-5, with a prior 0.1.
    pub ridge: Option<f64>,
    /// Prior from the given inertias; for least squares without outliers alone. Default: none.
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
    /// These options, but with weighted least squares and without the condition on links, for a first estimate.
    pub fn quick(&self) -> Self {
        Self {
            estimator: Estimator::Wls,
            lmi: Lmi::Off,
            ..self.clone()
        }
    }

    pub(super) fn ridge(&self) -> f64 {
        let default = if self.prior.is_some() {
            PRIOR_RIDGE
        } else {
            RIDGE
        };
        self.ridge.unwrap_or(default)
    }

    /// Options of the solver for `base` base parameters and the terms.
    pub(super) fn solve_options(&self, base: usize, terms: &[Vec<Term>]) -> SolveOptions {
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
