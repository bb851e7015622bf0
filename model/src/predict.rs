//! Torque of a model over recordings, with the filters of their torque sensors.

use crate::identify::design::rigid_columns;
use crate::session::{Session, Start};
use crate::torque_channel::TorqueChannel;
use ::identify::base::BaseParameters;
use feedforward::clock::Memory;
use ndarray::{Array2, Axis};
use physics::effects::{BankState, Term};
use physics::torque_model::TorqueModel;

/// Torque at the recorded samples of every recording, N·m (N), shape (samples, joints).
///
/// The model itself runs causally over the fine motion; the recording's own torque filter, where it
/// has one, is applied to what it predicts.
///
/// `memory` is the model's memory at the end of the trajectories that the session knows.
pub fn predict(model: &TorqueModel, session: &Session, memory: &[Memory]) -> Vec<Array2<f64>> {
    let n = model.dof();
    let mut predictor = model.predictor();
    let mut fine: Vec<Vec<Vec<f64>>> = session
        .parts
        .iter()
        .map(|p| vec![vec![0.0; p.fine.len()]; n])
        .collect();
    let mut tau = vec![0.0; n];
    session.walk(None, |start, part, row, s| {
        match start {
            Start::RunsOn => {}
            Start::Neutral => predictor.reset(),
            Start::Known(k) => predictor.restore(memory.get(k).map_or(&[], |m| &m.physics)),
        }
        predictor.step(s.clock, s.dt, s.q, s.qd, s.qdd, &mut tau);
        for (column, tau) in fine[part].iter_mut().zip(&tau) {
            column[row] = *tau;
        }
    });
    session
        .parts
        .iter()
        .zip(fine)
        .map(|(part, columns)| {
            let mut table = Array2::zeros((part.at_samples.len(), n));
            for (mut target, column) in table.columns_mut().into_iter().zip(columns) {
                target.assign(&ndarray::Array1::from(part.to_samples(&column)));
            }
            table
        })
        .collect()
}

/// Torque at the recorded samples of every recording, N·m (N), shape (samples, joints), with the known
/// properties of their torque channel.
pub fn predict_noted(
    model: &TorqueModel,
    session: &Session,
    memory: &[Memory],
    channel: Option<&TorqueChannel>,
) -> Vec<Array2<f64>> {
    let mut all = predict(model, session, memory);
    if let Some(channel) = channel {
        all.iter_mut().for_each(|torque| channel.note(torque));
    }
    all
}

/// Sensitivity of one joint's torque to each fitted parameter.
pub struct Sensitivity {
    /// Indices of the joint's parameters among all: base parameters, then each joint's fitted terms, as in the
    /// covariance.
    pub places: Vec<usize>,
    /// Torque per unit of each parameter, shape (samples, parameters).
    pub columns: Array2<f64>,
}

/// Sensitivity of every joint's torque over the last recording of the session.
///
/// Terms whose deviation is zero by construction (a known counterbalance) are not among the parameters.
pub fn sensitivities(
    model: &TorqueModel,
    session: &Session,
    memory: &[Memory],
) -> Vec<Sensitivity> {
    let robot = model.robot();
    let base = BaseParameters::of_robot(robot, &[]);
    let last = session.parts.len() - 1;
    let rigid = rigid_columns(robot, &base, session, last..last + 1, 1);
    let load = session.load(model.load_robot());
    let mut offset = base.len();
    let mut all = Vec::with_capacity(robot.dof());
    for (joint, (list, rigid)) in model.terms().iter().zip(&rigid).enumerate() {
        let terms: Vec<Term> = list.iter().map(|w| w.term.clone()).collect();
        let known: Vec<&BankState> = memory.iter().filter_map(|m| m.physics.get(joint)).collect();
        let fitted: Vec<usize> = (0..terms.len())
            .filter(|&k| terms[k].passive().is_none())
            .collect();
        let columns = session.columns(joint, &terms, &load, &known)[last].select(Axis(1), &fitted);
        all.push(Sensitivity {
            places: (0..base.len())
                .chain(offset..offset + fitted.len())
                .collect(),
            columns: ndarray::concatenate![Axis(1), rigid[0], columns],
        });
        offset += fitted.len();
    }
    all
}

/// Standard deviation of the predicted torque that comes from the parameters' covariance alone, for
/// the last recording of the session, shape (samples, joints).
///
/// `covariance` is over the base parameters, then each joint's fitted terms.
pub fn parameter_deviation(
    model: &TorqueModel,
    session: &Session,
    memory: &[Memory],
    covariance: &Array2<f64>,
) -> Array2<f64> {
    let all = sensitivities(model, session, memory);
    let last = session.parts.len() - 1;
    let mut table = Array2::zeros((session.parts[last].at_samples.len(), all.len()));
    for (Sensitivity { places, columns }, mut target) in all.iter().zip(table.columns_mut()) {
        let own = Array2::from_shape_fn((places.len(), places.len()), |(i, k)| {
            covariance[[places[i], places[k]]]
        });
        let spread = columns.dot(&own);
        for (row, target) in target.iter_mut().enumerate() {
            *target = spread.row(row).dot(&columns.row(row)).max(0.0).sqrt();
        }
    }
    table
}
