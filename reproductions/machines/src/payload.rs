//! A body on the last axis, from a recording with it and an identified machine without it.
//!
//! What the body adds to torque is linear in the model's own parameters: τ − Y θ = Y B p, B what each unit of the body adds to
//! them ([`TorqueModel::payload`]). The stored parameters stay unknowns whose prior is their deviation, and every friction may
//! have changed since by a tenth, so that the body's deviations hold both.
//!
//! [`TorqueModel::payload`]: crate::models::TorqueModel::payload

use crate::MachineError;
use crate::identification::{AxisRows, Signals, fit_towards};
use crate::store::{MachineFile, Value};
use datasets::Recording;
use identify::least_squares::Prior;
use serde::Serialize;

/// How far each friction may have changed since the identification, as one deviation relative to its size.
pub const FRICTION_CHANGE: f64 = 0.1;

/// Prior deviation of the body's figures, kg, kg·m or kg·m²: none.
const FREE: f64 = 1e6;

/// What was found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MachinePayload {
    /// `machine-payload/1`.
    pub schema: &'static str,
    /// Name of the machine.
    pub machine: String,
    /// Its torque model.
    pub dynamic_model: usize,
    /// The body's figures.
    pub body: Vec<Value>,
    /// RMS torque that the machine without the body leaves over samples in motion, per axis, N·m or N.
    pub rms_without: Vec<f64>,
    /// The same with the body.
    pub rms_with: Vec<f64>,
}

/// Estimates the body.
///
/// # Errors
/// A recording without torque, one that the machine's filter does not fit, positions that the machine cannot take.
pub fn estimate(file: &MachineFile, recording: &Recording) -> Result<MachinePayload, MachineError> {
    let (machine, values) = file.machine()?;
    let signals = Signals::new(recording, file.filter_hz)?;
    let own = machine.model_parameters();
    let adds = machine.model().payload(&values[..own]);
    let bands: Vec<_> = file.axes.iter().map(|axis| axis.band.clone()).collect();
    let columns = adds.len() + values.len();
    let rows = AxisRows::with(
        &machine,
        &signals,
        &bands,
        columns,
        |row, torque, unknowns| {
            let (body, stored) = unknowns.split_at_mut(adds.len());
            for (to, (_, column)) in body.iter_mut().zip(&adds) {
                *to = row.iter().zip(column).map(|(y, b)| y * b).sum();
            }
            stored.copy_from_slice(row);
            torque - row.iter().zip(&values).map(|(y, v)| y * v).sum::<f64>()
        },
    )?;
    let found = fit_towards(&rows, Some(prior(file, own, adds.len())))?;
    let zero = vec![0.0; columns];
    let rms = |unknowns: &[f64]| -> Result<Vec<f64>, MachineError> {
        (0..machine.dof())
            .map(|j| {
                let squares = rows.axis(j).residual_sum_of_squares(unknowns)?;
                Ok((squares / rows.axis(j).rows() as f64).sqrt())
            })
            .collect()
    };
    let figures = adds.iter().zip(found.values.iter().zip(&found.std));
    Ok(MachinePayload {
        schema: "machine-payload/1",
        machine: file.machine.name.clone(),
        dynamic_model: file.machine.dynamic_model,
        body: figures
            .map(|((parameter, _), (&value, &std))| Value {
                name: parameter.name.clone(),
                value,
                std,
                unit: parameter.unit.clone(),
            })
            .collect(),
        rms_without: rms(&zero)?,
        rms_with: rms(&found.values)?,
    })
}

/// Nothing is known of the body; the machine's parameters are as sure as they were identified, friction less.
fn prior(file: &MachineFile, own: usize, body: usize) -> Prior {
    let mut std = vec![FREE; body];
    for (k, parameter) in file.parameters.iter().enumerate() {
        let change = if k < own {
            0.0
        } else {
            FRICTION_CHANGE * parameter.value
        };
        // A parameter that the motion did not tell is a convention and stays.
        let least = f64::EPSILON.max(1e-9 * parameter.value.abs());
        std.push(parameter.std.hypot(change).max(least));
    }
    Prior {
        mean: vec![0.0; std.len()],
        std,
    }
}
