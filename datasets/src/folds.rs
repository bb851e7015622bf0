//! Folds for cross-validation: what is left out together, and what must not be fitted beside it.
//!
//! Whole groups of trajectories where there are enough of them. With fewer than [`FEWEST`] groups trajectories are cut
//! into contiguous blocks of time, and rows closer to a block than the gap are fitted by nobody who is tested on it:
//! the low-pass and the residual's memory reach over a cut. Executions of one motion, be they trajectories or the
//! periods of one trajectory, are cut at the same places and left out together, so that no fold is tested on a copy
//! of what was fitted.

use crate::{Recording, repeats};
use std::ops::Range;

/// Fewest groups of trajectories that are dealt whole.
pub const FEWEST: usize = 4;
/// Part of a block that its gap may take on either side.
const WIDEST: f64 = 0.25;
/// Shortest period that counts as a repeated motion, s.
const SHORTEST_PERIOD: f64 = 1.0;
/// Positions looked at for a period, at most.
const PERIOD_SAMPLES: usize = 1500;
/// Two periods count as one motion when no joint's positions differ by more than this part of their deviation.
const SAME_MOTION: f64 = 0.02;
/// A joint that stays within this (standard deviation, rad or m) does not take part.
const STILL: f64 = 1e-3;

/// Rows with one fold and the same neighbours.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Cell {
    /// The fold that is tested on these rows.
    pub fold: usize,
    /// Folds whose gap these rows lie in: they are not fitted when one of these is tested.
    pub near: Vec<usize>,
}

/// Rows of some recordings dealt to folds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Folds {
    /// Number of folds.
    pub count: usize,
    /// What rows are told apart by.
    pub cells: Vec<Cell>,
    /// For each recording its rows in order, without holes: stretches with the index of their cell.
    pub rows: Vec<Vec<(Range<usize>, usize)>>,
    /// Whether no trajectory is cut.
    pub whole: bool,
}

impl Folds {
    /// Deals recordings to at most `most` folds; rows closer than `gap` (s) to a block cut out of a trajectory are not
    /// fitted when that block is tested.
    pub fn new(recordings: &[&Recording], most: usize, gap: f64) -> Self {
        let pairs: Vec<Vec<(usize, usize)>> = recordings.iter().map(|r| repeats::find(r)).collect();
        let visits = visits(recordings, &pairs);
        if visits.len() >= FEWEST || most < 2 {
            return Self::whole(recordings, visits, most);
        }
        let mut folds = Self {
            count: 0,
            cells: Vec::new(),
            rows: vec![Vec::new(); recordings.len()],
            whole: false,
        };
        folds.cut(recordings, &pairs, most, gap);
        folds
    }

    /// Deals whole visits however few they are: for what cannot be cut, such as the windows of a network.
    pub fn of_visits(recordings: &[&Recording], most: usize) -> Self {
        let pairs: Vec<Vec<(usize, usize)>> = recordings.iter().map(|r| repeats::find(r)).collect();
        Self::whole(recordings, visits(recordings, &pairs), most)
    }

    fn whole(recordings: &[&Recording], visits: Vec<(usize, Range<usize>)>, most: usize) -> Self {
        let mut folds = Self {
            count: visits.len().min(most.max(1)),
            cells: Vec::new(),
            rows: vec![Vec::new(); recordings.len()],
            whole: true,
        };
        // Round robin spreads slow changes (warm-up) over all folds.
        for (k, (part, group)) in visits.into_iter().enumerate() {
            let fold = k % folds.count;
            for trajectory in &recordings[part].trajectories[group] {
                folds.put(part, trajectory.range.clone(), fold, Vec::new());
            }
        }
        folds
    }

