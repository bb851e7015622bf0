//! The recorded velocity against the derivative of the recorded position.

use crate::Recording;
use crate::channel::Estimate95;
use crate::prepare::Prepared;
use signal::delay::{Search, System, estimate};
use signal::{resample, smoother};

/// Cut-off of the low-pass of recorded and derived velocity, Hz, and as a part of the rate: the motion's band, in which
/// a derivative is hardly noisy.
const BAND_HZ: f64 = 10.0;
const BAND_PART: f64 = 0.2;
/// Delays of the velocity that are tried, s.
const RANGE: [f64; 2] = [-0.06, 0.06];

/// Relation of a recorded velocity to dq/dt: gain and delay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct VelocityChannel {
    /// Gain of the recorded velocity over the derived one.
    pub gain: f64,
    /// Delay of the recorded velocity after dq/dt, s.
    pub late: Estimate95,
}

/// Compares the recorded velocity of a joint with the derivative of its position alone, whatever preparation made of
/// both. None where no velocity was recorded or too little to compare.
pub(super) fn compare(
    recording: &Recording,
    prepared: &Prepared,
    joint: usize,
) -> Option<VelocityChannel> {
    let recorded = recording.qd.as_ref()?.column(joint).to_vec();
    let position = recording.q.column(joint).to_vec();
    let rate = prepared.report.fine_hz;
    let cutoff = BAND_HZ.min(BAND_PART / recording.median_step());
    let (mut derived, mut target, mut steps) = (Vec::new(), Vec::new(), Vec::new());
    for (trajectory, grid) in recording.trajectories.iter().zip(&prepared.fine.segments) {
        let rows = trajectory.range.clone();
        let (time, at) = (
            &recording.time[rows.clone()],
            &prepared.fine.time[grid.clone()],
        );
        let smooth = |values: &[f64]| -> Option<Vec<f64>> {
            let uniform = resample::cubic(time, values, at).ok()?;
            smoother::low_pass(&uniform, cutoff, rate).ok()
        };
        let q = smooth(&position[rows.clone()])?;
        let step = (at[at.len() - 1] - at[0]) / (at.len() - 1) as f64;
        let last = q.len() - 1;
        derived.extend((0..=last).map(|k| {
            let (a, b) = (k.saturating_sub(1), (k + 1).min(last));
            (q[b] - q[a]) / (step * (b - a) as f64)
        }));
        target.extend(smooth(&recorded[rows])?);
        steps.push(step);
    }
    let system = System {
        columns: vec![derived, vec![1.0; target.len()]],
        target,
        segments: prepared.fine.segments.clone(),
        steps,
    };
    let search = Search {
        range: RANGE,
        ..Search::default()
    };
    if let Some(found) = estimate(&system, &search) {
        return Some(VelocityChannel {
            gain: found.coefficients[0],
            late: Estimate95::new(found.delay, found.interval()),
        });
    }
    // No delay makes one of the other: only the size is left to compare.
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let own = product(&system.columns[0], &system.columns[0]);
    (own > 0.0).then(|| VelocityChannel {
        gain: product(&system.columns[0], &system.target) / own,
        late: Estimate95::NONE,
    })
}
