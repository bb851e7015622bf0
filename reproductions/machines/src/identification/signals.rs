//! Filtered position and torque with derivatives.

use super::band::Band;
use crate::{Machine, MachineError};
use datasets::prepare::Derivatives;
use datasets::{PrepareOptions, Recording, prepare};
use ndarray::Array2;
use signal::{Motion, smoother};

/// Cut-offs from here on pass the recorder's noise into the accelerations (manual: below 125 Hz).
const HIGHEST_HZ: f64 = 125.0;

/// Filtered signals at the recorded samples; tables have shape (samples, axes).
pub struct Signals {
    /// Position, velocity and acceleration.
    pub motion: Motion,
    /// Torque as recorded.
    pub torque_raw: Array2<f64>,
    /// Torque behind the same low-pass as the position.
    pub torque: Array2<f64>,
    /// Position as recorded.
    pub position_raw: Array2<f64>,
    /// Samples that are far enough from the ends of a trajectory, one period of the cut-off, for the filter.
    pub kept: Vec<bool>,
    /// Where they come from.
    pub source: String,
}

impl Signals {
    /// Filters a recording at `filter_hz`.
    ///
    /// # Errors
    /// No torque, or a cut-off that does not fit the recording.
    pub fn new(recording: &Recording, filter_hz: f64) -> Result<Self, MachineError> {
        let Some(torque_raw) = recording.tau.clone() else {
            return Err(MachineError::NoTorque(recording.source.clone()));
        };
        let motion = motion(recording, filter_hz)?;
        let rate = 1.0 / recording.median_step();
        let mut torque = torque_raw.clone();
        let mut kept = vec![false; recording.len()];
        let ends = (rate / filter_hz).ceil() as usize;
        for range in recording.segments() {
            for mut column in torque.columns_mut() {
                let values: Vec<f64> = range.clone().map(|row| column[row]).collect();
                let smooth = smoother::low_pass(&values, filter_hz, rate)
                    .map_err(datasets::prepare::PrepareError::from)?;
                for (row, value) in range.clone().zip(smooth) {
                    column[row] = value;
                }
            }
            if range.len() > 2 * ends {
                kept[range.start + ends..range.end - ends].fill(true);
            }
        }
        Ok(Self {
            motion,
            torque_raw,
            torque,
            position_raw: recording.q.clone(),
            kept,
            source: recording.source.clone(),
        })
    }

    /// Rows in which an axis is in motion.
    pub fn moving<'a>(&'a self, axis: usize, band: &'a Band) -> impl Iterator<Item = usize> + 'a {
        (0..self.motion.len())
            .filter(move |&row| self.kept[row] && band.holds(self.motion.qd[(row, axis)]))
    }

    /// Torque of a machine with these parameters at every sample.
    ///
    /// # Errors
    /// Positions that the machine cannot take.
    pub fn command(&self, machine: &Machine, values: &[f64]) -> Result<Array2<f64>, MachineError> {
        torques(machine, values, &self.motion, &self.source)
    }
}

/// Motion behind the low-pass.
///
/// # Errors
/// A cut-off that does not fit the recording.
pub(crate) fn motion(recording: &Recording, filter_hz: f64) -> Result<Motion, MachineError> {
    let rate = 1.0 / recording.median_step();
    let problem = |problem: String| {
        Err(MachineError::Filter {
            cutoff_hz: filter_hz,
            problem,
        })
    };
    if !(filter_hz > 0.0 && filter_hz < HIGHEST_HZ) {
        return problem(format!(
            "is not between 0 and {HIGHEST_HZ} Hz; give another"
        ));
    }
    if filter_hz >= 0.5 * rate {
        return problem(format!(
            "is not below half the recording's rate of {rate:.1} Hz; record faster or give a lower one"
        ));
    }
    let options = PrepareOptions {
        derivatives: Derivatives::FromPosition,
        // The recording's own grid.
        fine_hz: rate.min(100.0),
        ..PrepareOptions::low_passed(filter_hz)
    };
    Ok(prepare(recording, &options)?.at_samples)
}

/// Torque of a machine with these parameters at every row of a motion.
///
/// # Errors
/// Positions that the machine cannot take.
pub(crate) fn torques(
    machine: &Machine,
    values: &[f64],
    motion: &Motion,
    source: &str,
) -> Result<Array2<f64>, MachineError> {
    let mut out = Array2::zeros(motion.q.dim());
    for row in 0..motion.len() {
        let at = |table: &Array2<f64>| table.row(row).to_vec();
        let (q, qd, qdd) = (at(&motion.q), at(&motion.qd), at(&motion.qdd));
        let torque = machine
            .torque(values, &q, &qd, &qdd)
            .map_err(|_| out_of_reach(source, row, &q))?;
        out.row_mut(row)
            .iter_mut()
            .zip(torque)
            .for_each(|(o, t)| *o = t);
    }
    Ok(out)
}

/// The error for positions that the machine cannot take.
pub(super) fn out_of_reach(source: &str, row: usize, q: &[f64]) -> MachineError {
    MachineError::OutOfReach {
        source_name: source.to_owned(),
        row: row + 1,
        positions: q.to_vec(),
    }
}
