//! Motions that a recording repeats, and the noise floor that follows.
//!
//! Two executions of one motion differ by noise, by drift and by the state in which the robot
//! arrived. RMS(τ_a − τ_b)/√2 is therefore the floor of any model that sees the motion alone; in
//! motion it is close to the noise, at standstill a model with memory can be better.

use crate::Recording;
use crate::metrics::MOVING;
use ndarray::Array2;
use serde::Serialize;
use signal::resample;

/// Two executions count as one motion when no joint's positions differ by more than this part of
/// their standard deviation (RMS over the execution).
const SAME_MOTION: f64 = 0.02;

/// Standard deviation of positions (rad or m) up to which a joint does not take part in the search for repeats.
const STILL: f64 = 1e-3;

/// Spread of repeated executions per joint, in N·m (N).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Repeatability {
    /// Pairs of trajectories, by index.
    pub pairs: Vec<(usize, usize)>,
    /// RMS(τ_a − τ_b)/√2 over all samples of all pairs.
    pub all: Vec<f64>,
    /// RMS(τ_a − τ_b)/√2 over the samples with |q̇_j| > 0.01 alone; `None` for a joint without such samples.
    pub moving: Vec<Option<f64>>,
}

/// Column of a table over some rows.
fn column(table: &Array2<f64>, rows: std::ops::Range<usize>, joint: usize) -> Vec<f64> {
    rows.map(|r| table[(r, joint)]).collect()
}

/// Values of trajectory `b` at the stamps of trajectory `a`, both counted from their starts.
/// Returns as many as lie inside both.
fn aligned(r: &Recording, table: &Array2<f64>, a: usize, b: usize, joint: usize) -> Vec<f64> {
    let (a, b) = (
        r.trajectories[a].range.clone(),
        r.trajectories[b].range.clone(),
    );
    let from_start = |rows: std::ops::Range<usize>| -> Vec<f64> {
        let start = r.time[rows.start];
        rows.map(|i| r.time[i] - start).collect()
    };
    let (ta, tb) = (from_start(a), from_start(b.clone()));
    let half_step = 0.5 * r.median_step();
    let end = tb[tb.len() - 1] + half_step;
    let at: Vec<f64> = ta.into_iter().take_while(|&t| t <= end).collect();
    resample::linear(&tb, &column(table, b, joint), &at)
}

fn deviation(x: &[f64]) -> f64 {
    let n = x.len() as f64;
    let mean = x.iter().sum::<f64>() / n;
    (x.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / n).sqrt()
}

/// Whether two trajectories follow the same path at the same times. Labels are ignored.
fn same_motion(r: &Recording, a: usize, b: usize) -> bool {
    let (ra, rb) = (&r.trajectories[a].range, &r.trajectories[b].range);
    let span = |t: &std::ops::Range<usize>| r.time[t.end - 1] - r.time[t.start];
    let (shorter, longer) = (span(ra).min(span(rb)), span(ra).max(span(rb)));
    if shorter < 0.98 * longer {
        return false;
    }
    let mut moves = false;
    for joint in 0..r.dof() {
        let qa = column(&r.q, ra.clone(), joint);
        let scale = deviation(&qa);
        // Cheap test first: most pairs fail it.
        let middle = ra.len().min(rb.len()) / 2;
        let apart = r.q[(ra.start + middle, joint)] - r.q[(rb.start + middle, joint)];
        if apart.abs() > (10.0 * SAME_MOTION * scale).max(10.0 * STILL) {
            return false;
        }
        let qb = aligned(r, &r.q, a, b, joint);
        let difference = rms(qa.iter().zip(&qb).map(|(x, y)| x - y));
        if difference > (SAME_MOTION * scale).max(STILL) {
            return false;
        }
        moves |= scale > STILL;
    }
    moves
}

fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (mut sum, mut n) = (0.0, 0_usize);
    for v in values {
        sum += v * v;
        n += 1;
    }
    (sum / n.max(1) as f64).sqrt()
}

/// Finds pairs of trajectories that repeat one motion, each trajectory with the next one like it.
///
/// Standstill alone is not a motion. Labels are not looked at.
pub fn find(recording: &Recording) -> Vec<(usize, usize)> {
    let n = recording.trajectories.len();
    (0..n)
        .filter_map(|a| {
            (a + 1..n)
                .find(|&b| same_motion(recording, a, b))
                .map(|b| (a, b))
        })
        .collect()
}

