//! Standard deviation that a prediction states, from errors on samples that were not fitted.

use crate::directory::ResidualStd;
use datasets::metrics::MOVING;
use ndarray::ArrayView2;
use serde::Serialize;

/// Half width of the central 90 % of a normal distribution, in standard deviations.
pub const NINETY: f64 = 1.644_854;

/// Errors of one joint on samples left out of what made them, with the joint's speeds (rad/s or m/s).
#[derive(Clone, Debug, Default)]
pub struct LeftOut {
    errors: [Vec<f64>; 2],
}

impl LeftOut {
    /// Adds the error of one sample.
    pub fn push(&mut self, error: f64, speed: f64) {
        self.errors[usize::from(speed.abs() > MOVING)].push(error.abs());
    }

    /// Standard deviations at standstill and in motion, such that ± [`NINETY`] of each holds 90 % of the
    /// errors. Where one regime has no sample, it gets the deviation of the other; `None` without any sample.
    fn deviations(&self) -> Option<[f64; 2]> {
        let of = |errors: &[f64]| {
            let mut sorted = errors.to_vec();
            sorted.sort_by(f64::total_cmp);
            let at = (0.9 * sorted.len() as f64).ceil() as usize;
            sorted.get(at.max(1) - 1).map(|q| q / NINETY)
        };
        match [of(&self.errors[0]), of(&self.errors[1])] {
            [Some(a), Some(b)] => Some([a, b]),
            [Some(a), None] | [None, Some(a)] => Some([a; 2]),
            [None, None] => None,
        }
    }
}

/// Standard deviations of all joints by regime; for a joint without errors those of `otherwise`.
pub fn by_regime(joints: &[LeftOut], otherwise: &ResidualStd) -> ResidualStd {
    let mut all = otherwise.clone();
    for (joint, left) in joints.iter().enumerate() {
        if let Some([standstill, moving]) = left.deviations() {
            all.standstill[joint] = standstill;
            all.moving[joint] = moving;
        }
    }
    all
}

/// Coverage: share of samples inside the stated 90 % intervals on a recording.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Coverage {
    /// Coverage on each joint, 0 to 1.
    pub joints: Vec<f64>,
    /// Coverage of all samples in motion; none where no sample is in motion.
    pub moving: Option<f64>,
    /// Coverage of all samples at standstill; none where no sample is at standstill.
    pub standstill: Option<f64>,
    /// Coverage of all samples of all joints.
    pub all: f64,
}

impl Coverage {
    /// Share of errors within ± [`NINETY`] standard deviations; all tables of shape (samples, joints).
    pub fn of(errors: ArrayView2<f64>, deviation: ArrayView2<f64>, qd: ArrayView2<f64>) -> Self {
        let mut count = vec![[[0usize; 2]; 2]; errors.ncols()];
        for ((row, joint), error) in errors.indexed_iter() {
            let inside = error.abs() <= NINETY * deviation[[row, joint]];
            let moves = qd[[row, joint]].abs() > MOVING;
            count[joint][usize::from(moves)][usize::from(inside)] += 1;
        }
        let share = |counts: &mut dyn Iterator<Item = [usize; 2]>| {
            let [out, inside] = counts.fold([0; 2], |[a, b], [c, d]| [a + c, b + d]);
            inside as f64 / (out + inside) as f64
        };
        let of = |regime: usize| {
            Some(share(&mut count.iter().map(|c| c[regime]))).filter(|s| s.is_finite())
        };
        Self {
            joints: count
                .iter()
                .map(|c| share(&mut c.iter().copied()))
                .collect(),
            moving: of(1),
            standstill: of(0),
            all: share(&mut count.iter().flatten().copied()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coverage_by_hand() {
        let errors = ndarray::array![[1.0, -3.0], [2.0, 0.5], [-1.6, 0.0]];
        let ones = ndarray::Array2::ones((3, 2));
        let qd = ndarray::array![[0.5, 0.0], [0.5, 0.0], [0.0, 0.0]];
        let found = Coverage::of(errors.view(), ones.view(), qd.view());
        assert_eq!(found.joints, [2.0 / 3.0; 2]);
        assert_eq!(found.moving, Some(0.5));
        assert_eq!(found.standstill, Some(0.75));
        assert_eq!(found.all, 4.0 / 6.0);
    }

    #[test]
    fn nine_of_ten_are_inside() {
        let mut left = LeftOut::default();
        for k in 1..=10 {
            left.push(if k % 2 == 0 { -1.0 } else { 1.0 } * f64::from(k), 0.5);
        }
        let fitted = ResidualStd {
            moving: vec![1.0; 2],
            standstill: vec![1.0; 2],
        };
        let found = by_regime(&[left, LeftOut::default()], &fitted);
        // No sample at rest: as in motion. Nothing of the second joint: as fitted.
        assert_eq!(found.moving, [9.0 / NINETY, 1.0]);
        assert_eq!(found.standstill, [9.0 / NINETY, 1.0]);
    }
}
