//! Columns of a motion at an earlier or later time.

use ndarray::{Array1, ArrayView1};
use signal::Motion;

/// x(t − delay) by linear interpolation within each segment, held at its ends.
pub fn delayed(motion: &Motion, x: ArrayView1<f64>, delay: f64) -> Array1<f64> {
    let time = &motion.time;
    let mut out = Array1::zeros(x.len());
    for s in &motion.segments {
        let mut k = s.start;
        for i in s.clone() {
            let t = time[i] - delay;
            while k + 2 < s.end && time[k + 1] < t {
                k += 1;
            }
            let b = (k + 1).min(s.end - 1);
            let share = if b > k {
                ((t - time[k]) / (time[b] - time[k])).clamp(0.0, 1.0)
            } else {
                0.0
            };
            out[i] = x[k] + share * (x[b] - x[k]);
        }
    }
    out
}
