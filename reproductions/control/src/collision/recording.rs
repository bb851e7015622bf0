//! The detectors on a recording of a stored model's robot.

use super::residual::Signal;
use super::threshold::{Alarm, SHORTEST, Thresholds, alarms, thresholds};
use super::{DETECTORS, Momentum, Regimes, Sudden, TIME_CONSTANT, TorqueError, WINDOW};
use crate::ControlError;
use crate::model::{DirectoryModel, Model};
use ::model::directory::ModelFile;
use ::model::evaluation::Evaluation;
use serde::Serialize;
use std::path::Path;

/// A detector on a recording.
#[derive(Debug, Clone, Serialize)]
pub struct Detector {
    /// One of [`DETECTORS`].
    pub name: &'static str,
    /// Thresholds of every joint (TorqueErrorMax), N·m or N.
    pub thresholds: Vec<Thresholds>,
    /// What exceeded them.
    pub alarms: Vec<Recorded>,
    /// Its residual.
    #[serde(skip)]
    pub signal: Signal,
}

/// An alarm in a recording.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Recorded {
    /// Label of the trajectory.
    pub trajectory: String,
    /// Name of the joint.
    pub name: String,
    /// When, which joint, how much.
    #[serde(flatten)]
    pub alarm: Alarm,
}

/// What `eval --collision` finds.
#[derive(Debug, Clone, Serialize)]
pub struct Collisions {
    /// `collision/2`.
    pub schema: &'static str,
    /// Joints.
    pub joints: Vec<String>,
    /// Time looked at, s.
    pub seconds: f64,
    /// Time that the thresholds were chosen from, s.
    pub calibration_seconds: f64,
    /// Wanted false alarms per hour, of all joints together.
    pub false_alarms: f64,
    /// TorqueErrorFilter at the recording's rate.
    pub torque_error_filter: f64,
    /// RMS of measured minus model torque of every joint, N·m or N.
    pub residual_rms: Vec<f64>,
    /// Each of [`DETECTORS`].
    pub detectors: [Detector; 3],
    /// What the figures depend on.
    pub notes: Vec<String>,
}

/// Thresholds from `calibration` (the recording itself where there is none) for a wanted rate of false alarms, and the alarms in
/// the recording.
///
/// # Errors
/// A directory that cannot be used, recordings without torque or too short.
pub fn of_recording(
    directory: &Path,
    file: &ModelFile,
    recording: &Evaluation,
    calibration: Option<&Evaluation>,
    per_hour: f64,
) -> Result<Collisions, ControlError> {
    let speeds = largest_speeds(calibration.unwrap_or(recording));
    let seen = Residuals::of(directory, file, recording, &speeds)?;
    let chosen_from = match calibration {
        Some(other) => &Residuals::of(directory, file, other, &speeds)?,
        None => &seen,
    };
    let labels = &recording.recording.trajectories;
    let detector = |d: usize| {
        let signal = &seen.shown[d];
        let thresholds = thresholds(&chosen_from.shown[d], per_hour);
        let found = alarms(signal, &thresholds).into_iter().map(|alarm| {
            let of = labels.iter().find(|t| t.range.contains(&alarm.row));
            Recorded {
                trajectory: of.map_or_else(String::new, |t| t.label.clone()),
                name: file.joints[alarm.joint].clone(),
                alarm,
            }
        });
        Detector {
            name: DETECTORS[d],
            alarms: found.collect(),
            thresholds,
            signal: signal.clone(),
        }
    };
    let mut notes = vec![format!(
        "Motion as eval prepares it (a zero-phase low-pass, not causal): in a loop, choose thresholds from the loop's own signals. The \
         detectors have a time constant of {:.0} ms; a sudden momentum is the mean torque from outside over {:.0} ms less that over the {:.0} ms \
         before.",
        1e3 * TIME_CONSTANT,
        1e3 * WINDOW,
        1e3 * WINDOW
    )];
    if calibration.is_none() {
        notes.push("The thresholds were chosen from this very recording; give --calibration to judge one that they have not seen.".to_owned());
    }
    Ok(Collisions {
        schema: "collision/2",
        joints: file.joints.clone(),
        seconds: seen.raw.seconds(),
        calibration_seconds: chosen_from.raw.seconds(),
        false_alarms: per_hour,
        torque_error_filter: seen.filter,
        residual_rms: seen.raw.rms(),
        detectors: std::array::from_fn(detector),
        notes,
    })
}

