//! Test whether bursts push to one side, as a person who touches the robot does; vibration swings about zero.

use ndarray::Array2;
use std::ops::Range;

/// Part of the bursts' squared torque, relative to the joints' levels in `usual`, in the means over pieces of at most
/// `piece` samples. A force that is held while the robot moves under it loads each joint in either direction,
/// but changes slowly. `bursts`: samples and last loaded joint of each; `torque` of shape (samples, joints).
pub(super) fn steadiness(
    torque: &Array2<f64>,
    bursts: impl Iterator<Item = (Range<usize>, usize)>,
    usual: &[f64],
    piece: usize,
) -> f64 {
    let (mut mean, mut all) = (0.0, 0.0);
    for (samples, last_joint) in bursts {
        let rows: Vec<usize> = samples.collect();
        let pieces = rows.len().div_ceil(piece.max(1));
        for rows in rows.chunks(rows.len().div_ceil(pieces.max(1)).max(1)) {
            for (j, level) in usual.iter().enumerate().take(last_joint + 1) {
                let (sum, square) = rows
                    .iter()
                    .map(|&i| torque[[i, j]] / level)
                    .fold((0.0, 0.0), |(s, q), x| (s + x, q + x * x));
                mean += sum * sum / rows.len() as f64;
                all += square;
            }
        }
    }
    mean / all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::ContactSettings;

    #[test]
    fn a_push_is_steady_and_a_vibration_is_not() {
        let n = 400;
        let of = |f: &dyn Fn(f64) -> f64| {
            let torque = Array2::from_shape_fn((n, 2), |(i, j)| {
                (1.0 + j as f64) * f((i as f64 - 100.0) / 200.0)
            });
            steadiness(&torque, std::iter::once((100..300, 1)), &[0.1, 0.3], 50)
        };
        let push = of(&|x| (std::f64::consts::PI * x).sin());
        let swing = of(&|x| (std::f64::consts::TAU * 6.0 * x).sin() * (1.0 - x));
        // 100 Hz: three swings a second are none, one force that turns round in two seconds is one, though its mean over all is nothing.
        let turning = of(&|x| (std::f64::consts::TAU * 2.0 * x).sin());
        let least = ContactSettings::default().steady;
        assert!(push > 0.7 && swing < 0.5 * least, "{push} {swing}");
        assert!(turning > 2.0 * least, "{turning}");
    }
}
