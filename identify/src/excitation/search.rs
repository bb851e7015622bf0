//! Search for a periodic motion of least cost: random starts, then coordinate steps of adaptive size.

use super::error::ExcitationError;
use super::room::Room;
use super::series::Series;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

/// Settings of [`optimise`].
#[derive(Debug, Clone, PartialEq)]
pub struct SearchOptions {
    /// Number of random starts, of which the best is improved. Default 40.
    pub starts: usize,
    /// Largest number of trajectories judged, the starts among them. Default 4000.
    pub evaluations: usize,
    /// Seed of starts and order.
    pub seed: u64,
}

impl Default for SearchOptions {
    fn default() -> Self {
        Self {
            starts: 40,
            evaluations: 4000,
            seed: 1,
        }
    }
}

/// Result of a search for a motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// The best trajectory; it keeps all limits at all times.
    pub trajectory: Series,
    /// Cost of the trajectory by the search's criterion.
    pub cost: f64,
    /// Cost at the beginning of the search: of the best random start, or of the first draw.
    pub start_cost: f64,
    /// Number of trajectories judged.
    pub evaluations: usize,
}

/// First step of every coefficient, in half ranges of its joint.
const STEP: f64 = 0.25;
/// Step below which a coefficient is not improved further, and the factors by which a step grows and shrinks.
const LEAST_STEP: f64 = 1e-4;
const GROWTH: f64 = 1.6;
const DECAY: f64 = 0.5;

/// Finds the trajectory of least `cost` in a room. The best of the random starts is improved one coefficient at
/// a time, both directions judged at once, and after each round along the change of the whole round (Hooke and
/// Jeeves, J. ACM 8(2), 1961).
///
/// The same seed gives the same trajectory, whatever the number of threads.
///
/// # Errors
/// No starts, errors of `cost`, or a cost that is infinite everywhere.
pub fn optimise(
    room: &Room,
    options: &SearchOptions,
    cost: impl Fn(&Series) -> Result<f64, ExcitationError> + Sync,
) -> Result<Found, ExcitationError> {
    if options.starts == 0 {
        return Err(ExcitationError::Empty("the number of starts"));
    }
    let mut rng = ChaCha8Rng::seed_from_u64(options.seed);
    let starts: Vec<Series> = (0..options.starts)
        .map(|_| filling(room, &mut rng, 1.0))
        .collect();
    let costs: Vec<f64> = starts.par_iter().map(&cost).collect::<Result<_, _>>()?;
    let least = (0..costs.len()).min_by(|&a, &b| costs[a].total_cmp(&costs[b]));
    let best = least.expect("there is a start");
    let mut found = Found {
        trajectory: starts[best].clone(),
        cost: costs[best],
        start_cost: costs[best],
        evaluations: starts.len(),
    };
    let (n, h) = (room.dof(), room.harmonics.len());
    // Where home is given the offset follows from the cosines.
    let each = 2 * h + usize::from(room.bounds.home.is_none());
    let mut steps = vec![STEP; n * each];
    while found.evaluations < options.evaluations && steps.iter().any(|s| *s > LEAST_STEP) {
        let before = found.trajectory.clone();
        let mut order: Vec<usize> = (0..steps.len())
            .filter(|&c| steps[c] > LEAST_STEP)
            .collect();
        shuffle(&mut order, &mut rng);
        for c in order {
            if found.evaluations >= options.evaluations {
                break;
            }
            let stepped = |direction: f64| {
                let mut trial = found.trajectory.clone();
                let joint = c / each;
                *coefficient(&mut trial, joint, c % each, h) +=
                    direction * steps[c] * room.limits()[joint].half();
                room.keep(&mut trial);
                let value = cost(&trial)?;
                Ok::<_, ExcitationError>((value, trial))
            };
            let (up, down) = rayon::join(|| stepped(1.0), || stepped(-1.0));
            let (up, down) = (up?, down?);
            found.evaluations += 2;
            let better = if down.0 < up.0 { down } else { up };
            if better.0 < found.cost {
                (found.cost, found.trajectory) = better;
                steps[c] *= GROWTH;
            } else {
                steps[c] *= DECAY;
            }
        }
        let mut further = found.trajectory.clone();
        further.sine = 2.0 * &further.sine - &before.sine;
        further.cosine = 2.0 * &further.cosine - &before.cosine;
        for (x, b) in further.offset.iter_mut().zip(&before.offset) {
            *x = 2.0 * *x - b;
        }
        room.keep(&mut further);
        let value = cost(&further)?;
        found.evaluations += 1;
        if value < found.cost {
            (found.cost, found.trajectory) = (value, further);
        }
    }
    if found.cost.is_finite() {
        Ok(found)
    } else {
        Err(ExcitationError::NothingFound)
    }
}

/// The `place`-th free number of a joint.
fn coefficient(series: &mut Series, joint: usize, place: usize, harmonics: usize) -> &mut f64 {
    match place {
        p if p < harmonics => &mut series.sine[(joint, p)],
        p if p < 2 * harmonics => &mut series.cosine[(joint, p - harmonics)],
        _ => &mut series.offset[joint],
    }
}

/// Random coefficients whose motion fills at least a share of the first limit that each joint meets. As
/// coefficients of the velocity they have one distribution, so that amplitudes fall with the frequency (KR300
/// benchmark, eq. 1; COMAU paper, eq. 17).
pub(super) fn filling(room: &Room, rng: &mut ChaCha8Rng, share: f64) -> Series {
    /// Factor that takes a motion beyond any room, so that every joint meets a limit.
    const TOO_MUCH: f64 = 100.0;
    let mut series = room.still();
    for (j, limit) in room.limits().iter().enumerate() {
        for (i, &h) in room.harmonics.iter().enumerate() {
            let size = limit.half() / h as f64;
            series.sine[(j, i)] = TOO_MUCH * size * rng.random_range(-1.0..1.0);
            series.cosine[(j, i)] = TOO_MUCH * size * rng.random_range(-1.0..1.0);
        }
        series.offset[j] = rng.random_range(limit.lower..limit.upper);
    }
    room.keep(&mut series);
    if share < 1.0 {
        let filled: Vec<f64> = (0..room.dof())
            .map(|_| rng.random_range(share..1.0))
            .collect();
        for (j, f) in filled.into_iter().enumerate() {
            series.sine.row_mut(j).mapv_inplace(|x| x * f);
            series.cosine.row_mut(j).mapv_inplace(|x| x * f);
        }
        room.keep(&mut series);
    }
    series
}

/// Random permutation of `order` (Fisher and Yates).
fn shuffle(order: &mut [usize], rng: &mut ChaCha8Rng) {
    for i in (1..order.len()).rev() {
        order.swap(i, rng.random_range(0..=i));
    }
}