/// Largest speed of every joint, rad/s or m/s.
fn largest_speeds(seen: &Evaluation) -> Vec<f64> {
    let columns = seen.session.parts[0].at_samples.qd.columns().into_iter();
    columns
        .map(|qd| qd.iter().fold(0.0f64, |top, v| top.max(v.abs())))
        .collect()
}

/// Residuals of a recording.
struct Residuals {
    raw: Signal,
    /// What each of [`DETECTORS`] shows.
    shown: [Signal; DETECTORS.len()],
    filter: f64,
}

impl Residuals {
    fn of(
        directory: &Path,
        file: &ModelFile,
        seen: &Evaluation,
        speeds: &[f64],
    ) -> Result<Self, ControlError> {
        let recording = &seen.recording;
        let motion = &seen.session.parts[0].at_samples;
        let n = recording.dof();
        let step = recording.median_step();
        let mut model = DirectoryModel::load(directory, file, step)?;
        let filter = TorqueError::filter(TIME_CONSTANT, step);
        let mut error = TorqueError::new(n, filter);
        let mut observer = Momentum::new(n, 1.0 / TIME_CONSTANT);
        let mut sudden = Sudden::new(n, 1.0 / TIME_CONSTANT, WINDOW, step);
        let mut regimes = Regimes::new(speeds);
        let mut all = Self {
            raw: Signal::new(n),
            shown: std::array::from_fn(|_| Signal::new(n)),
            filter,
        };
        let mut rigid = vec![0.0; n];
        // A recording without torque is one without a single stretch, and thereby too short.
        let stretches = recording
            .tau
            .as_ref()
            .map(|tau| (tau, recording.segments()));
        for (tau, range) in stretches
            .iter()
            .flat_map(|(tau, all)| all.iter().map(move |r| (tau, r)))
        {
            error.reset();
            observer.reset();
            sudden.reset();
            regimes.reset();
            for row in range.clone() {
                let first = row == range.start;
                let dt = if first {
                    step
                } else {
                    recording.time[row] - recording.time[row - 1]
                };
                let of = |table: &ndarray::Array2<f64>| table.row(row).to_vec();
                let (q, qd, qdd) = (of(&motion.q), of(&motion.qd), of(&motion.qdd));
                let moves = regimes.step(&qd, dt);
                let (measured, whole) = (of(tau), of(&seen.torque));
                let left: Vec<f64> = measured.iter().zip(&whole).map(|(m, w)| m - w).collect();
                all.raw.push(recording.time[row], &left, moves, first);
                let shown = error.step(&whole, &measured);
                all.shown[0].push(recording.time[row], shown, moves, first);
                model.rigid(&q, &qd, &qdd, &mut rigid);
                let net: Vec<f64> = (0..n)
                    .map(|j| measured[j] - (whole[j] - rigid[j]))
                    .collect();
                let shown = observer.step(&mut model, &q, &qd, &net, dt);
                all.shown[1].push(recording.time[row], shown, moves, first);
                let jump = sudden.step(shown);
                all.shown[2].push(recording.time[row], jump, moves, first);
            }
        }
        let seconds = all.raw.seconds();
        if seconds < SHORTEST {
            return Err(ControlError::TooShort {
                file: recording.source.clone(),
                seconds,
                needed: SHORTEST,
            });
        }
        Ok(all)
    }
}
