//! Folds for cross-validation: rows left out together, and rows near them that must not be fitted.
//!
//! Folds are whole groups of trajectories where there are enough of them. With fewer than [`FEWEST`] groups
//! trajectories are cut into contiguous blocks of time. Rows closer to a block than the gap are not used in the
//! fit that is tested on it: the low-pass and the residual's memory reach over a cut. Executions of one motion,
//! be they trajectories or the periods of one trajectory, are cut at the same places and left out together, so
//! that no fold is tested on a copy of fitted rows.

use crate::{Recording, repeats};
use std::ops::Range;

/// Least number of groups of trajectories that are dealt whole.
pub const FEWEST: usize = 4;
/// Part of a block that its gap may take on either side.
const WIDEST: f64 = 0.25;
/// Shortest period that counts as a repeated motion, s.
const SHORTEST_PERIOD: f64 = 1.0;
/// Largest number of positions in which a period is looked for.
const PERIOD_SAMPLES: usize = 1500;
/// Part of its deviation by which a joint's positions may differ in two periods that count as one motion.
const SAME_MOTION: f64 = 0.02;
/// Standard deviation of positions (rad or m) up to which a joint does not take part in the search for periods.
const STILL: f64 = 1e-3;

/// Rows that belong to one fold and lie near the same other folds.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Cell {
    /// Index of the fold that is tested on these rows.
    pub fold: usize,
    /// Indices of the folds whose gap these rows lie in: they are not fitted when one of these is tested.
    pub near: Vec<usize>,
}

/// Rows of some recordings dealt to folds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Folds {
    /// Number of folds to which the rows are dealt.
    pub count: usize,
    /// Cells: the units that are dealt to the folds.
    pub cells: Vec<Cell>,
    /// Rows of each recording in order, without holes: stretches with the index of their cell.
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
        folds.cut(
            recordings,
            &Motions::of_pairs(recordings, &pairs),
            most,
            gap,
        );
        folds
    }

    /// Deals motions to folds: executions of one motion together, wherever in the recordings they stand, and
    /// whole where there are enough motions. [`Self::new`] also keeps together the trajectories of one visit to
    /// the robot, and so cuts sooner.
    pub fn of_motions(recordings: &[&Recording], most: usize, gap: f64) -> Self {
        let motions = Motions::new(recordings);
        let mut folds = Self {
            count: motions.count.min(most.max(1)),
            cells: Vec::new(),
            rows: vec![Vec::new(); recordings.len()],
            whole: motions.count >= FEWEST || most < 2,
        };
        if !folds.whole {
            folds.cut(recordings, &motions, most, gap);
            return folds;
        }
        for (part, (recording, motions)) in recordings.iter().zip(&motions.of).enumerate() {
            for (trajectory, motion) in recording.trajectories.iter().zip(motions) {
                folds.put(
                    part,
                    trajectory.range.clone(),
                    motion % folds.count,
                    Vec::new(),
                );
            }
        }
        folds
    }

    /// Deals whole visits however few they are: for data that cannot be cut, such as the windows of a network.
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
    fn cut(&mut self, recordings: &[&Recording], motions: &Motions, most: usize, gap: f64) {
        let blocks = most.div_ceil(motions.count.max(1)).max(2);
        self.count = blocks * motions.count;
        for (part, recording) in recordings.iter().enumerate() {
            for (trajectory, &number) in recording.trajectories.iter().zip(&motions.of[part]) {
                let rows = trajectory.range.clone();
                let time = &recording.time[rows.clone()];
                let whole = time[time.len() - 1] - time[0];
                self.cut_one(&Execution {
                    part,
                    start: rows.start,
                    time,
                    span: period(recording, rows.clone()).unwrap_or(whole),
                    folds: number * blocks..(number + 1) * blocks,
                    gap,
                });
            }
        }
    }

    fn cut_one(&mut self, execution: &Execution) {
        let &Execution {
            part,
            start,
            time,
            span,
            gap,
            ..
        } = execution;
        let (first, blocks) = (execution.folds.start, execution.folds.len());
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

/// Motions that recordings execute, once or more often.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Motions {
    /// Number of different motions.
    pub count: usize,
    /// Index of the motion of each trajectory, by recording; motions are numbered in the order of their first execution.
    pub of: Vec<Vec<usize>>,
}

impl Motions {
    /// Finds them; a motion of one recording is another than those of the next.
    pub fn new(recordings: &[&Recording]) -> Self {
        let pairs: Vec<Vec<(usize, usize)>> = recordings.iter().map(|r| repeats::find(r)).collect();
        Self::of_pairs(recordings, &pairs)
    }

    /// Motions from pairs of trajectories, each with the next one like it.
    fn of_pairs(recordings: &[&Recording], pairs: &[Vec<(usize, usize)>]) -> Self {
        let mut count = 0;
        let mut of = Vec::with_capacity(recordings.len());
        for (recording, pairs) in recordings.iter().zip(pairs) {
            let mut own: Vec<usize> = Vec::new();
            for t in 0..recording.trajectories.len() {
                let earlier = pairs.iter().find(|&&(_, b)| b == t);
                own.push(match earlier {
                    Some(&(a, _)) => own[a],
                    None => {
                        count += 1;
                        count - 1
                    }
                });
            }
            of.push(own);
        }
        Self { count, of }
    }
}

/// One trajectory that is cut.
struct Execution<'a> {
    part: usize,
    /// First row of the trajectory.
    start: usize,
    time: &'a [f64],
    /// Length of the trajectory's motion, s: one period where it is periodic, and so less than the trajectory's.
    span: f64,
    /// Indices of the folds to which the trajectory's blocks go.
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
mod tests;