/// Spread of the torque between executions of one motion, RMS(τ_a − τ_b)/√2 of each joint: between trajectories
/// that repeat each other or between periods within them, whichever is larger. None where no motion is
/// repeated, or without torque.
pub fn spread(recording: &Recording) -> Option<Vec<f64>> {
    let pairs = find(recording);
    let still = Array2::zeros(recording.q.dim());
    let between = repeatability(recording, &still, &pairs).map(|r| r.all);
    let larger = |a: Vec<f64>, b: Vec<f64>| a.into_iter().zip(b).map(|(a, b)| a.max(b)).collect();
    between.into_iter().chain(within(recording)).reduce(larger)
}

/// Largest number of samples of a trajectory in which a period is looked for.
const LOOKED_AT: usize = 2000;
/// Shortest period, s, and least part of a trajectory that is repeated.
const SHORTEST_S: f64 = 1.0;
const REPEATED: f64 = 0.2;

/// RMS(τ(t + P) − τ(t))/√2 of each joint over trajectories that repeat a motion with a period P within themselves; none where none does,
/// or without torque.
pub fn within(recording: &Recording) -> Option<Vec<f64>> {
    let tau = recording.tau.as_ref()?;
    let mut square = vec![0.0; recording.dof()];
    let mut count = 0.0;
    for t in &recording.trajectories {
        let Some((every, lag)) = period(recording, t.range.clone()) else {
            continue;
        };
        let rows: Vec<usize> = t.range.clone().step_by(every).collect();
        for pair in 0..rows.len() - lag {
            for (j, sum) in square.iter_mut().enumerate() {
                let apart = tau[(rows[pair + lag], j)] - tau[(rows[pair], j)];
                *sum += 0.5 * apart * apart;
            }
            count += 1.0;
        }
    }
    (count > 0.0).then(|| square.into_iter().map(|s| f64::sqrt(s / count)).collect())
}

/// The shortest lag at which a trajectory repeats its motion, in rows of every `n`-th: `(n, lag)`.
fn period(r: &Recording, range: std::ops::Range<usize>) -> Option<(usize, usize)> {
    let every = range.len().div_ceil(LOOKED_AT).max(1);
    let rows: Vec<usize> = range.clone().step_by(every).collect();
    let step = (r.time[range.end - 1] - r.time[range.start]) / (range.len() - 1) as f64;
    let joints: Vec<(Vec<f64>, f64)> = (0..r.dof())
        .map(|j| {
            let own: Vec<f64> = rows.iter().map(|&row| r.q[(row, j)]).collect();
            let size = deviation(&own);
            (own, size)
        })
        .filter(|(_, size)| *size > STILL)
        .collect();
    let apart = |lag: usize| {
        let of =
            |(q, size): &(Vec<f64>, f64)| rms(q[lag..].iter().zip(q).map(|(a, b)| a - b)) / size;
        joints.iter().map(of).fold(0.0, f64::max)
    };
    let shortest = (SHORTEST_S / (step * every as f64)).ceil() as usize;
    let longest = ((1.0 - REPEATED) * rows.len() as f64) as usize;
    let lag = (shortest.max(1)..longest).find(|&lag| apart(lag) < SAME_MOTION)?;
    // The first lag below the limit is not yet the best.
    let best =
        (lag..longest.min(lag + lag / 10 + 2)).min_by(|&a, &b| apart(a).total_cmp(&apart(b)))?;
    (!joints.is_empty()).then_some((every, best))
}

/// Spread of the torque over pairs of trajectories; `qd` is the velocity at the samples, shape
/// (samples, joints).
///
/// `None` without torque or without pairs.
pub fn repeatability(
    recording: &Recording,
    qd: &Array2<f64>,
    pairs: &[(usize, usize)],
) -> Option<Repeatability> {
    let tau = recording.tau.as_ref()?;
    if pairs.is_empty() {
        return None;
    }
    let floor = |joint: usize, moving_only: bool| {
        let (mut sum, mut n) = (0.0, 0_usize);
        for &(a, b) in pairs {
            let rows = recording.trajectories[a].range.clone();
            for (row, other) in rows.zip(aligned(recording, tau, a, b, joint)) {
                if !moving_only || qd[(row, joint)].abs() > MOVING {
                    sum += (tau[(row, joint)] - other).powi(2);
                    n += 1;
                }
            }
        }
        (n > 0).then(|| (0.5 * sum / n as f64).sqrt())
    };
    let joints = 0..recording.dof();
    Some(Repeatability {
        pairs: pairs.to_vec(),
        all: joints
            .clone()
            .map(|j| floor(j, false).unwrap_or(0.0))
            .collect(),
        moving: joints.map(|j| floor(j, true)).collect(),
    })
}
