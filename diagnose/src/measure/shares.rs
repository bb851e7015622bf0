//! Shares of the gap, and the loss when a cause is left out.
//!
//! With r the gap as given and c_k the torques of the causes from one joint fit, the squared error of a set S
//! of causes is |r − Σ_S c_k|². Shapley's value of a game that is quadratic in its players is exact without
//! enumeration: φ_k = 2 r·c_k − c_k·Σ_l c_l. What a push leaves out of the score counts as its torque.
//!
//! Causes that oppose each other (friction near standstill and a smaller Coulomb coefficient) reduce each
//! other's Shapley values, down to zero, though neither can be left out. So a cause's part is at least the loss
//! when it alone is left out and the others are fitted again.

use ndarray::Array2;

/// Torques for the share of one cause, N·m (N), all of shape (samples, joints).
pub struct Removed<'a> {
    /// Gap: measured torque less that of the model as given.
    pub gap: &'a Array2<f64>,
    /// Torque of all causes together.
    pub all: &'a Array2<f64>,
    /// Torque of the cause whose share is taken.
    pub torque: &'a Array2<f64>,
    /// Residual with all causes.
    pub with: &'a Array2<f64>,
    /// Residual with all other causes, fitted again.
    pub without: &'a Array2<f64>,
}

impl Removed<'_> {
    /// Value of the cause: squared NRMSE, summed over joints and samples. It is the Shapley value, or the loss
    /// without the cause where that is more.
    pub fn value(&self, deviation: &[Option<f64>]) -> f64 {
        let each = deviation.iter().enumerate();
        let scored = || each.clone().filter_map(|(j, d)| Some((j, (*d)?)));
        let own = |(j, d): (usize, f64)| {
            let c = self.torque.column(j);
            (2.0 * self.gap.column(j).dot(&c) - c.dot(&self.all.column(j))) / (d * d)
        };
        let square = |t: &Array2<f64>, j: usize| t.column(j).dot(&t.column(j));
        let lost =
            |(j, d): (usize, f64)| (square(self.without, j) - square(self.with, j)) / (d * d);
        let shapley: f64 = scored().map(own).sum();
        shapley.max(scored().map(lost).sum())
    }
}

/// Shares that sum to one; a negative value gets none.
pub fn normed(values: &[f64]) -> Vec<f64> {
    let sum: f64 = values.iter().map(|v| v.max(0.0)).sum();
    let share = |v: &f64| if sum > 0.0 { v.max(0.0) / sum } else { 0.0 };
    values.iter().map(share).collect()
}

/// Part of the joints' squared error that is removed, with a 90 % interval by bootstrap over blocks of time.
pub fn closed(
    with: &Array2<f64>,
    without: &Array2<f64>,
    joints: &[usize],
    block: usize,
) -> (f64, [f64; 2]) {
    let block = block.max(1);
    let sums: Vec<(f64, f64)> = (0..with.nrows().div_ceil(block))
        .map(|b| {
            let rows = b * block..((b + 1) * block).min(with.nrows());
            let squares = |t: &Array2<f64>| {
                joints
                    .iter()
                    .map(|&j| rows.clone().map(|i| t[[i, j]] * t[[i, j]]).sum::<f64>())
                    .sum::<f64>()
            };
            let before = squares(without);
            (before - squares(with), before)
        })
        .collect();
    signal::bootstrap::ratio(&sums)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::array;

    /// Two torques that nearly cancel: by Shapley's value one of them is worth less than nothing, and both are needed.
    #[test]
    fn a_cause_that_another_works_against_keeps_what_is_lost_without_it() {
        let a = array![[2.0, 0.0], [-2.0, 0.0], [2.0, 0.0], [-2.0, 0.0]];
        let b = array![[-3.0, 0.0], [2.0, 0.0], [-3.0, 0.0], [2.0, 0.0]];
        // Worth a little, on a joint of its own.
        let c = array![[0.0, 0.1], [0.0, -0.1], [0.0, 0.1], [0.0, -0.1]];
        let gap = &a + &b + &c;
        let nothing = Array2::zeros((4, 2));
        // Without one, the best that the other two make of it.
        let best =
            |t: &Array2<f64>| t * (gap.column(0).dot(&t.column(0)) / t.column(0).dot(&t.column(0)));
        let value = |torque: &Array2<f64>, without: &Array2<f64>| {
            let removed = Removed {
                gap: &gap,
                all: &gap,
                torque,
                with: &nothing,
                without,
            };
            removed.value(&[Some(1.0), Some(1.0)])
        };
        let only = |torque: &Array2<f64>| value(torque, &nothing);
        let total = gap.iter().map(|g| g * g).sum::<f64>();
        // What is lost counts from zero here, so Shapley's values show where they are positive.
        assert!((only(&b) + only(&c) - total).abs() > 1e-3 && only(&a) == 0.0);
        let values = [
            value(&a, &(&gap - &c - &best(&b))),
            value(&b, &(&gap - &c - &best(&a))),
            value(&c, &c),
        ];
        assert!(values[0] > values[2] && values[1] > values[2] && values[2] > 0.0);
        let shares = normed(&[values[0], values[1], values[2], -1.0]);
        assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        assert_eq!(shares[3], 0.0);
    }

    #[test]
    fn joints_that_are_not_scored_count_nothing() {
        let (zero, one) = (Array2::zeros((3, 2)), Array2::ones((3, 2)));
        let removed = Removed {
            gap: &one,
            all: &zero,
            torque: &zero,
            with: &zero,
            without: &one,
        };
        assert_eq!(removed.value(&[None, Some(2.0)]), 0.75);
    }
}
