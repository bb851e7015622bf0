//! Weights of the rows by their noise and its autocorrelation.

use crate::session::Session;
use ::identify::residuals::residual_tests;
use datasets::Recording;
use datasets::metrics::MOVING;
use ndarray::{Array2, ArrayView1};

/// Factor on each row, shape (samples, joints): see [`weights`].
pub(super) fn scale(left: &Array2<f64>, session: &Session, recording: &Recording) -> Array2<f64> {
    let qd = &session.parts[0].at_samples.qd;
    let weights = weights(left, qd, &recording.starts());
    Array2::from_shape_fn(left.raw_dim(), |(k, j)| weights[j][moving(qd[[k, j]])])
}

/// Factors on the rows of each joint, at rest and around reversals, and in motion. Each is the inverse standard
/// deviation of the residual there, divided by the square root of samples per effective sample.
///
/// `left` and `qd` of shape (samples, joints), `starts` the first row of each trajectory.
pub(super) fn weights(left: &Array2<f64>, qd: &Array2<f64>, starts: &[usize]) -> Vec<[f64; 2]> {
    let joints = left.columns().into_iter().zip(qd.columns());
    let of = |(e, v): (ArrayView1<f64>, ArrayView1<f64>)| {
        let (e, v) = (e.to_vec(), v.to_vec());
        let deviation = |regime: usize| {
            let mine = e.iter().zip(&v).filter(|(_, v)| moving(**v) == regime);
            let (sum, count) = mine.fold((0.0, 0usize), |(s, n), (e, _)| (s + e * e, n + 1));
            (count > 0).then(|| (sum / count as f64).sqrt())
        };
        let largest = e.iter().fold(f64::MIN_POSITIVE, |m, e| m.max(e.abs()));
        // A residual too short or too even to be tested counts as independent.
        let alike = residual_tests(&e, &e, &v, starts)
            .map_or(1.0, |t| t.samples as f64 / t.serial.effective_samples);
        [0, 1].map(|regime| {
            let sigma = deviation(regime).unwrap_or(largest).max(1e-9 * largest);
            1.0 / (sigma * alike.sqrt())
        })
    };
    joints.map(of).collect()
}

/// Root mean square of one joint's residual in units of its weights.
pub(super) fn weighted_rms(
    left: &Array2<f64>,
    qd: &Array2<f64>,
    weights: &[[f64; 2]],
    joint: usize,
) -> f64 {
    let rows = left.column(joint).into_iter().zip(qd.column(joint));
    let squares = rows.map(|(e, v)| (e * weights[joint][moving(*v)]).powi(2));
    (squares.sum::<f64>() / left.nrows().max(1) as f64).sqrt()
}

/// Regime of a row: 1 in motion, 0 at rest and around reversals.
pub(super) fn moving(qd: f64) -> usize {
    usize::from(qd.abs() > MOVING)
}

/// Root mean square of the part of a residual that neighbouring samples share, by joint: model error rather
/// than noise. `left` and `starts` as in [`weights`].
pub(super) fn shared(left: &Array2<f64>, starts: &[usize]) -> Vec<f64> {
    let of = |column: ArrayView1<f64>| {
        let e = column.to_vec();
        residual_tests(&e, &e, &e, starts).map_or(0.0, |t| t.std * t.serial.lag_one.max(0.0).sqrt())
    };
    left.columns().into_iter().map(of).collect()
}
