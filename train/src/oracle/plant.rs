//! The simulated robot behind a model, and its own equations on the motion that the model sees.

use super::arguments::Oracle;
use super::cutoffs::at_best_cutoff;
use datasets::metrics::{Scope, Scores, deviations};
use datasets::{Prepared, Recording};
use model::directory::ModelFile;
use model::evaluation::{EvaluateError, Evaluation};
use model::failure::Failure;
use ndarray::Array2;
use trials::protocols::{Effect, Machine, Protocol, cached};

/// A simulated robot with the recording that its model is scored on.
pub struct Plant {
    machine: Machine,
    /// Held-out recording of the robot.
    pub recording: Recording,
    /// Torque of the plant without the sensor's noise, N·m, with its own states known, shape (samples, joints).
    pub exerted: Array2<f64>,
    /// Gain of the recorded motion over the true one.
    gain: f64,
}

impl Plant {
    /// The robot that the model was trained on, and its held-out recording.
    pub fn of(file: &ModelFile, arguments: &Oracle) -> Result<Self, Failure> {
        let refused = || {
            Failure::input(
                format!(
                    "{}: not a model of a simulated robot",
                    arguments.model.display()
                ),
                "Make one with `train` or `train --robot kr300`, without --data: only of a simulated robot is the truth known.",
            )
        };
        let builtin = file.physics.builtin.ok_or_else(refused)?;
        let protocol = Protocol::ALL
            .into_iter()
            .find(|p| p.name() == builtin.name())
            .filter(|_| arguments.model.join("simulated").is_dir())
            .ok_or_else(refused)?;
        let bar = crate::progress::bar(arguments.running.quiet, "simulating without noise");
        let show = |done: f64| bar.set_position((100.0 * done) as u64);
        let failed = |e: trials::SimulateError| Failure::other(e.to_string());
        let seed = file.provenance.seed;
        let cache = arguments.model.join("simulated");
        let mut noisy = cached(protocol, seed, &cache, &|_| {}).map_err(failed)?;
        let trained = noisy.parts.iter().map(|(part, recording)| {
            let name = format!("{}-{part}.parquet", protocol.name());
            (name, recording.len())
        });
        let known = &file.provenance.recordings;
        if known
            .iter()
            .zip(trained)
            .any(|(r, t)| (&r.name, r.samples) != (&t.0, t.1))
        {
            return Err(refused());
        }
        let machine = protocol.machine().map_err(failed)?;
        let quiet = machine.clone().noiseless();
        let mut clean = protocol
            .simulate_machine(&quiet, seed, &show)
            .map_err(failed)?;
        bar.finish_and_clear();
        let (Some((_, recording)), Some((_, clean))) = (noisy.parts.pop(), clean.parts.pop())
        else {
            return Err(Failure::other("the simulation gave no recording"));
        };
        let exerted = clean.tau.unwrap_or_default();
        if recording.tau.as_ref().map(Array2::dim) != Some(exerted.dim()) {
            return Err(Failure::other(
                "the simulated recordings are not of this version",
            ));
        }
        Ok(Self {
            machine,
            recording,
            exerted,
            gain: protocol.motion_gain(),
        })
    }

    /// Recorded torque, N·m, shape (samples, joints).
    pub fn recorded(&self) -> Array2<f64> {
        self.recording.tau.clone().unwrap_or_default()
    }

    /// Torque at the samples by the true equations on the prepared motion, the gears' temperature unknown, with the cut-off
    /// at which it does best, Hz (None: the model's own).
    pub fn attainable(
        &self,
        file: &ModelFile,
        evaluation: &Evaluation,
    ) -> Result<(Array2<f64>, Option<f64>), Failure> {
        let own = &evaluation.session.parts[0];
        let qd = &own.at_samples.qd;
        let recorded = self.recorded();
        let deviations = deviations(recorded.view(), qd.view());
        at_best_cutoff(own.report.rate_hz, |cutoff| {
            let prepared = file
                .preprocessing
                .prepare(&self.recording, cutoff)
                .map_err(|source| EvaluateError::Prepare {
                    file: self.recording.source.clone(),
                    source,
                })?;
            let torque = true_torque(&self.machine, &prepared, self.gain)?;
            let errors = &recorded - &torque;
            let scores =
                Scores::of_errors(errors.view(), &deviations, qd.view(), Scope::All, |_| true)
                    .map_err(|e| Failure::other(e.to_string()))?;
            Ok((scores.mean_nrmse.unwrap_or(f64::INFINITY), torque))
        })
    }

    /// Torque of one effect on the prepared motion, N·m, shape (samples, joints).
    pub fn share_of(&self, effect: Effect, prepared: &Prepared) -> Result<Array2<f64>, Failure> {
        let without = self.machine.clone().without(effect);
        Ok(true_torque(&self.machine, prepared, self.gain)?
            - true_torque(&without, prepared, self.gain)?)
    }
}

/// Torque at the samples by the true equations, N·m, shape (samples, joints). The true motion is the recorded
/// one divided by `gain`.
pub fn true_torque(
    machine: &Machine,
    prepared: &Prepared,
    gain: f64,
) -> Result<Array2<f64>, Failure> {
    let mut motion = prepared.fine.clone();
    for table in [&mut motion.q, &mut motion.qd, &mut motion.qdd] {
        *table /= gain;
    }
    let fine = machine
        .torque(&motion)
        .map_err(|e| Failure::other(e.to_string()))?;
    let mut table = Array2::zeros(prepared.at_samples.q.dim());
    for (mut target, column) in table.columns_mut().into_iter().zip(fine.columns()) {
        target.assign(&ndarray::Array1::from(
            prepared.to_samples(&column.to_vec()),
        ));
    }
    Ok(table)
}
