//! Which estimator, and how.

use super::prior::Known;
use crate::identify::shrinkage::GivenInertias;
use ::identify::iterative::Weight;
use ::identify::least_squares::{Prior, SolveOptions};
use physics::effects::Term;
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

    pub(super) fn ridge(&self) -> f64 {
        let default = if self.prior.is_some() {
            PRIOR_RIDGE
        } else {
            RIDGE
        };
        self.ridge.unwrap_or(default)
    }

    /// For `base` base parameters and these terms.
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
