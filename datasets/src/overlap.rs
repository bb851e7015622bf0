//! Rows that stand in two recordings, whatever file and number of digits they were written with.

use crate::Recording;
use crate::recording::MIN_SAMPLES;
use std::collections::HashMap;

/// Difference, relative to a column's range, up to which two values are one that was written with different digits: tables hold five at least.
const DIGITS: f64 = 1e-5;
/// Most rows of a recording that a thinner copy of it leaves out between two.
const THINNED: usize = 10;
/// Rows that are kept of a recording, to recognise it.
const KEPT: usize = 24;
/// Rows of these that have to come again: coarse positions and torques may be equal once by accident.
const ENOUGH: usize = 3;

/// Number of rows of `other` that stand in one of `fitted` as well, as part of a stretch in motion.
///
/// Stretches are as long as the shortest trajectory: single rows of a robot at rest may well be the same.
pub fn overlap(fitted: &[Recording], other: &Recording) -> usize {
    let (rows, within) = (rows(other), tolerances(other));
    let mut shared = vec![false; rows.len()];
    for known in fitted {
        let own = tolerances(known);
        let within: Vec<f64> = within.iter().zip(own).map(|(a, b)| a.max(b)).collect();
        let table = Table::new(self::rows(known), within);
        for t in &other.trajectories {
            // Length of the common stretch that ends in each matching row of the table.
            let mut runs: HashMap<usize, usize> = HashMap::new();
            for row in t.range.clone().skip(1) {
                let moves = !table.alike(&rows[row], &rows[row - 1]);
                let same = if moves {
                    table.same(&rows[row])
                } else {
                    Vec::new()
                };
                let ends = same.into_iter().map(|i| {
                    let before = (i.saturating_sub(THINNED)..i).filter_map(|k| runs.get(&k));
                    (i, 1 + before.copied().max().unwrap_or(0))
                });
                runs = ends.collect();
                let longest = runs.values().copied().max().unwrap_or(0);
                // The first row of the stretch moves into its second one, which is the first that counts.
                if longest + 1 >= MIN_SAMPLES {
                    shared[row - longest..=row].fill(true);
                }
            }
        }
    }
    shared.into_iter().filter(|s| *s).count()
}

/// Some rows of a recording in motion: positions, then torques.
pub fn kept_rows(recording: &Recording) -> Vec<Vec<f64>> {
    let table = Table::new(rows(recording), tolerances(recording));
    let moving: Vec<usize> = (1..recording.len())
        .filter(|&i| !table.alike(&table.rows[i], &table.rows[i - 1]))
        .collect();
    let many = moving.len().min(KEPT);
    (0..many)
        .map(|k| table.rows[moving[k * moving.len() / many]].clone())
        .collect()
}

/// Whether a recording holds the recording, or a part of it, of which [`kept_rows`] were kept.
pub fn holds(recording: &Recording, kept: &[Vec<f64>]) -> bool {
    let table = Table::new(rows(recording), tolerances(recording));
    let here = |row: &&Vec<f64>| {
        let known = row.len() >= recording.dof();
        known && !table.same(row).is_empty()
    };
    kept.iter().filter(here).count() >= ENOUGH
}

/// Rows with a search for equal ones.
struct Table {
    rows: Vec<Vec<f64>>,
    within: Vec<f64>,
    /// The column that tells rows apart best.
    key: usize,
    /// Rows that differ from the one before, by that column.
    order: Vec<usize>,
}

impl Table {
    fn new(rows: Vec<Vec<f64>>, within: Vec<f64>) -> Self {
        let columns = rows.first().map_or(0, Vec::len).min(within.len());
        let levels = |c: usize| {
            let values = sorted(rows.iter().map(|row| row[c]));
            values
                .windows(2)
                .filter(|w| w[1] - w[0] > within[c])
                .count()
        };
        let key = (0..columns).max_by_key(|&c| levels(c)).unwrap_or(0);
        let mut table = Self {
            within,
            key,
            order: Vec::new(),
            rows,
        };
        table.order = (0..table.rows.len())
            .filter(|&i| i == 0 || !table.alike(&table.rows[i], &table.rows[i - 1]))
            .collect();
        let rows = &table.rows;
        table
            .order
            .sort_by(|&a, &b| rows[a][key].total_cmp(&rows[b][key]));
        table
    }

    /// Whether two rows are one, in the columns that both have.
    fn alike(&self, a: &[f64], b: &[f64]) -> bool {
        let each = a.iter().zip(b).zip(&self.within);
        each.into_iter()
            .all(|((a, b), within)| (a - b).abs() <= *within)
    }

