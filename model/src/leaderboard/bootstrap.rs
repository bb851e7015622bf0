//! Bootstrap intervals of scores over the motions that might have been recorded instead.
//!
//! Percentile bootstrap over whole trajectories (B. Efron and R. J. Tibshirani, "An Introduction to the
//! Bootstrap", 1993, chapter 13): errors are correlated within a trajectory, so single samples hold far less
//! information than their number suggests. Numerator and denominator of NRMSE are drawn together.

use datasets::metrics::{MOVING, Scope, Scores, ShapeError, deviations};
use ndarray::{Array2, Axis};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::Serialize;
use std::ops::Range;

/// Number of recordings drawn per interval.
const DRAWS: usize = 1000;
/// Level of an interval: part of the draws that it holds.
const LEVEL: f64 = 0.95;
/// Seed, the same for every model, so that two intervals differ by the models alone.
const SEED: u64 = 0;
/// Fewest trajectories to draw from; with fewer, blocks are drawn.
const FEWEST: usize = 5;
/// Number of blocks into which a recording of few trajectories is cut.
const BLOCKS: usize = 20;

/// Stretches of a recording that the bootstrap draws as wholes: trajectories, or blocks of them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stretches {
    /// Ranges of samples.
    ranges: Vec<Range<usize>>,
    /// Whether they are blocks rather than trajectories.
    blocks: bool,
}

/// Description of the bootstrap intervals of a leaderboard.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Intervals {
    /// Level: part of the draws within an interval.
    pub level: f64,
    /// Name of the method: `percentile bootstrap`.
    pub method: &'static str,
    /// Drawn units: `trajectories` or `blocks`.
    pub over: &'static str,
    /// Number of the units that are drawn from.
    pub stretches: usize,
    /// Number of recordings drawn.
    pub draws: usize,
    /// Random seed of the draws.
    pub seed: u64,
}

/// Scores with their bootstrap intervals. An interval is none (null in JSON) where it does not exist.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Judged {
    /// Scores of the model.
    #[serde(flatten)]
    pub scores: Scores,
    /// Interval of each joint's NRMSE.
    pub nrmse_interval: Vec<Option<[f64; 2]>>,
    /// Interval of each joint's R², percent.
    pub r2_interval: Vec<Option<[f64; 2]>>,
    /// Interval of the mean NRMSE over joints.
    pub mean_nrmse_interval: Option<[f64; 2]>,
    /// Interval of the mean R² over joints, percent.
    pub mean_r2_interval: Option<[f64; 2]>,
}

/// Sums over one stretch, joint by joint.
#[derive(Clone)]
struct Sums {
    samples: f64,
    /// Sums Σ(y − ȳ) and Σ(y − ȳ)² of the measured values, ȳ over the whole recording.
    measured: Vec<[f64; 2]>,
    /// Number of samples and Σe² within each scope.
    errors: [Vec<[f64; 2]>; 2],
}

impl Stretches {
    /// Units that the bootstrap draws: trajectories. With fewer than five of these, consecutive blocks of about a
    /// twentieth of the recording, none of which crosses a break.
    pub fn of(trajectories: &[Range<usize>]) -> Self {
        let whole = || trajectories.iter().filter(|t| !t.is_empty());
        if whole().count() >= FEWEST {
            return Self {
                ranges: whole().cloned().collect(),
                blocks: false,
            };
        }
        let samples: usize = whole().map(|t| t.len()).sum();
        let length = samples.div_ceil(BLOCKS).max(1);
        let mut ranges = Vec::new();
        for t in whole() {
            let pieces = ((t.len() as f64 / length as f64).round() as usize).max(1);
            let end = |piece: usize| t.start + piece * t.len() / pieces;
            ranges.extend((0..pieces).map(|piece| end(piece)..end(piece + 1)));
        }
        Self {
            ranges,
            blocks: true,
        }
    }

    /// Description of the intervals for a reader.
    pub fn intervals(&self) -> Intervals {
        Intervals {
            level: LEVEL,
            method: "percentile bootstrap",
            over: if self.blocks {
                "blocks"
            } else {
                "trajectories"
            },
            stretches: self.ranges.len(),
            draws: DRAWS,
            seed: SEED,
        }
    }
}

impl Judged {
    /// Scores without intervals.
    pub fn bare(scores: Scores) -> Self {
        let joints = scores.nrmse.len();
        Self {
            scores,
            nrmse_interval: vec![None; joints],
            r2_interval: vec![None; joints],
            mean_nrmse_interval: None,
            mean_r2_interval: None,
        }
    }