    /// Cells that are fitted when `fold` is tested.
    pub fn fitted(&self, fold: usize) -> impl Iterator<Item = usize> + '_ {
        let fits = move |c: &&(usize, &Cell)| c.1.fold != fold && !c.1.near.contains(&fold);
        let cells = self.cells.iter().enumerate();
        cells.filter(move |c| fits(&c)).map(|(k, _)| k)
    }

    /// Cells that `fold` is tested on.
    pub fn tested(&self, fold: usize) -> impl Iterator<Item = usize> + '_ {
        let cells = self.cells.iter().enumerate();
        cells.filter(move |(_, c)| c.fold == fold).map(|(k, _)| k)
    }

    /// Fold of each trajectory of each recording; zero throughout where trajectories were cut.
    pub fn of_trajectories(&self, recordings: &[&Recording]) -> Vec<Vec<usize>> {
        let fold_at = |part: usize, row: usize| {
            let mut stretches = self.rows[part].iter();
            stretches
                .find(|(rows, _)| rows.contains(&row))
                .map_or(0, |&(_, cell)| self.cells[cell].fold)
        };
        let of = |(part, r): (usize, &&Recording)| {
            let fold = |t: &crate::Trajectory| {
                if self.whole {
                    fold_at(part, t.range.start)
                } else {
                    0
                }
            };
            r.trajectories.iter().map(fold).collect()
        };
        recordings.iter().enumerate().map(of).collect()
    }

    fn put(&mut self, part: usize, rows: Range<usize>, fold: usize, near: Vec<usize>) {
        if rows.is_empty() {
            return;
        }
        let cell = Cell { fold, near };
        let known = self.cells.iter().position(|c| *c == cell);
        let index = known.unwrap_or_else(|| {
            self.cells.push(cell);
            self.cells.len() - 1
        });
        self.rows[part].push((rows, index));
    }

    /// Cuts every motion into blocks of time, one fold each.
    fn cut(
        &mut self,
        recordings: &[&Recording],
        pairs: &[Vec<(usize, usize)>],
        most: usize,
        gap: f64,
    ) {
        // Trajectories of one motion share a class.
        let mut classes = 0;
        let mut class: Vec<Vec<usize>> = Vec::new();
        for (recording, pairs) in recordings.iter().zip(pairs) {
            let mut mine: Vec<usize> = Vec::new();
            for t in 0..recording.trajectories.len() {
                let earlier = pairs.iter().find(|&&(_, b)| b == t);
                mine.push(match earlier {
                    Some(&(a, _)) => mine[a],
                    None => {
                        classes += 1;
                        classes - 1
                    }
                });
            }
            class.push(mine);
        }
        let blocks = most.div_ceil(classes.max(1)).max(2);
        self.count = blocks * classes;
        for (part, recording) in recordings.iter().enumerate() {
            for (trajectory, &class) in recording.trajectories.iter().zip(&class[part]) {
                let rows = trajectory.range.clone();
                let time = &recording.time[rows.clone()];
                let whole = time[time.len() - 1] - time[0];
                self.cut_one(&Motion {
                    part,
                    start: rows.start,
                    time,
                    span: period(recording, rows.clone()).unwrap_or(whole),
                    folds: class * blocks..(class + 1) * blocks,
                    gap,
                });
            }
        }
    }

    fn cut_one(&mut self, motion: &Motion) {
        let &Motion {
            part,
            start,
            time,
            span,
            gap,
            ..
        } = motion;
        let (first, blocks) = (motion.folds.start, motion.folds.len());
        let length = span / blocks as f64;
        let gap = gap.min(WIDEST * length);
        // Block of the motion at a time, counted on through all periods.
        let block = |t: f64| ((t - time[0]) / length * (1.0 + 1e-12)).floor() as usize;
        let last = block(time[time.len() - 1]);
        let fold = |b: usize| first + b % blocks;
        let periodic = span < 0.75 * (time[time.len() - 1] - time[0]);
        let end = if periodic { last } else { last.min(blocks - 1) };
        for b in 0..=end {
            let at = |t: f64| start + time.partition_point(|&s| s < t);
            let (from, to) = (
                time[0] + b as f64 * length,
                time[0] + (b + 1) as f64 * length,
            );
            let until = if b == end { start + time.len() } else { at(to) };
            let before = (b > 0).then(|| fold(b - 1));
            let after = (b < end).then(|| fold(b + 1));
            let head = if before.is_some() {
                at(from + gap)
            } else {
                at(from)
            };
            let tail = if after.is_some() { at(to - gap) } else { until };
            self.put(part, at(from)..head, fold(b), before.into_iter().collect());
            self.put(part, head..tail, fold(b), Vec::new());
            self.put(part, tail..until, fold(b), after.into_iter().collect());
        }
    }
}

/// One trajectory that is cut.
struct Motion<'a> {
    part: usize,
    /// Its first row.
    start: usize,
    time: &'a [f64],
    /// Length of its motion in s: less than that of the trajectory where it is periodic.
    span: f64,
    /// Folds of the blocks.
    folds: Range<usize>,
    gap: f64,
}

/// Groups of trajectories that belong together, by recording.
fn visits(recordings: &[&Recording], pairs: &[Vec<(usize, usize)>]) -> Vec<(usize, Range<usize>)> {
    let all = recordings.iter().zip(pairs).enumerate();
    all.flat_map(|(part, (recording, pairs))| {
        let groups = groups(recording.trajectories.len(), pairs);
        groups.into_iter().map(move |g| (part, g))
    })
    .collect()
}

