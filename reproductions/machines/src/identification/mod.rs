//! From a recording to parameters, as the softMC manual does it: position and torque pass one low-pass, velocity and
//! acceleration are derived, samples below a speed of the axis are left out, the rest is fitted by least squares, and
//! the largest error relative to the axis's largest torque tells success.

mod band;
mod fit;
mod moving;
mod settings;
mod signals;

pub use band::Band;
pub use fit::{AxisRows, Estimate, fit, fit_towards};
pub use moving::bands;
pub use settings::{FILTER_HZ, SHARE, SLOW, Settings};
pub use signals::Signals;
pub(crate) use signals::{motion, torques};

use crate::{Machine, MachineError};
use datasets::Recording;
use ndarray::Array2;
use serde::{Deserialize, Serialize};

/// Largest relative error of an axis with which an identification counts as successful (manual, "success condition").
pub const ALLOWED: f64 = 0.5;

/// What was found of one axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AxisResult {
    /// Name.
    pub name: String,
    /// Largest torque error over the axis's largest measured torque, over samples in motion; NaN where there is none.
    pub max_relative: f64,
    /// Mean of the same.
    pub mean_relative: f64,
    /// Samples in motion.
    pub samples: usize,
    /// Which speeds count as motion.
    pub band: Band,
    /// RMS error over samples in motion, N·m or N.
    pub rms: f64,
}

/// An identified machine.
pub struct Identified {
    /// The machine.
    pub machine: Machine,
    /// Parameters with their standard deviations.
    pub estimate: Estimate,
    /// Axis by axis.
    pub axes: Vec<AxisResult>,
    /// Cut-off, Hz.
    pub filter_hz: f64,
    /// Samples recorded, and those left when the filter's ends are cut off.
    pub samples: [usize; 2],
    /// The equations that were solved.
    pub rows: AxisRows,
    /// The signals.
    pub signals: Signals,
    /// Torque of the fitted model, samples × axes.
    pub command: Array2<f64>,
}

impl Identified {
    /// Whether every axis's largest relative error is at most [`ALLOWED`].
    pub fn success(&self) -> bool {
        self.axes.iter().all(|a| a.max_relative <= ALLOWED)
    }
}

/// Identifies a machine from a recording.
///
/// # Errors
/// A recording without torque, a filter that does not fit it, an axis with too few samples in motion, positions that the
/// machine cannot take.
pub fn identify(
    machine: Machine,
    recording: &Recording,
    settings: &Settings,
) -> Result<Identified, MachineError> {
    let filter_hz = settings.filter_hz.unwrap_or(FILTER_HZ);
    let signals = Signals::new(recording, filter_hz)?;
    let bands = bands(&machine, &signals, settings)?;
    let rows = AxisRows::of(&machine, &signals, &bands)?;
    let estimate = fit(&rows)?;
    let command = signals.command(&machine, &estimate.values)?;
    let axes = machine
        .axes()
        .iter()
        .enumerate()
        .map(|(j, axis)| axis_result(&axis.name, j, &signals, &command, &bands[j]))
        .collect();
    Ok(Identified {
        machine,
        estimate,
        axes,
        filter_hz,
        samples: [recording.len(), signals.kept.iter().filter(|k| **k).count()],
        rows,
        signals,
        command,
    })
}

/// Relative errors of one axis over its samples in motion; NaN where it never moves.
pub fn axis_result(
    name: &str,
    axis: usize,
    signals: &Signals,
    command: &Array2<f64>,
    band: &Band,
) -> AxisResult {
    let rows: Vec<usize> = signals.moving(axis, band).collect();
    let measured = |row: usize| signals.torque[(row, axis)];
    let largest = (0..signals.motion.len())
        .filter(|&row| signals.kept[row])
        .map(|row| measured(row).abs())
        .fold(0.0, f64::max);
    let errors: Vec<f64> = rows
        .iter()
        .map(|&row| (command[(row, axis)] - measured(row)).abs())
        .collect();
    let count = errors.len() as f64;
    AxisResult {
        name: name.to_owned(),
        max_relative: errors.iter().copied().fold(f64::NAN, f64::max) / largest,
        mean_relative: errors.iter().sum::<f64>() / count / largest,
        samples: rows.len(),
        band: band.clone(),
        rms: (errors.iter().map(|e| e * e).sum::<f64>() / count).sqrt(),
    }
}
