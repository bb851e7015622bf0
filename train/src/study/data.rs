//! Simulated recordings, and the residual of the published physics on their torque.

use super::arguments::Study;
use compensator::training::{Fold, Samples};
use datasets::Recording;
use datasets::folds::Motions;
use datasets::metrics::MOVING;
use datasets::periods::smooth_torque;
use datasets::prepare::{PrepareOptions, prepare};
use model::failure::Failure;
use model::identify::identification::IdentifyOptions;
use model::physics_fit::{FitError, FitOptions, fit_physics};
use model::predict::predict;
use model::residual::ResidualError;
use model::session::Session;
use ndarray::{Array2, Axis, concatenate};
use physics::robot::Robot;
use std::ops::Range;
use trials::protocols::{Protocol, Simulated, cached};

/// One recording: inputs and residual torque.
#[derive(Clone)]
pub struct Run {
    /// q, q̇, q̈ of all joints, shape (samples, 3·joints).
    pub inputs: Array2<f32>,
    /// Measured minus physics, N·m; shape (joints, samples), so that a joint is one piece.
    pub residual: Array2<f32>,
    /// Weight of each sample: 1 where the joint moves, else 0; shape (joints, samples). At standstill friction
    /// takes any value within its limits, which does not depend on the models compared here.
    moving: Array2<f32>,
    /// Measured torque, N·m, shape (samples, joints).
    pub tau: Array2<f64>,
    /// Range of the rows of each trajectory.
    pub segments: Vec<Range<usize>>,
    /// Motion that each trajectory executes.
    pub motions: Vec<usize>,
    pub rate_hz: f64,
}

impl Run {
    /// Training samples of one joint.
    pub fn samples(&self, joint: usize) -> Result<Samples<'_>, Failure> {
        Samples::new(
            self.inputs.view(),
            self.residual.row(joint),
            Some(self.moving.row(joint)),
            &self.segments,
        )
        .map_err(|e| ResidualError::from(e).into())
    }

    /// The run with zero weight for samples that do not count.
    pub fn counting(&self, counts: impl Fn(usize) -> bool) -> Self {
        let mut run = self.clone();
        for ((_, row), weight) in run.moving.indexed_iter_mut() {
            *weight *= f32::from(u8::from(counts(row)));
        }
        run
    }

    /// Root mean squared error of `learned` on a joint's residual where it moves in the given trajectories, N·m.
    pub fn rmse(
        &self,
        joint: usize,
        trajectories: &[usize],
        learned: impl Fn(usize) -> f64,
    ) -> f64 {
        let (mut sum, mut count) = (0.0, 0usize);
        let moving = self.moving.row(joint);
        for row in trajectories
            .iter()
            .flat_map(|&t| self.segments[t].clone())
            .filter(|&row| moving[row] > 0.0)
        {
            sum += (f64::from(self.residual[[joint, row]]) - learned(row)).powi(2);
            count += 1;
        }
        (sum / count as f64).sqrt()
    }
}

/// The three recordings of the protocol.
pub struct Data {
    /// Names of the joints, base first.
    pub joints: Vec<String>,
    /// Simulated recording of a thousand point-to-point moves in 20 trajectories, on which networks are trained and tested.
    /// Folds hold whole trajectories; only the paper's own way deals single samples.
    pub moves: Run,
    pub verification: Run,
    pub relative_error_identification: f64,
}