    /// The moving rows that are this one.
    fn same(&self, row: &[f64]) -> Vec<usize> {
        let Some(key) = row.get(self.key) else {
            return Vec::new();
        };
        let within = self.within[self.key];
        let start = self
            .order
            .partition_point(|&i| self.rows[i][self.key] < key - within);
        let near = self.order[start..].iter();
        near.take_while(|&&i| self.rows[i][self.key] <= key + within)
            .copied()
            .filter(|&i| self.alike(&self.rows[i], row))
            .collect()
    }
}

/// Positions, then torques, by row.
fn rows(recording: &Recording) -> Vec<Vec<f64>> {
    let tables = || std::iter::once(&recording.q).chain(&recording.tau);
    let of = |row: usize| tables().flat_map(|t| t.row(row).to_vec()).collect();
    (0..recording.len()).map(of).collect()
}

/// Difference of each column of [`rows`] that its digits hide: half of its smallest step where that is more.
fn tolerances(recording: &Recording) -> Vec<f64> {
    let tables = std::iter::once(&recording.q).chain(&recording.tau);
    let columns = tables.flat_map(|t| t.columns());
    let of = |c: ndarray::ArrayView1<f64>| {
        let values = sorted(c.iter().copied());
        let range = values.last().unwrap_or(&0.0) - values.first().unwrap_or(&0.0);
        let steps = values.windows(2).map(|w| w[1] - w[0]);
        let step = steps.filter(|s| *s > 0.0).fold(f64::INFINITY, f64::min);
        let half = if step.is_finite() { 0.5 * step } else { 0.0 };
        half.max(DIGITS * range)
    };
    columns.map(of).collect()
}

fn sorted(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.filter(|v| v.is_finite()).collect();
    values.sort_by(f64::total_cmp);
    values
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array2;

    fn made(rows: std::ops::Range<usize>, scale: f64) -> Recording {
        let time: Vec<f64> = rows.clone().map(|i| i as f64 * 0.01).collect();
        let q = Array2::from_shape_fn((time.len(), 2), |(i, j)| {
            scale * (time[i] * (1.0 + j as f64)).sin() + 1e-3 * (41.3 * time[i]).sin()
        });
        Recording::new("made", time, q.clone(), Some(q.mapv(|v| 3.0 * v)))
    }

    /// With so many digits behind the point, from every so many rows.
    fn written(recording: &Recording, digits: i32, every: usize) -> Recording {
        let unit = 10_f64.powi(-digits);
        let thin = |t: &Array2<f64>| {
            let rows: Vec<usize> = (0..t.nrows()).step_by(every).collect();
            t.select(ndarray::Axis(0), &rows)
                .mapv(|v| (v / unit).round() * unit)
        };
        let time = recording.time.iter().step_by(every).copied().collect();
        let tau = recording.tau.as_ref().map(thin);
        Recording::new("written", time, thin(&recording.q), tau)
    }

    #[test]
    fn the_same_rows_are_found_wherever_they_stand() {
        let fitted = [made(0..500, 1.0), made(900..1500, 1.0)];
        assert_eq!(overlap(&fitted, &made(0..500, 1.0)), 500);
        assert_eq!(overlap(&fitted, &made(400..800, 1.0)), 100);
        assert_eq!(overlap(&fitted, &made(500..900, 1.0)), 0);
        assert_eq!(overlap(&fitted, &made(0..500, 1.01)), 0);
        // A robot at rest says nothing.
        let rest = Recording::new(
            "rest",
            made(0..500, 1.0).time,
            Array2::zeros((500, 2)),
            None,
        );
        assert_eq!(overlap(std::slice::from_ref(&rest), &rest), 0);
    }

    #[test]
    fn fewer_digits_and_fewer_rows_are_the_same_recording() {
        let (whole, other) = (made(0..900, 1.0), made(1200..2100, 0.97));
        for (digits, every) in [(6, 1), (4, 1), (3, 1), (6, 5), (4, 2)] {
            let copy = written(&whole, digits, every);
            let fitted = std::slice::from_ref(&whole);
            assert_eq!(
                overlap(fitted, &copy),
                copy.len(),
                "{digits} digits, every {every}"
            );
            assert_eq!(overlap(std::slice::from_ref(&copy), &whole) > 0, every == 1);
            assert!(holds(&copy, &kept_rows(&copy)));
            assert!(every > 1 || holds(&copy, &kept_rows(&whole)));
            assert!(!holds(&other, &kept_rows(&copy)));
            assert_eq!(overlap(std::slice::from_ref(&other), &copy), 0);
        }
        // Positions alone are compared where one of both has no torque.
        let blind = Recording {
            tau: None,
            ..whole.clone()
        };
        assert_eq!(overlap(std::slice::from_ref(&whole), &blind), 900);
    }
}
