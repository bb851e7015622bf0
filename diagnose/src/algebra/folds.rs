//! Groups of rows that are left out together.

use std::ops::Range;

/// Most folds; with more trajectories than that, neighbours in the file share one, so that
/// executions of one motion, which follow each other, are left out together.
const MOST: usize = 12;
/// Fewest folds; with fewer trajectories they are cut in time.
const FEWEST: usize = 4;

/// Folds of whole trajectories, or of stretches of time where there are few trajectories.
pub fn folds(trajectories: &[Range<usize>]) -> Vec<Vec<Range<usize>>> {
    let n = trajectories.len();
    if n >= FEWEST {
        let k = n.min(MOST);
        return (0..k)
            .map(|f| trajectories[f * n / k..(f + 1) * n / k].to_vec())
            .collect();
    }
    let pieces = (2 * FEWEST).div_ceil(n.max(1));
    trajectories
        .iter()
        .flat_map(|t| -> Vec<Vec<Range<usize>>> {
            let at = move |p: usize| t.start + t.len() * p / pieces;
            (0..pieces)
                .map(move |p| std::iter::once(at(p)..at(p + 1)).collect())
                .collect()
        })
        .filter(|f| !f[0].is_empty())
        .collect()
}

/// Deviation of a number by what it is without each block (jackknife); none of fewer than three.
pub fn jackknife(without: &[f64]) -> Option<f64> {
    let count = without.len() as f64;
    let mean = without.iter().sum::<f64>() / count;
    let square = without.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
    (count >= 3.0).then(|| ((count - 1.0) / count * square).sqrt())
}

#[cfg(test)]
mod tests {
    use super::{folds, jackknife};

    #[test]
    fn folds_cover_every_row_once() {
        for n in [1, 3, 8, 66] {
            let trajectories: Vec<_> = (0..n).map(|i| i * 50..(i + 1) * 50).collect();
            let folds = folds(&trajectories);
            assert!((4..=12).contains(&folds.len()));
            let rows: Vec<usize> = folds.into_iter().flatten().flatten().collect();
            assert_eq!(rows, (0..50 * n).collect::<Vec<_>>());
        }
    }

    #[test]
    fn the_jackknife_of_a_mean_is_its_deviation() {
        let values = [1.0, 2.0, 4.0, 7.0];
        let without = values.map(|v| (14.0 - v) / 3.0);
        // Spread of the values over the square root of their number.
        let variance = values.iter().map(|v| (v - 3.5_f64).powi(2)).sum::<f64>() / 3.0;
        let std = jackknife(&without).unwrap();
        assert!((std - (variance / 4.0).sqrt()).abs() < 1e-12, "{std}");
        assert_eq!(jackknife(&without[..2]), None);
    }
}
