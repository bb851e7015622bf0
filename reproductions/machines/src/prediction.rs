//! Torque of an identified machine over a recording, and its scores.

use crate::MachineError;
use crate::identification::{AxisResult, Signals, axis_result};
use crate::store::MachineFile;
use datasets::Recording;
use datasets::metrics::Row;
use ndarray::Array2;
use serde::Serialize;
use signal::Motion;

/// Predicted torque over a recording.
pub struct Prediction {
    /// Motion behind the machine's own low-pass.
    pub motion: Motion,
    /// Torque, samples × axes, N·m or N.
    pub torque: Array2<f64>,
}

/// Scores of a prediction against the recorded torque.
#[derive(Debug, Clone, Serialize)]
pub struct Scores {
    /// `machine-eval/1`.
    pub schema: &'static str,
    /// Names of the axes.
    pub joints: Vec<String>,
    /// Samples scored.
    pub samples: usize,
    /// RMSE, NRMSE and R² against the torque as recorded, over all samples and in motion.
    pub rows: Vec<Row>,
    /// RMSE over the RMS of the recorded torque, per axis; none for an axis without torque.
    pub relative_rms: Vec<Option<f64>>,
    /// Errors by the rules of the identification: filtered torque, samples in motion, relative to the axis's largest torque.
    pub axes: Vec<AxisResult>,
    /// Whether each of these is at most 50 %.
    pub success: bool,
}

/// Predicts the torque of a recording's motion.
///
/// # Errors
/// A recording that the machine's filter does not fit, or positions that it cannot take.
pub fn predict(file: &MachineFile, recording: &Recording) -> Result<Prediction, MachineError> {
    let (machine, values) = file.machine()?;
    let motion = crate::identification::motion(recording, file.filter_hz)?;
    let torque = crate::identification::torques(&machine, &values, &motion, &recording.source)?;
    Ok(Prediction { motion, torque })
}

/// Scores a prediction of the same recording.
///
/// # Errors
/// A recording without torque.
pub fn score(
    file: &MachineFile,
    recording: &Recording,
    prediction: &Prediction,
) -> Result<Scores, MachineError> {
    let signals = Signals::new(recording, file.filter_hz)?;
    let measured = &signals.torque_raw;
    let rows = Row::both_scopes(
        "machine",
        measured,
        &prediction.torque,
        &prediction.motion.qd,
    )
    .map_err(|e| MachineError::Store {
        path: recording.source.clone().into(),
        reason: e.to_string(),
    })?;
    let rms = |values: &mut dyn Iterator<Item = f64>| {
        (values.map(|v| v * v).sum::<f64>() / recording.len() as f64).sqrt()
    };
    let relative_rms = (0..measured.ncols())
        .map(|j| {
            let (tau, predicted) = (measured.column(j), prediction.torque.column(j));
            let error = rms(&mut tau.iter().zip(&predicted).map(|(a, b)| a - b));
            let size = rms(&mut tau.iter().copied());
            Some(error / size).filter(|r| r.is_finite())
        })
        .collect();
    let axes: Vec<AxisResult> = file
        .axes
        .iter()
        .enumerate()
        .map(|(j, axis)| axis_result(&axis.name, j, &signals, &prediction.torque, &axis.band))
        .collect();
    Ok(Scores {
        schema: "machine-eval/1",
        joints: file.axes.iter().map(|a| a.name.clone()).collect(),
        samples: recording.len(),
        rows: rows.into(),
        relative_rms,
        success: axes
            .iter()
            .all(|a| a.max_relative <= crate::identification::ALLOWED),
        axes,
    })
}