    /// Scores with intervals from the scores of drawn recordings.
    fn with(scores: Scores, drawn: &[Scores]) -> Self {
        let figure = |of: &dyn Fn(&Scores) -> Option<f64>| ends(drawn.iter().filter_map(of));
        let joints = 0..scores.nrmse.len();
        // A mean over fewer joints is another figure.
        let same = |s: &&Scores| {
            let mut pairs = std::iter::zip(&s.nrmse, &scores.nrmse);
            pairs.all(|(a, b)| a.is_some() == b.is_some())
        };
        let mean = |of: fn(&Scores) -> Option<f64>| ends(drawn.iter().filter(same).filter_map(of));
        Self {
            nrmse_interval: joints.clone().map(|j| figure(&|s| s.nrmse[j])).collect(),
            r2_interval: joints.map(|j| figure(&|s| s.r2[j])).collect(),
            mean_nrmse_interval: mean(|s| s.mean_nrmse),
            mean_r2_interval: mean(|s| s.mean_r2),
            scores,
        }
    }
}

/// Scores of both scopes with intervals; tables of shape (samples, joints), `qd` in rad/s or m/s.
///
/// # Errors
/// Tables of different shapes.
pub fn judge(
    measured: &Array2<f64>,
    predicted: &Array2<f64>,
    qd: &Array2<f64>,
    stretches: &Stretches,
) -> Result<[Judged; 2], ShapeError> {
    judge_by(measured, predicted, qd, stretches, DRAWS)
}

fn judge_by(
    measured: &Array2<f64>,
    predicted: &Array2<f64>,
    qd: &Array2<f64>,
    stretches: &Stretches,
    draws: usize,
) -> Result<[Judged; 2], ShapeError> {
    let scores = |scope| Scores::of(measured.view(), predicted.view(), qd.view(), scope);
    let [all, moving] = Scope::BOTH.map(scores);
    let (all, moving) = (all?, moving?);
    let whole = deviations(measured.view(), qd.view());
    let centre = measured.mean_axis(Axis(0)).unwrap_or_default();
    let sums: Vec<Sums> = stretches
        .ranges
        .iter()
        .map(|rows| Sums::of(measured, predicted, qd, centre.as_slice(), rows.clone()))
        .collect();
    let mut drawn = [Vec::new(), Vec::new()];
    // One stretch alone is drawn every time and says nothing.
    if sums.len() > 1 {
        let mut rng = ChaCha8Rng::seed_from_u64(SEED);
        for _ in 0..draws {
            let mut total = Sums::none(measured.ncols());
            for _ in 0..sums.len() {
                total.add(&sums[rng.random_range(0..sums.len())]);
            }
            for (list, scores) in drawn.iter_mut().zip(total.scores(&whole)) {
                list.push(scores);
            }
        }
    }
    Ok([
        Judged::with(all, &drawn[0]),
        Judged::with(moving, &drawn[1]),
    ])
}

impl Sums {
    fn none(joints: usize) -> Self {
        let zeros = || vec![[0.0; 2]; joints];
        Self {
            samples: 0.0,
            measured: zeros(),
            errors: [zeros(), zeros()],
        }
    }

    fn of(
        measured: &Array2<f64>,
        predicted: &Array2<f64>,
        qd: &Array2<f64>,
        centre: Option<&[f64]>,
        rows: Range<usize>,
    ) -> Self {
        let mut sums = Self::none(measured.ncols());
        sums.samples = rows.len() as f64;
        for row in rows {
            for joint in 0..measured.ncols() {
                let y = measured[[row, joint]];
                let from_centre = y - centre.map_or(0.0, |c| c[joint]);
                sums.measured[joint][0] += from_centre;
                sums.measured[joint][1] += from_centre.powi(2);
                let square = (y - predicted[[row, joint]]).powi(2);
                let moves = qd[[row, joint]].abs() > MOVING;
                for (errors, counts) in sums.errors.iter_mut().zip([true, moves]) {
                    if counts {
                        errors[joint][0] += 1.0;
                        errors[joint][1] += square;
                    }
                }
            }
        }
        sums
    }

    fn add(&mut self, other: &Self) {
        let pair = |into: &mut Vec<[f64; 2]>, from: &Vec<[f64; 2]>| {
            for (a, b) in into.iter_mut().zip(from) {
                a[0] += b[0];
                a[1] += b[1];
            }
        };
        self.samples += other.samples;
        pair(&mut self.measured, &other.measured);
        for (a, b) in self.errors.iter_mut().zip(&other.errors) {
            pair(a, b);
        }
    }

    /// Scores of a drawn recording; `whole` are the standard deviations of the real one.
    fn scores(&self, whole: &[Option<f64>]) -> [Scores; 2] {
        let deviations: Vec<Option<f64>> = std::iter::zip(whole, &self.measured)
            .map(|(whole, [sum, squares])| {
                let mean = sum / self.samples;
                let deviation = (squares / self.samples - mean * mean).max(0.0).sqrt();
                // What is left of a constant is rounding.
                whole.and_then(|w| (deviation > 1e-9 * w).then_some(deviation))
            })
            .collect();
        [0, 1].map(|scope| {
            let rmse = self.errors[scope].iter();
            let rmse = rmse.map(|[n, squares]| (*n > 0.0).then(|| (squares / n).sqrt()));
            Scores::relative(rmse.collect(), &deviations)
        })
    }
}

