//! Lower weights of rows near a joint's reversals. No model knows the sign of friction there, and how the joint
//! comes to rest, to the millisecond. Such an error must not count as the noise of the whole motion.

use crate::motion::frame::Frame;
use crate::settings::MotionSettings;
use ndarray::{Array1, Array2, ArrayView1};

/// Upper ends of the groups of rows by time from a reversal, s.
const NEAR: [f64; 4] = [0.02, 0.06, 0.12, 0.25];
/// Least number of rows in a group for its mean squared error.
const FEWEST: usize = 40;
/// Least part of a joint's rows that must be away from reversals.
const AWAY: f64 = 0.25;
/// Smallest weight that a row near a reversal gets.
const LEAST: f64 = 0.1;

/// Largest weight of each row, shape (rows, joints): mean squared residual away from the joint's reversals over
/// that at such a time from one, and at most one. `left` is the residual.
pub(super) fn weights(left: &Array2<f64>, frame: &Frame, settings: &MotionSettings) -> Array2<f64> {
    let from = frame.rows_to_turns(settings.reversal_speed);
    let mut out = Array2::ones(left.dim());
    for (j, mut column) in out.columns_mut().into_iter().enumerate() {
        let near: Vec<usize> = from
            .column(j)
            .iter()
            .map(|&rows| {
                let time = rows as f64 / frame.row_rate();
                NEAR.partition_point(|most| *most < time)
            })
            .collect();
        column.assign(&of_joint(left.column(j), &near));
    }
    out
}

/// Largest weights of one joint's rows from the group of each row; the last group is away from reversals.
fn of_joint(left: ArrayView1<f64>, near: &[usize]) -> Array1<f64> {
    let mut sums = [(0.0, 0usize); NEAR.len() + 1];
    for (x, &k) in left.iter().zip(near) {
        sums[k].0 += x * x;
        sums[k].1 += 1;
    }
    let (square, away) = sums[NEAR.len()];
    if away < FEWEST || (away as f64) < AWAY * near.len() as f64 {
        return Array1::ones(near.len());
    }
    let away = square / away as f64;
    let weight = sums.map(|(square, rows)| {
        if rows < FEWEST {
            return None;
        }
        Some((away / (square / rows as f64).max(1e-300)).clamp(LEAST, 1.0))
    });
    // Too few rows say what the next ones further away do.
    let known = |k: usize| weight[k..].iter().flatten().next().copied();
    near.iter().map(|&k| known(k).unwrap_or(1.0)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_count_as_much_as_they_are_sure() {
        let near: Vec<usize> = (0..1000)
            .map(|i| if i % 5 == 0 { 0 } else { NEAR.len() })
            .collect();
        let left = Array1::from_shape_fn(1000, |i| if i % 5 == 0 { 2.0 } else { 1.0 });
        let weight = of_joint(left.view(), &near);
        assert!(
            weight
                .iter()
                .zip(&near)
                .all(|(w, k)| *w == if *k == 0 { 0.25 } else { 1.0 })
        );
        // Where the joint turns all the time nothing is away from turns.
        let busy = vec![0; 1000];
        assert!(of_joint(left.view(), &busy).iter().all(|w| *w == 1.0));
    }
}
