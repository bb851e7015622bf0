//! How much one row says.

use crate::session::Session;
use ::identify::residuals::residual_tests;
use datasets::Recording;
use datasets::metrics::MOVING;
use ndarray::Array2;

/// What each row is multiplied by, shape (samples, joints): one over the deviation of what the fit leaves on its joint, in
/// motion or at rest and around reversals, times the root of how many neighbours tell the same (n over effective samples).
pub(super) fn scale(left: &Array2<f64>, session: &Session, recording: &Recording) -> Array2<f64> {
    let qd = &session.parts[0].at_samples.qd;
    let breaks = recording.starts();
    let mut scale = Array2::zeros(left.raw_dim());
    for (j, mut target) in scale.columns_mut().into_iter().enumerate() {
        let (e, v) = (left.column(j).to_vec(), qd.column(j).to_vec());
        let deviation = |moving: bool| {
            let mine = e
                .iter()
                .zip(&v)
                .filter(|(_, v)| (v.abs() > MOVING) == moving);
            let (sum, count) = mine.fold((0.0, 0usize), |(s, n), (e, _)| (s + e * e, n + 1));
            (count > 0).then(|| (sum / count as f64).sqrt())
        };
        let largest = e.iter().fold(f64::MIN_POSITIVE, |m, e| m.max(e.abs()));
        // A residual too short or too even to be tested counts as independent.
        let alike = residual_tests(&e, &e, &v, &breaks)
            .map_or(1.0, |t| t.samples as f64 / t.serial.effective_samples);
        let [standing, moving] = [false, true].map(|m| {
            let sigma = deviation(m).unwrap_or(largest).max(1e-9 * largest);
            1.0 / (sigma * alike.sqrt())
        });
        for (target, v) in target.iter_mut().zip(&v) {
            *target = if v.abs() > MOVING { moving } else { standing };
        }
    }
    scale
}

/// Root mean square of the part of a residual that neighbouring samples share, joint by joint: what a model leaves that is no
/// noise.
pub(super) fn shared(left: &Array2<f64>, recording: &Recording) -> Vec<f64> {
    let breaks = recording.starts();
    let of = |column: ndarray::ArrayView1<f64>| {
        let e = column.to_vec();
        residual_tests(&e, &e, &e, &breaks)
            .map_or(0.0, |t| t.std * t.serial.lag_one.max(0.0).sqrt())
    };
    left.columns().into_iter().map(of).collect()
}
