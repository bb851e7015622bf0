//! Criterion J, in nats, by which one set of causes is compared with another; smaller is better.
//!
//! J = ½ Σ_j n_j log(MSE_j + floor_j²) + ½ Σ λ (β − m)² + cost · coefficients. MSE_j is the leave-one-fold-out mean
//! squared error of joint j, and n_j its number of independent samples. The second term penalises deviations of the
//! parameters from their given values. A cause with few coefficients is therefore preferred to many changed parameters
//! that explain the same torque.

use crate::algebra::fit::{Fit, Variable};
use crate::algebra::gram::Grams;
use crate::algebra::trial::Trial;
use crate::motion::scene::Scale;
use crate::settings::SearchSettings;
use crate::simulator::{NominalModel, link_sizes};
use physics::robot::{PARAMETERS_PER_LINK, Robot};

/// Factors on the tolerances of the given parameters, for links and friction apart: links are rarely as wrong as friction.
#[derive(Clone, Copy, Debug)]
pub struct Freedom {
    /// Factor on the tolerances of the inertial parameters.
    pub links: f64,
    /// Factor on the tolerances of Coulomb and viscous friction.
    pub friction: f64,
}

impl From<f64> for Freedom {
    /// Freedom with the same factor on links and on friction.
    fn from(both: f64) -> Self {
        Self {
            links: both,
            friction: both,
        }
    }
}

/// Criterion J for one recording, computed from the sums of products of its columns.
pub struct Objective<'a> {
    /// Sums of products of the dictionary's columns.
    pub grams: &'a Grams,
    /// Settings of the search, such as its penalties.
    pub settings: &'a SearchSettings,
    /// Typical torque of each joint, N·m (N), to which errors are relative.
    torque: Vec<f64>,
    /// Number of rows per independent sample of each joint's residual.
    correlated: Vec<f64>,
}

impl<'a> Objective<'a> {
    /// Criterion for sums of products of a recording with the sizes `scale`.
    pub fn new(grams: &'a Grams, scale: &Scale, settings: &'a SearchSettings) -> Self {
        Self {
            grams,
            settings,
            torque: scale.torque.clone(),
            correlated: match &scale.correlation_rows {
                Some(rows) => rows.iter().map(|r| settings.correlated(*r)).collect(),
                None => vec![settings.correlated_rows; scale.torque.len()],
            },
        }
    }

    /// Mean squared error of each joint plus the squared floor, (N·m)². `error`: squared error by joint, summed over rows.
    pub fn variance(&self, error: &[f64]) -> Vec<f64> {
        let floor = self.settings.floor;
        error
            .iter()
            .zip(&self.grams.total)
            .zip(&self.torque)
            .map(|((e, g), t)| e.max(0.0) / g.samples.max(1.0) + (floor * t).powi(2))
            .collect()
    }

    /// Mean squared error of each joint plus the squared floor, relative to the joint's squared torque.
    pub fn relative_variance(&self, error: &[f64]) -> Vec<f64> {
        let each = self.variance(error).into_iter().zip(&self.torque);
        each.map(|(v, t)| v / (t * t)).collect()
    }

    /// Root mean squared error of each joint relative to its torque. `error`: squared error by joint, summed over rows.
    pub fn relative(&self, error: &[f64]) -> Vec<f64> {
        let each = error.iter().zip(&self.grams.total).zip(&self.torque);
        each.map(|((e, g), t)| (e.max(0.0) / g.samples.max(1.0)).sqrt() / t)
            .collect()
    }

    /// Root mean square of the gap as given of each joint, relative to its torque.
    pub fn given(&self) -> Vec<f64> {
        self.relative(&self.grams.total.iter().map(|g| g.yy).collect::<Vec<_>>())
    }

    /// Number of independent samples of a joint's residual.
    fn independent(&self, joint: usize) -> f64 {
        self.grams.total[joint].samples / self.correlated[joint]
    }

