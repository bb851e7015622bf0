//! Bursts that are the cut of a saturated torque.

use ndarray::ArrayView1;
use signal::quantile::quantile;

/// Quantile of the torque's magnitude that counts as the largest torque.
const LARGEST: f64 = 0.995;

/// Part of a joint's squared burst torque `push` at samples where the recorded torque is less than the
/// predicted one, and the predicted one larger than nearly any recorded one. There the channel or the drive
/// saturates. A hard push makes the *recorded* torque large.
pub(super) fn cut_off(tau: ArrayView1<f64>, push: ArrayView1<f64>) -> f64 {
    let sizes = tau.iter().map(|t| t.abs()).collect();
    let Some(largest) = quantile(sizes, LARGEST) else {
        return 0.0;
    };
    let (mut cut, mut all) = (0.0, 0.0);
    for (t, p) in tau.iter().zip(push) {
        let predicted = t - p;
        all += p * p;
        if p * predicted < 0.0 && t * predicted > 0.0 && predicted.abs() > largest {
            cut += p * p;
        }
    }
    if all > 0.0 { cut / all } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array1;

    #[test]
    fn what_is_cut_off_is_no_push() {
        let load = Array1::from_shape_fn(2000, |i| 10.0 * (0.01 * i as f64).sin());
        let recorded = load.mapv(|t: f64| t.clamp(-8.0, 8.0));
        let cut = &recorded - &load;
        assert!(cut_off(recorded.view(), cut.view()) > 0.99);
        let push = Array1::from_shape_fn(2000, |i| if i % 700 < 90 { -6.0 } else { 0.0 });
        assert!(cut_off((&load + &push).view(), push.view()) < 0.3);
    }
}
