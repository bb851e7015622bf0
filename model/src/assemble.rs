//! Assembly of a model file from its parts.

use crate::baseline::{BaselineError, ForwardBaseline, inverse::LinearInverse};
use crate::directory::{
    BaseParameter, ModelFile, Preprocessing, Provenance, ResidualStd, SCHEMA, Source,
};
use crate::identify::diagnostics::Diagnostics;
use crate::session::Session;
use ::identify::base::BaseParameters;
use datasets::Recording;
use datasets::metrics::MOVING;
use feedforward::clock::Memory;
use ndarray::Array2;
use physics::effects::Term;
use physics::robot::Robot;
use physics::torque_model::{TorqueModel, TorqueModelRecord};

/// Estimated base parameters.
pub struct Estimated<'a> {
    /// Values of the parameters, in the order of the robot's base parameters.
    pub values: &'a [f64],
    /// Standard deviations of the values.
    pub std: &'a [f64],
}

/// Parts from which a model file is assembled.
pub struct Parts<'a> {
    /// Nominal robot, as described before the fit.
    pub robot: &'a Robot,
    /// Recordings on which the model was fitted.
    pub data: &'a [Recording],
    /// Session of the recordings in `data`, and perhaps more, in the order in which memory passes through them.
    pub session: &'a Session,
    /// Predicted torque at the recorded samples of each recording of the session, N·m (N), shape (samples, joints).
    pub physics: &'a [Array2<f64>],
    /// Record of the torque model.
    pub record: TorqueModelRecord,
    /// Estimated base parameters of the model.
    pub base: Estimated<'a>,
    /// Covariance of base parameters, then each joint's fitted terms.
    pub covariance: &'a Array2<f64>,
    /// Preparation of the recordings.
    pub preprocessing: Preprocessing,
    /// Quality of the identification.
    pub diagnostics: Option<Diagnostics>,
    /// Random seed of the training, for provenance.
    pub seed: u64,
    /// Number of folds of the cross-validation.
    pub folds: usize,
}

impl Parts<'_> {
    /// Model file from these parts, with baselines fitted on the same recordings, and with the memory of `model`.
    ///
    /// # Errors
    /// The linear baseline cannot be fitted.
    pub fn assemble(self, model: &TorqueModel) -> Result<ModelFile, BaselineError> {
        let (data, session) = (self.data, self.session);
        Ok(ModelFile {
            schema: SCHEMA.into(),
            residyn: env!("CARGO_PKG_VERSION").into(),
            joints: self.robot.joint_names(),
            base_parameters: base_parameters(self.robot, &self.base),
            covariance: self
                .covariance
                .rows()
                .into_iter()
                .map(|r| r.to_vec())
                .collect(),
            covariance_sha256: String::new(),
            residual_std: residual_std(data, session, self.physics),
            preprocessing: self.preprocessing,
            linear_baseline: baseline(data, session)?,
            // Recordings too short for it have none.
            forward_baseline: ForwardBaseline::fit(data).ok(),
            diagnostics: self.diagnostics,
            clock: session.clock(data.len()),
            memory: memory(model, session, data.len()),
            provenance: Provenance {
                recordings: data.iter().map(Source::of).collect(),
                seed: self.seed,
                folds: self.folds,
            },
            physics: self.record,
            compensator: None,
        })
    }
}

/// Memory of the physical terms at the end of each trajectory of the first `recordings` that is on the clock
/// ([`Session::clock`]).
pub fn memory(model: &TorqueModel, session: &Session, recordings: usize) -> Vec<Memory> {
    let load = session.load(model.load_robot());
    let mut memory = vec![
        Memory {
            physics: Vec::new(),
            inputs: Vec::new()
        };
        session.clock(recordings).len()
    ];
    for (joint, list) in model.terms().iter().enumerate() {
        let terms: Vec<Term> = list.iter().map(|w| w.term.clone()).collect();
        let states = session.end_states(joint, &terms, &load, recordings);
        for (memory, state) in memory.iter_mut().zip(states) {
            memory.physics.push(state);
        }
    }
    memory
}

/// Base parameters of `robot` in stored form.
pub(crate) fn base_parameters(robot: &Robot, estimated: &Estimated) -> Vec<BaseParameter> {
    let base = BaseParameters::of_robot(robot, &[]);
    let nominal = base.base_from(&robot.parameters());
    let names = base.base_names();
    let relative = |i: usize| {
        let (value, std) = (estimated.values[i], estimated.std[i]);
        (value != 0.0).then(|| std / value.abs())
    };
    base.formulae()
        .into_iter()
        .enumerate()
        .map(|(i, formula)| BaseParameter {
            unit: match base.independent()[i] % 10 {
                0 => "kg",
                1..=3 => "kg·m",
                _ => "kg·m²",
            }
            .into(),
            name: names[i].clone(),
            formula,
            value: estimated.values[i],
            std: estimated.std[i],
            relative_std: relative(i),
            nominal: nominal[i],
        })
        .collect()
}

/// Linear baseline of the KR300 benchmark paper.
fn baseline(data: &[Recording], session: &Session) -> Result<LinearInverse, BaselineError> {
    let stack = |table: &dyn Fn(usize) -> Array2<f64>| {
        let tables: Vec<Array2<f64>> = (0..data.len()).map(table).collect();
        let views: Vec<_> = tables.iter().map(|t| t.view()).collect();
        ndarray::concatenate(ndarray::Axis(0), &views).unwrap_or_default()
    };
    let motion = |i: usize| &session.parts[i].at_samples;
    LinearInverse::fit(
        stack(&|i| motion(i).q.clone()).view(),
        stack(&|i| motion(i).qd.clone()).view(),
        stack(&|i| motion(i).qdd.clone()).view(),
        stack(&|i| data[i].tau.clone().unwrap_or_default()).view(),
    )
}

/// Standard deviation of the physics' residual by joint, in motion and at standstill.
fn residual_std(data: &[Recording], session: &Session, physics: &[Array2<f64>]) -> ResidualStd {
    let joints = physics[0].ncols();
    let deviation = |joint: usize, moving: bool| {
        let (mut sum, mut count) = (0.0, 0usize);
        for (part, recording) in data.iter().enumerate() {
            let Some(tau) = &recording.tau else { continue };
            let qd = session.parts[part].at_samples.qd.column(joint);
            for ((t, p), v) in tau
                .column(joint)
                .iter()
                .zip(physics[part].column(joint))
                .zip(qd)
            {
                if (v.abs() > MOVING) == moving {
                    sum += (t - p).powi(2);
                    count += 1;
                }
            }
        }
        if count == 0 {
            0.0
        } else {
            (sum / count as f64).sqrt()
        }
    };
    ResidualStd {
        moving: (0..joints).map(|j| deviation(j, true)).collect(),
        standstill: (0..joints).map(|j| deviation(j, false)).collect(),
    }
}