    /// J from the squared error by joint, (N·m)², the penalty and the number of added coefficients, nats.
    pub fn value(&self, error: &[f64], penalty: f64, coefficients: usize) -> f64 {
        let misfit: f64 = self
            .variance(error)
            .iter()
            .enumerate()
            .map(|(j, v)| 0.5 * self.independent(j) * v.ln())
            .sum();
        misfit + 0.5 * penalty + self.settings.cost * coefficients as f64
    }

    /// J of a fit with `coefficients` beyond the base, nats.
    pub fn of_fit(&self, fit: &Fit, coefficients: usize) -> f64 {
        self.value(&fit.error(), fit.penalty(), coefficients)
    }

    /// J of a trial that adds columns to a fit, nats.
    pub fn of_trial(&self, trial: &Trial, coefficients: usize) -> f64 {
        self.value(&trial.error, trial.penalty, coefficients)
    }

    /// Weight of each joint's squared error in a fit, 1/(N·m)²: the inverse of its variance per independent sample.
    pub fn weights(&self, error: &[f64]) -> Vec<f64> {
        let each = self.variance(error).into_iter().zip(&self.correlated);
        each.map(|(v, rows)| 1.0 / (rows * v)).collect()
    }

    /// Fit of some variables. The weights of the joints depend on their errors, and are found in three passes.
    pub fn fit(&self, variables: Vec<Variable>) -> Fit<'a> {
        Fit::weighted(self.grams, variables, |error| self.weights(error), 3)
    }

    /// Variable of a candidate's column with a wide prior about zero. At one standard deviation its RMS torque is a
    /// multiple of the joint's typical torque.
    pub fn wide(&self, column: usize) -> Variable {
        let size = self.grams.column_rms(column, &self.torque);
        Variable::about_zero(column, (size / self.settings.wide).powi(2).max(1e-12))
    }

    /// Variables of the ten inertial parameters of a link that may be wrong, with wide priors about the given values.
    pub fn freed_link(&self, robot: &Robot, link: usize) -> Vec<Variable> {
        let first = PARAMETERS_PER_LINK * link;
        let sizes = link_sizes(&robot.joints()[link]);
        let variable = |(p, size): (usize, f64)| {
            Variable::about_zero(first + p, (self.settings.freed * size).powi(-2))
        };
        sizes.into_iter().enumerate().map(variable).collect()
    }

    /// Base variables: changes of the model's parameters, whose prior deviations are the tolerances times `freedom`. A
    /// friction coefficient that is zero in the model counts as missing and is free. One that was identified as zero
    /// counts as zero. A description without masses gets priors by torque. Links that the check of the description doubts
    /// get wide ones: by torque, too, where their own numbers are small.
    pub fn base(&self, model: &NominalModel, freedom: impl Into<Freedom>) -> Vec<Variable> {
        let (s, freedom) = (self.settings, freedom.into());
        let sizes = model.sizes();
        let joints = sizes.joints();
        let doubtful = sizes.doubtful_links();
        let mut deviations: Vec<f64> = Vec::new();
        for (joint, doubtful) in joints.iter().zip(doubtful) {
            let given = freedom.links * s.inertial_tolerance;
            let tolerance = if doubtful { given.max(s.freed) } else { given };
            let wide = |column| self.wide(column).precision.sqrt().recip();
            for size in link_sizes(joint) {
                deviations.push(match (model.has_masses(), doubtful) {
                    (false, _) => wide(deviations.len()),
                    (true, true) => (tolerance * size).max(wide(deviations.len())),
                    (true, false) => tolerance * size,
                });
            }
        }
        let guessed = sizes.doubtful_friction();
        let damping = joints.iter().map(|j| j.damping);
        let coulomb = joints.iter().map(|j| j.friction);
        for (given, guessed) in damping.chain(coulomb).zip(guessed.iter().chain(&guessed)) {
            let size = self
                .grams
                .column_rms(deviations.len(), &self.torque)
                .max(1e-9);
            let missing = given == 0.0 || *guessed;
            deviations.push(if missing && !model.is_identified() {
                s.missing / size
            } else {
                freedom.friction * (s.friction_tolerance * given).max(s.unreported / size)
            });
        }
        deviations
            .iter()
            .enumerate()
            .map(|(column, d)| Variable::about_zero(column, 1.0 / (d * d)))
            .collect()
    }
}
