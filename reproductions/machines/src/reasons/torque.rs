//! Saturation and noise.

use super::{Kind, Reason};
use crate::identification::Identified;
use datasets::check::plateau;

/// Part of an axis's torque from which on what the filter takes away counts as large.
const LARGE: f64 = 0.3;

/// A plateau of the recorded torque that the model's torque goes beyond.
pub(super) fn saturated(identified: &Identified, axis: usize) -> Option<Reason> {
    let raw = identified.signals.torque_raw.column(axis).to_vec();
    let (level, share) = plateau(&raw)?;
    let command = identified.command.column(axis);
    let beyond = command.iter().filter(|t| t.abs() > level).count();
    let described = &identified.machine.axes()[axis];
    (beyond > 0).then(|| Reason {
        kind: Kind::Saturated,
        axis: Some(axis),
        value: level,
        message: format!(
            "{} stands at ±{level:.1} {} in {:.1} % of the samples while the model goes on beyond: the drive saturates; move \
             it less fast",
            described.name,
            described.effort_unit(),
            100.0 * share
        ),
    })
}

/// Noise above the filter's cut-off beside the torque below it, and errors that it explains.
pub(super) fn noise(identified: &Identified, axis: usize) -> Option<Reason> {
    let signals = &identified.signals;
    let rms = |values: Vec<f64>| {
        (values.iter().map(|v| v * v).sum::<f64>() / values.len().max(1) as f64).sqrt()
    };
    let rows: Vec<usize> = (0..signals.motion.len())
        .filter(|&row| signals.kept[row])
        .collect();
    let taken = |row: &usize| signals.torque_raw[(*row, axis)] - signals.torque[(*row, axis)];
    let noise = rms(rows.iter().map(taken).collect());
    let torque = rms(rows
        .iter()
        .map(|row| signals.torque[(*row, axis)])
        .collect());
    let part = noise / torque;
    (part > LARGE).then(|| Reason {
        kind: Kind::Noise,
        axis: Some(axis),
        value: part,
        message: format!(
            "{}: what the filter takes away is {:.0} % of the torque that it leaves, as on small motors; a lower cut-off or \
             more load may help, and its relative error says little",
            identified.machine.axes()[axis].name,
            100.0 * part
        ),
    })
}
