//! Shares of the gap and what leaving a cause out costs.
//!
//! With r the gap as given and c_k the torques of the causes from one joint fit, the squared error of a set S
//! of causes is |r − Σ_S c_k|². Shapley's value of a game that is quadratic in its players is exact without
//! enumeration: φ_k = 2 r·c_k − c_k·Σ_l c_l. What a push leaves out of the score counts as its torque.
//!
//! Causes that work against each other (friction near standstill and a smaller Coulomb coefficient) take from each
//! other's values, down to nothing, though neither can be done without. So a cause's part is at least what is lost
//! where it alone is left out and the rest fitted again.

use ndarray::Array2;

/// Squared NRMSE, summed over joints, that a cause's torque removes by Shapley's value; `all` is the sum of the causes'
/// torques. Shapes (samples, joints).
pub fn shapley(
    gap: &Array2<f64>,
    torque: &Array2<f64>,
    all: &Array2<f64>,
    deviation: &[Option<f64>],
) -> f64 {
    let each = deviation.iter().enumerate();
    let scored = each.filter_map(|(j, d)| Some((j, (*d)?)));
    let of = |(j, d): (usize, f64)| {
        let c = torque.column(j);
        (2.0 * gap.column(j).dot(&c) - c.dot(&all.column(j))) / (d * d)
    };
    scored.map(of).sum()
}

/// The same that is lost on some joints where a cause is left out, from the residuals with and without it.
pub fn lost(
    with: &Array2<f64>,
    without: &Array2<f64>,
    joints: &[usize],
    deviation: &[Option<f64>],
) -> f64 {
    let square = |t: &Array2<f64>, j: usize| t.column(j).dot(&t.column(j));
    let scored = joints.iter().filter_map(|&j| Some((j, deviation[j]?)));
    scored
        .map(|(j, d)| (square(without, j) - square(with, j)) / (d * d))
        .sum()
}

/// Shares that sum to one; what does harm has none.
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

    /// Two torques that nearly cancel: each alone is worth nothing by Shapley's value of one of them, both are needed.
    #[test]
    fn a_cause_that_another_works_against_keeps_what_is_lost_without_it() {
        // g = a + b, b mostly −a; a third is worth a little and stands alone on another joint.
        let a = array![[2.0, 0.0], [-2.0, 0.0], [2.0, 0.0], [-2.0, 0.0]];
        let b = array![[-3.0, 0.0], [2.0, 0.0], [-3.0, 0.0], [2.0, 0.0]];
        let c = array![[0.0, 0.1], [0.0, -0.1], [0.0, 0.1], [0.0, -0.1]];
        let gap = &a + &b + &c;
        let deviation = [Some(1.0), Some(1.0)];
        let value = |t: &Array2<f64>| shapley(&gap, t, &gap, &deviation);
        let total = gap.iter().map(|g| g * g).sum::<f64>();
        assert!((value(&a) + value(&b) + value(&c) - total).abs() < 1e-12);
        assert!(value(&a) < 0.0 && value(&c) > 0.0);
        // Without a, the best factor of b: what is lost is what b cannot make up for.
        let factor = gap.column(0).dot(&b.column(0)) / b.column(0).dot(&b.column(0));
        let without = &gap - &c - &(&b * factor);
        let lost = lost(&Array2::zeros((4, 2)), &without, &[0], &deviation);
        assert!(lost > value(&c));
        let shares = normed(&[value(&a).max(lost), value(&b), value(&c), -1.0]);
        assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        assert!(shares[0] > shares[2] && shares[3] == 0.0);
    }

    #[test]
    fn joints_that_are_not_scored_count_nothing() {
        let (with, without) = (Array2::zeros((3, 2)), Array2::ones((3, 2)));
        assert_eq!(lost(&with, &without, &[0, 1], &[None, Some(2.0)]), 0.75);
    }
}
