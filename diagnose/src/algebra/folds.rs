//! Folds: groups of rows that are left out together.

use datasets::{Folds, Recording};
use std::ops::Range;

/// Largest number of folds: with more the search takes longer, with fewer each fold leaves out much data.
const MOST: usize = 8;

/// A fold of fitted rows. Each range lies in one trajectory.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Fold {
    /// Rows that are scored by a fit to the others.
    pub scored: Vec<Range<usize>>,
    /// Rows of other folds so near to the scored ones that they are left out of that fit, too.
    pub near: Vec<Range<usize>>,
}

/// Folds of a recording by [`Folds::of_motions`]. `rows` are the fitted rows of each trajectory, one in
/// `stride` samples. Rows closer than `gap`, s, to a block cut out of a trajectory are near to it.
pub fn folds(recording: &Recording, rows: &[Range<usize>], stride: usize, gap: f64) -> Vec<Fold> {
    let dealt = Folds::of_motions(&[recording], MOST, gap);
    let mut out = vec![Fold::default(); dealt.count];
    for (trajectory, rows) in recording.trajectories.iter().zip(rows) {
        let samples = &trajectory.range;
        let row = |sample: usize| rows.start + (sample - samples.start).div_ceil(stride);
        let own = |part: &&(Range<usize>, usize)| samples.contains(&part.0.start);
        // Cells of one fold that follow each other are one range.
        let mut last = None;
        for (part, cell) in dealt.rows[0].iter().filter(own) {
            let range = row(part.start)..row(part.end).min(rows.end);
            let cell = &dealt.cells[*cell];
            for &f in &cell.near {
                out[f].near.push(range.clone());
            }
            match out[cell.fold].scored.last_mut() {
                Some(before) if last == Some(cell.fold) => before.end = range.end,
                _ => out[cell.fold].scored.push(range),
            }
            last = Some(cell.fold);
        }
    }
    for fold in &mut out {
        fold.scored.retain(|r| !r.is_empty());
        fold.near.retain(|r| !r.is_empty());
    }
    out.retain(|fold| !fold.scored.is_empty());
    out
}

/// Jackknife standard deviation of a number from its values without each block; none with fewer than three blocks.
pub fn jackknife(without: &[f64]) -> Option<f64> {
    let count = without.len() as f64;
    let mean = without.iter().sum::<f64>() / count;
    let square = without.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
    (count >= 3.0).then(|| ((count - 1.0) / count * square).sqrt())
}

#[cfg(test)]
mod tests {
    use super::{Fold, folds, jackknife};
    use datasets::{Recording, Trajectory};
    use ndarray::Array2;
    use std::ops::Range;

    /// Trajectories of eight seconds at 50 Hz, of so many different motions in turn.
    fn recording(trajectories: usize, motions: usize) -> Recording {
        let at = |i: usize| (i / 401, (i % 401) as f64 / 50.0);
        let n = 401 * trajectories;
        let time = (0..n).map(|i| 100.0 * at(i).0 as f64 + at(i).1).collect();
        let q = Array2::from_shape_fn((n, 1), |(i, _)| {
            let ((k, t), noise) = (at(i), 1e-4 * (37 * i % 101) as f64 / 101.0);
            (t * (1.0 + 0.3 * (k % motions) as f64) + 0.05 * t * t).sin() + noise
        });
        let one = |k: usize| Trajectory {
            label: k.to_string(),
            range: 401 * k..401 * (k + 1),
        };
        Recording {
            trajectories: (0..trajectories).map(one).collect(),
            ..Recording::new("test", time, q, None)
        }
    }

    /// One row in four samples.
    fn rows(trajectories: usize) -> Vec<Range<usize>> {
        (0..trajectories).map(|k| 101 * k..101 * (k + 1)).collect()
    }

    fn fold_of(folds: &[Fold], row: usize) -> usize {
        let of = |f: &Fold| f.scored.iter().any(|r| r.contains(&row));
        folds.iter().position(of).unwrap()
    }

    #[test]
    fn folds_cover_every_row_once() {
        for n in [1, 3, 8, 66] {
            let folds = folds(&recording(n, n), &rows(n), 4, 0.5);
            assert!((4..=9).contains(&folds.len()), "{n}");
            let mut covered: Vec<usize> = folds
                .iter()
                .flat_map(|f| f.scored.iter().cloned().flatten())
                .collect();
            covered.sort_unstable();
            assert_eq!(covered, (0..101 * n).collect::<Vec<_>>());
        }
    }

    #[test]
    fn no_pair_of_repeats_straddles_folds() {
        // A B C D E F A B C D E F
        let dealt = folds(&recording(12, 6), &rows(12), 4, 0.5);
        assert_eq!(dealt.len(), 6);
        assert!(dealt.iter().all(|f| f.near.is_empty()));
        for row in 0..606 {
            assert_eq!(fold_of(&dealt, row), fold_of(&dealt, row + 606));
        }
        // A B C A B C: three motions are cut, at the same places.
        let dealt = folds(&recording(6, 3), &rows(6), 4, 0.5);
        assert_eq!(dealt.len(), 9);
        for row in 0..303 {
            assert_eq!(fold_of(&dealt, row), fold_of(&dealt, row + 303));
        }
    }

    #[test]
    fn nothing_is_fitted_within_the_gap_of_a_cut() {
        // Eight blocks of a second, of which a quarter is the gap; a row every 0.08 s.
        let dealt = folds(&recording(1, 1), &rows(1), 4, 0.5);
        assert_eq!(dealt.len(), 8);
        for (f, fold) in dealt.iter().enumerate() {
            let (from, to) = (f as f64, (f + 1) as f64);
            for row in 0..101 {
                let t = 0.08 * row as f64;
                let before = t < from && t > from - 0.25;
                // The last block ends with the trajectory.
                let after = f < 7 && t > to - 1e-9 && t < to + 0.25;
                let near = fold.near.iter().any(|r| r.contains(&row));
                assert_eq!(near, before || after, "fold {f}, row {row}");
            }
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
