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

#[cfg(test)]
mod tests {
    use super::folds;

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
}
