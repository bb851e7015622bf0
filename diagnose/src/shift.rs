//! Shift between recorded torque and motion.

use datasets::Recording;
use ndarray::Array2;
use signal::correlation;
use signal::quantile::median;

/// Shift of the recorded torque behind a prediction on the same motion, per joint, in s: median
/// over trajectories, within ± `longest_s`. `None` for a joint without a clear peak.
///
/// `predicted` has the shape (samples, joints).
pub fn torque_shift(
    recording: &Recording,
    predicted: &Array2<f64>,
    longest_s: f64,
) -> Vec<Option<f64>> {
    let Some(tau) = &recording.tau else {
        return vec![None; recording.dof()];
    };
    let step = recording.median_step();
    let longest = (longest_s / step).ceil() as usize;
    (0..recording.dof())
        .map(|joint| {
            let shifts: Vec<f64> = recording
                .trajectories
                .iter()
                .filter_map(|t| {
                    let of = |table: &Array2<f64>| -> Vec<f64> {
                        t.range.clone().map(|r| table[(r, joint)]).collect()
                    };
                    let lag = correlation::lag(&of(predicted), &of(tau), longest)?;
                    (lag.correlation > 0.5 && lag.samples.abs() < longest as f64)
                        .then_some(lag.samples * step)
                })
                .collect();
            median(shifts)
        })
        .collect()
}