impl Data {
    /// Simulates, or takes from the cache, and identifies the published physics (rigid body, viscous and
    /// Coulomb friction) on the identification recording alone. `span`: torques are smoothed by RLOESS over so many samples first.
    pub fn simulated(study: &Study, span: Option<usize>) -> Result<Self, Failure> {
        let bar = crate::progress::bar(study.running.quiet, "simulating the ur5");
        let set = cached(Protocol::Ur5, study.seed, &study.cache, &|done| {
            bar.set_position((100.0 * done) as u64);
        })
        .map_err(|e| Failure::other(e.to_string()))?;
        bar.finish_and_clear();
        let spinner = study.running.spinner().with_message("identifying");
        let robot = Robot::builtin("ur5").ok_or_else(|| Failure::other("no built-in ur5"))?;
        let taken = |name: &str| -> Result<Recording, Failure> {
            let recording = part(&set, name)?;
            match span {
                Some(span) => {
                    smooth_torque(recording, span).map_err(|e| Failure::other(e.to_string()))
                }
                None => Ok(recording.clone()),
            }
        };
        let identification = [taken("identification")?];
        let options = FitOptions {
            identify: IdentifyOptions {
                select: false,
                ..IdentifyOptions::default()
            },
            prepare: PrepareOptions::default(),
            seed: study.seed,
        };
        let fit = fit_physics(&robot, &identification, None, &options)?;
        let run = |name: &str| -> Result<Run, Failure> {
            let recording = taken(name)?;
            let prepared =
                prepare(&recording, &options.prepare).map_err(|source| FitError::Prepare {
                    file: recording.source.clone(),
                    source,
                })?;
            let session = Session::new(vec![prepared], &fit.file.clock);
            let model = fit.file.physics.model().map_err(FitError::from)?;
            let physics = predict(&model, &session, &fit.file.memory).swap_remove(0);
            let part = &session.parts[0];
            let motion = &part.at_samples;
            let tau = recording.tau.clone().unwrap_or_default();
            Ok(Run {
                inputs: concatenate![Axis(1), motion.q, motion.qd, motion.qdd].mapv(|v| v as f32),
                residual: by_joint(&(&tau - &physics), |v| v as f32),
                moving: by_joint(&motion.qd, |v| f32::from(u8::from(v.abs() > MOVING))),
                tau,
                segments: motion.segments.clone(),
                motions: Motions::new(&[&recording]).of.swap_remove(0),
                rate_hz: part.report.rate_hz,
            })
        };
        let data = Self {
            joints: fit.file.joints.clone(),
            moves: run("moves")?,
            verification: run("verification")?,
            relative_error_identification: identification[0].tau.as_ref().map_or(f64::NAN, |tau| {
                relative_error(tau, (tau - &fit.physics[0]).iter().copied())
            }),
        };
        spinner.finish_and_clear();
        Ok(data)
    }

    /// RMSE of the physics alone on the held-out parts, mean over folds, by joint, N·m.
    pub fn physics_rmse(&self, folds: &[Fold]) -> Vec<f64> {
        let of = |joint| {
            let sum: f64 = folds
                .iter()
                .map(|f| self.moves.rmse(joint, &f.test, |_| 0.0))
                .sum();
            sum / folds.len() as f64
        };
        (0..self.joints.len()).map(of).collect()
    }
}

/// One row per joint, each in one piece.
fn by_joint(table: &Array2<f64>, of: impl Fn(f64) -> f32) -> Array2<f32> {
    let turned = table.mapv(of).reversed_axes();
    turned.as_standard_layout().into_owned()
}

/// A recording of the protocol by its name.
pub fn part<'a>(set: &'a Simulated, name: &str) -> Result<&'a Recording, Failure> {
    set.part(name)
        .ok_or_else(|| Failure::other(format!("the simulation has no part {name}")))
}

/// Relative error of all torques by equation 27 of Wang et al., percent.
pub fn relative_error(tau: &Array2<f64>, error: impl Iterator<Item = f64>) -> f64 {
    let norm = |values: &mut dyn Iterator<Item = f64>| values.map(|v| v * v).sum::<f64>().sqrt();
    100.0 * norm(&mut { error }) / norm(&mut tau.iter().copied())
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::array;

    #[test]
    fn rest_does_not_count() {
        let run = Run {
            inputs: Array2::zeros((4, 3)),
            residual: array![[3.0, 100.0, 4.0, 7.0]],
            moving: array![[1.0, 0.0, 1.0, 1.0]],
            tau: Array2::zeros((4, 1)),
            segments: vec![0..3, 3..4],
            motions: vec![0, 1],
            rate_hz: 60.0,
        };
        assert_eq!(run.rmse(0, &[0], |_| 0.0), 12.5_f64.sqrt());
        assert_eq!(
            run.rmse(0, &[0, 1], |row| [3.0, 0.0, 4.0, 6.0][row]),
            (1.0_f64 / 3.0).sqrt()
        );
    }

    #[test]
    fn samples_are_dealt_out() {
        let run = Run {
            inputs: Array2::zeros((3, 3)),
            residual: array![[3.0, 100.0, 4.0]],
            moving: array![[1.0, 0.0, 1.0]],
            tau: Array2::zeros((3, 1)),
            segments: vec![0..1, 1..3],
            motions: vec![0, 1],
            rate_hz: 60.0,
        };
        assert_eq!(run.counting(|row| row > 0).rmse(0, &[0, 1], |_| 0.0), 4.0);
        assert_eq!(run.counting(|row| row < 2).rmse(0, &[0, 1], |_| 0.0), 3.0);
    }

    #[test]
    fn relative_error_by_hand() {
        let tau = array![[3.0, 0.0], [0.0, 4.0]];
        assert_eq!(relative_error(&tau, [0.0, 0.5, 0.0, 0.0].into_iter()), 10.0);
    }

    #[test]
    fn a_row_for_each_joint() {
        let turned = by_joint(&array![[1.0, 2.0], [3.0, 4.0]], |v| v as f32);
        assert_eq!(turned.row(1).to_slice(), Some(&[2.0, 4.0][..]));
    }
}