/// Ends of the interval of some values; none without a value.
fn ends(values: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    let last = values.len().checked_sub(1)?;
    let at = |share: f64| {
        let place = share * last as f64;
        let below = place.floor() as usize;
        let above = (below + 1).min(last);
        values[below] + (place - below as f64) * (values[above] - values[below])
    };
    let tail = 0.5 * (1.0 - LEVEL);
    Some([at(tail), at(1.0 - tail)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_distr::{Distribution, StandardNormal};

    const ROWS: usize = 40;

    /// Torque of unit deviation in `trajectories`, each with errors of a size of its own: 0.1 or 0.3, so that the
    /// population's NRMSE is √0.05.
    fn made(trajectories: usize, seed: u64) -> ([Array2<f64>; 3], Vec<Range<usize>>) {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let n = trajectories * ROWS;
        let (mut y, mut said) = (Array2::zeros((n, 1)), Array2::zeros((n, 1)));
        for t in 0..trajectories {
            let size = if rng.random_bool(0.5) { 0.1 } else { 0.3 };
            for row in t * ROWS..(t + 1) * ROWS {
                let [a, b]: [f64; 2] = std::array::from_fn(|_| StandardNormal.sample(&mut rng));
                y[[row, 0]] = 5.0 + a;
                said[[row, 0]] = 5.0 + a + size * b;
            }
        }
        let ranges = (0..trajectories)
            .map(|t| t * ROWS..(t + 1) * ROWS)
            .collect();
        ([y, said, Array2::ones((n, 1))], ranges)
    }

    #[test]
    fn intervals_hold_what_they_claim() {
        let truth = 0.05_f64.sqrt();
        let mut held = 0;
        for seed in 0..200 {
            let ([y, said, qd], ranges) = made(40, seed);
            let stretches = Stretches::of(&ranges);
            let [all, moving] = judge_by(&y, &said, &qd, &stretches, 200).unwrap();
            let [low, high] = all.mean_nrmse_interval.unwrap();
            assert!(low < all.scores.mean_nrmse.unwrap() && high > all.scores.mean_nrmse.unwrap());
            assert_eq!(moving, all, "it moves throughout");
            held += usize::from(low <= truth && truth <= high);
        }
        // 95 % of 200 would be 190; percentile intervals of 40 trajectories are a little short.
        assert!((174..=198).contains(&held), "{held} of 200");
    }

    #[test]
    fn nrmse_and_r2_say_the_same_and_the_seed_decides() {
        let ([y, said, qd], ranges) = made(12, 3);
        let judged = || judge(&y, &said, &qd, &Stretches::of(&ranges)).unwrap();
        let [all, _] = judged();
        let ([low, high], [worst, best]) =
            (all.nrmse_interval[0].unwrap(), all.r2_interval[0].unwrap());
        // R² falls where NRMSE rises; both are interpolated between neighbours.
        assert!((100.0 * (1.0 - high * high) - worst).abs() < 0.05);
        assert!((100.0 * (1.0 - low * low) - best).abs() < 0.05);
        assert_eq!(judged()[0], all);
    }

    #[test]
    fn few_trajectories_are_cut_into_blocks() {
        let trajectories = [0..300, 300..301, 301..401];
        let stretches = Stretches::of(&trajectories);
        let intervals = stretches.intervals();
        assert_eq!(intervals.over, "blocks");
        assert!((18..=22).contains(&intervals.stretches), "{intervals:?}");
        let mut next = 0;
        for range in &stretches.ranges {
            assert_eq!(range.start, next, "every sample once");
            assert!(!range.is_empty());
            let holds = |t: &Range<usize>| t.start <= range.start && range.end <= t.end;
            assert!(trajectories.iter().any(holds), "{range:?} is over a break");
            next = range.end;
        }
        assert_eq!(next, 401);
        let many: Vec<_> = (0..5).map(|t| 10 * t..10 * (t + 1)).collect();
        assert_eq!(Stretches::of(&many).intervals().over, "trajectories");
    }

    #[test]
    fn what_has_no_figure_has_no_interval() {
        let ([y, said, _], ranges) = made(6, 1);
        let still = Array2::zeros(y.dim());
        let stretches = Stretches::of(&ranges);
        let [all, moving] = judge(&y, &said, &still, &stretches).unwrap();
        assert_eq!(
            (all.mean_nrmse_interval, moving.mean_r2_interval),
            (None, None)
        );
        let one = Stretches {
            ranges: std::iter::once(0..y.nrows()).collect(),
            blocks: true,
        };
        let moves = Array2::ones(y.dim());
        let [all, _] = judge(&y, &said, &moves, &one).unwrap();
        assert!(all.scores.mean_nrmse.is_some() && all.mean_nrmse_interval.is_none());
    }
}
