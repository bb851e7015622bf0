//! Rows that stand in two recordings.

use crate::Recording;
use crate::recording::MIN_SAMPLES;
use std::collections::HashSet;
use std::hash::{DefaultHasher, Hash, Hasher};

/// Number of rows of `other` that stand, to the bit and as part of a stretch in motion, in one of `fitted` as well.
///
/// Stretches are as long as the shortest trajectory: single rows of a robot at rest may well be the same.
pub fn overlap(fitted: &[Recording], other: &Recording) -> usize {
    let known: HashSet<u64> = fitted
        .iter()
        .flat_map(stretches)
        .map(|(_, hash)| hash)
        .collect();
    let mut shared = vec![false; other.len()];
    for (start, _) in stretches(other).filter(|(_, hash)| known.contains(hash)) {
        shared[start..start + MIN_SAMPLES].fill(true);
    }
    shared.into_iter().filter(|s| *s).count()
}

/// Stretches in which a joint moves: first row, and hash of the rows' values.
fn stretches(recording: &Recording) -> impl Iterator<Item = (usize, u64)> + '_ {
    let rows: Vec<u64> = (0..recording.len())
        .map(|row| of_row(recording, row))
        .collect();
    let starts = recording.trajectories.iter().flat_map(|t| {
        let last = (t.range.end + 1).saturating_sub(MIN_SAMPLES);
        t.range.start..last.max(t.range.start)
    });
    starts.filter_map(move |start| {
        let own = &rows[start..start + MIN_SAMPLES];
        let mut hasher = DefaultHasher::new();
        own.hash(&mut hasher);
        // All rows differ where a robot moves: values that come back are a rest, or held.
        let moves = own.windows(2).all(|w| w[0] != w[1]);
        moves.then(|| (start, hasher.finish()))
    })
}

fn of_row(recording: &Recording, row: usize) -> u64 {
    let mut hasher = DefaultHasher::new();
    let tables = std::iter::once(&recording.q).chain(&recording.tau);
    for value in tables.flat_map(|t| t.row(row).to_vec()) {
        value.to_bits().hash(&mut hasher);
    }
    hasher.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array2;

    fn made(rows: std::ops::Range<usize>, scale: f64) -> Recording {
        let time: Vec<f64> = rows.clone().map(|i| i as f64 * 0.01).collect();
        let q = Array2::from_shape_fn((time.len(), 2), |(i, j)| {
            scale * (time[i] * (1.0 + j as f64)).sin()
        });
        Recording::new("made", time, q.clone(), Some(q.mapv(|v| 3.0 * v)))
    }

    #[test]
    fn the_same_rows_are_found_wherever_they_stand() {
        let fitted = [made(0..500, 1.0), made(900..1500, 1.0)];
        assert_eq!(overlap(&fitted, &made(0..500, 1.0)), 500);
        assert_eq!(overlap(&fitted, &made(400..800, 1.0)), 100);
        assert_eq!(overlap(&fitted, &made(500..900, 1.0)), 0);
        assert_eq!(overlap(&fitted, &made(0..500, 1.01)), 0);
        // A robot at rest says nothing.
        assert_eq!(overlap(&[made(0..500, 0.0)], &made(0..500, 0.0)), 0);
    }
}