/// Groups of trajectory indices that belong together, in order.
///
/// `repeats` are pairs of trajectories that execute the same motion. Repeats are joined, and so are
/// groups whose index ranges interleave (A B C A B C is one visit to the robot), so that no fold
/// contains a copy of what another is tested on.
fn groups(trajectories: usize, repeats: &[(usize, usize)]) -> Vec<Range<usize>> {
    // Only the largest reach of each index matters: a sweep merges overlapping index ranges.
    let mut reach: Vec<usize> = (0..trajectories).collect();
    for &(a, b) in repeats {
        let (low, high) = (a.min(b), a.max(b));
        reach[low] = reach[low].max(high);
    }
    let mut groups = Vec::new();
    let mut start = 0;
    let mut end = 0;
    for (index, &to) in reach.iter().enumerate() {
        if index > end {
            groups.push(start..end + 1);
            start = index;
        }
        end = end.max(to).max(index);
    }
    if trajectories > 0 {
        groups.push(start..end + 1);
    }
    groups
}

/// Period in s of the motion of one trajectory, where it is executed twice or more.
fn period(recording: &Recording, rows: Range<usize>) -> Option<f64> {
    let stride = rows.len().div_ceil(PERIOD_SAMPLES).max(1);
    let picked: Vec<usize> = rows.clone().step_by(stride).collect();
    let n = picked.len();
    let step = (recording.time[picked[n - 1]] - recording.time[picked[0]]) / (n.max(2) - 1) as f64;
    let joints: Vec<(Vec<f64>, f64)> = (0..recording.dof())
        .filter_map(|j| {
            let q: Vec<f64> = picked.iter().map(|&r| recording.q[(r, j)]).collect();
            let mean = q.iter().sum::<f64>() / n as f64;
            let deviation = (q.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n as f64).sqrt();
            (deviation > STILL).then_some((q, deviation))
        })
        .collect();
    if joints.is_empty() {
        return None;
    }
    let apart = |lag: usize| {
        let worst = joints.iter().map(|(q, deviation)| {
            let squares: f64 = q.iter().zip(&q[lag..]).map(|(a, b)| (a - b).powi(2)).sum();
            (squares / (n - lag) as f64).sqrt() / deviation
        });
        worst.fold(0.0, f64::max)
    };
    let shortest = ((SHORTEST_PERIOD / step).ceil() as usize).max(2);
    // The first lag at which the motion has come back, after it has been away.
    let mut away = false;
    let mut best: Option<(f64, usize)> = None;
    for lag in shortest..=n / 2 {
        let a = apart(lag);
        // Between two samples of the thinned positions the motion goes on.
        away |= a > 10.0 * SAME_MOTION;
        match best {
            _ if !away => {}
            Some((least, _)) if a > 2.0 * least.max(SAME_MOTION) => break,
            Some((least, _)) if a >= least => {}
            _ if a < SAME_MOTION => best = Some((a, lag)),
            _ => {}
        }
    }
    best.map(|(_, lag)| lag as f64 * step)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Trajectory;
    use ndarray::Array2;
    use proptest::prelude::*;

    /// Trajectories at 50 Hz, each of so many seconds, position by trajectory and time.
    fn recording(lengths: &[f64], q: impl Fn(usize, f64) -> f64) -> Recording {
        let (mut time, mut values, mut trajectories) = (Vec::new(), Vec::new(), Vec::new());
        for (k, &length) in lengths.iter().enumerate() {
            let start = time.len();
            for i in 0..=(length * 50.0) as usize {
                let t = i as f64 / 50.0;
                time.push(100.0 * k as f64 + t);
                values.push(q(k, t));
            }
            trajectories.push(Trajectory {
                label: k.to_string(),
                range: start..time.len(),
            });
        }
        let q = Array2::from_shape_vec((values.len(), 1), values).unwrap();
        Recording {
            trajectories,
            ..Recording::new("test", time, q, None)
        }
    }

    fn fold_of(folds: &Folds, row: usize) -> &Cell {
        let stretch = folds.rows[0].iter().find(|(r, _)| r.contains(&row));
        &folds.cells[stretch.unwrap().1]
    }

    #[test]
    fn two_visits_of_three_repeated_motions() {
        let repeats = [(0, 3), (1, 4), (2, 5), (6, 9), (7, 10), (8, 11)];
        assert_eq!(groups(12, &repeats), vec![0..6, 6..12]);
        assert_eq!(groups(3, &[]), vec![0..1, 1..2, 2..3]);
    }

    #[test]
    fn many_trajectories_are_never_cut() {
        let r = recording(&[4.0; 8], |k, t| (t * (1.0 + 0.3 * k as f64)).sin());
        let folds = Folds::new(&[&r], 6, 0.5);
        assert!(folds.whole && folds.count == 6);
        assert_eq!(folds.of_trajectories(&[&r])[0], [0, 1, 2, 3, 4, 5, 0, 1]);
        assert!(folds.cells.iter().all(|c| c.near.is_empty()));
    }

    #[test]
    fn one_trajectory_is_cut_in_blocks_with_a_gap() {
        // Not periodic: a chirp.
        let r = recording(&[24.0], |_, t| (t + 0.05 * t * t).sin());
        let folds = Folds::new(&[&r], 6, 0.5);
        assert!(!folds.whole && folds.count == 6);
        // Blocks of 4 s; 3.8 s is block 0 and within half a second of block 1.
        assert_eq!(
            *fold_of(&folds, 100),
            Cell {
                fold: 0,
                near: vec![]
            }
        );
        assert_eq!(
            *fold_of(&folds, 190),
            Cell {
                fold: 0,
                near: vec![1]
            }
        );
        assert_eq!(
            *fold_of(&folds, 210),
            Cell {
                fold: 1,
                near: vec![0]
            }
        );
        // No row within the gap of what is tested is fitted.
        for fold in 0..6 {
            let fitted: Vec<usize> = folds.fitted(fold).collect();
            for (rows, cell) in &folds.rows[0] {
                if !fitted.contains(cell) {
                    continue;
                }
                let block = r.time[0] + 4.0 * fold as f64;
                for row in rows.clone() {
                    let t = r.time[row];
                    assert!(
                        t <= block - 0.5 + 1e-9 || t >= block + 4.5 - 1e-9,
                        "{t} {fold}"
                    );
                }
            }
        }
    }

    #[test]
    fn periods_of_one_motion_are_cut_at_the_same_phases() {
        let tau = std::f64::consts::TAU;
        // Five periods of 6 s: the same phase is in the same fold in each.
        let r = recording(&[30.0], |_, t| {
            (t / 6.0 * tau).sin() + 0.4 * (t / 2.0 * tau).cos()
        });
        assert!((period(&r, 0..r.len()).unwrap() - 6.0).abs() < 0.05);
        let folds = Folds::new(&[&r], 6, 0.5);
        for row in 0..r.len() - 300 {
            // Away from the cuts, which a thinned period places to a few samples.
            if !(5..45).contains(&(row % 50)) {
                continue;
            }
            assert_eq!(
                fold_of(&folds, row).fold,
                fold_of(&folds, row + 300).fold,
                "{row}"
            );
        }
    }

    #[test]
    fn two_executions_of_one_motion_are_cut_alike() {
        let r = recording(&[12.0, 12.0], |_, t| (t + 0.05 * t * t).sin());
        let folds = Folds::new(&[&r], 6, 0.5);
        assert!(!folds.whole && folds.count == 6);
        for row in 0..600 {
            assert_eq!(fold_of(&folds, row), fold_of(&folds, row + 601), "{row}");
        }
    }

    proptest! {
        #[test]
        fn every_row_has_one_fold(
            lengths in prop::collection::vec(2.0_f64..9.0, 1..7),
            most in 1usize..8,
            gap in 0.0_f64..2.0,
        ) {
            let r = recording(&lengths, |k, t| (t * (1.0 + 0.3 * k as f64) + 0.1 * t * t).sin());
            let folds = Folds::new(&[&r], most, gap);
            let mut next = 0;
            for (rows, cell) in &folds.rows[0] {
                prop_assert_eq!(rows.start, next);
                prop_assert!(folds.cells[*cell].fold < folds.count);
                next = rows.end;
            }
            prop_assert_eq!(next, r.len());
            for fold in 0..folds.count {
                prop_assert!(folds.fitted(fold).all(|c| folds.cells[c].fold != fold));
            }
        }

        #[test]
        fn repeats_share_a_group(n in 1usize..30, pairs in prop::collection::vec((0usize..30, 0usize..30), 0..20)) {
            let pairs: Vec<_> = pairs.into_iter().filter(|&(a, b)| a < n && b < n).collect();
            let groups = groups(n, &pairs);
            for (a, b) in pairs {
                prop_assert!(groups.iter().any(|g| g.contains(&a) && g.contains(&b)));
            }
        }
    }
}
