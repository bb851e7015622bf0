//! Time stamps.

use super::finding::{Finding, Kind, Severity};
use crate::Recording;

/// Number of median steps from which a longer step of the clock is a jump.
const JUMP: f64 = 3.0;

/// Relative deviation of the steps from which on the stamps are called jittered.
const JITTER: f64 = 0.05;

/// Jumps listed one by one; more are counted.
const LISTED: usize = 5;

pub(super) fn findings(recording: &Recording, jitter: f64) -> Vec<Finding> {
    let step = recording.median_step();
    let mut jumps: Vec<(usize, f64)> = recording
        .trajectories
        .iter()
        .flat_map(|t| t.range.clone().skip(1))
        .map(|row| (row, recording.time[row] - recording.time[row - 1]))
        .filter(|(_, s)| *s > JUMP * step)
        .collect();
    jumps.sort_by(|a, b| b.1.total_cmp(&a.1));
    let count = jumps.len();
    let mut findings: Vec<Finding> = jumps
        .into_iter()
        .take(LISTED)
        .map(|(row, s)| Finding {
            kind: Kind::ClockJump,
            severity: Severity::Warning,
            joint: None,
            row: Some(row + 1),
            value: s,
            parameters: Vec::new(),
            message: format!(
                "time jumps by {s:.4} s (steps are {step:.4} s; {count} such jumps in all); \
                 the gap is interpolated, better mark it as a new trajectory"
            ),
        })
        .collect();
    if jitter > JITTER {
        findings.push(Finding {
            kind: Kind::Jitter,
            severity: Severity::Note,
            joint: None,
            row: None,
            value: jitter,
            parameters: Vec::new(),
            message: format!(
                "the time steps deviate by {:.0} % of {step:.4} s; the recording is resampled",
                100.0 * jitter
            ),
        });
    }
    findings
}
