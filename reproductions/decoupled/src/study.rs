//! The paper's identification on its simulated axes, many times over.

use crate::DecoupledError;
use crate::comau::{axes, columns};
use crate::estimators::{ALL, Estimate};
use crate::friction;
use crate::gravity::Gravity;
use crate::joint::{Columns, Joint};
use crate::reference::{Fourier, Reference, Shuttle};
use crate::repeats::Repeats;
use crate::simulation::{Setup, simulate};
use identify::least_squares::{Accumulator, LeastSquaresError, SubRegressors};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use serde::Serialize;

/// f₀ and harmonics of the paper's excitation.
pub const FUNDAMENTAL_HZ: f64 = 0.1;
/// Number of harmonics.
pub const HARMONICS: usize = 5;
/// Recorded time of a periodic run, s: two periods.
pub const SECONDS: f64 = 20.0;
/// Largest position, speed and acceleration of the excitation, rad, rad/s, rad/s².
const LIMITS: [f64; 3] = [1.2, 1.5, 4.0];
/// Series that are drawn for one that is taken.
const CANDIDATES: usize = 300;

/// What the joint does in the runs for gravity: there and back at 0.3 rad/s.
pub const SLOPES: Shuttle = Shuttle {
    start: -1.0,
    speed: 0.3,
    acceleration: 2.0,
    cruise: 6.0,
};
/// And in the runs for friction: bang-bang acceleration.
pub const BANG_BANG: Shuttle = Shuttle {
    start: -0.5,
    speed: 1.2,
    acceleration: 1.5,
    cruise: 0.0,
};
/// Ways there and back of each.
pub const WAYS: [f64; 2] = [2.0, 10.0];

/// One axis.
#[derive(Debug, Clone, Serialize)]
pub struct AxisStudy {
    /// Number, from 1.
    pub axis: usize,
    /// Names and units of the parameters.
    pub names: Vec<(&'static str, &'static str)>,
    /// True parameters.
    pub truth: Vec<f64>,
    /// Condition number of the excitation's columns, scaled.
    pub condition: f64,
    /// Mean correlation coefficient of the projection.
    pub correlation: f64,
    /// Estimator by estimator.
    pub estimators: Vec<EstimatorStudy>,
    /// mx and my from runs at constant speed; none for the upright axis.
    pub gravity: Option<[Repeats; 2]>,
    /// Γ and friction from bang-bang runs.
    pub friction: Vec<Repeats>,
}

/// One estimator on one axis, parameter by parameter.
#[derive(Debug, Clone, Serialize)]
pub struct EstimatorStudy {
    /// Its name.
    pub name: &'static str,
    /// Over the draws.
    pub repeats: Vec<Repeats>,
    /// Mean of the deviations that it states.
    pub stated: Vec<f64>,
    /// Distance of its mean from the truth in standard errors of one estimate: deviations over the draws.
    pub bias: Vec<f64>,
}

impl EstimatorStudy {
    /// Its largest bias, in standard errors.
    pub fn worst(&self) -> f64 {
        self.bias.iter().fold(0.0, |m, b| m.max(b.abs()))
    }
}

/// The series with the smallest condition number (equation 20) among random ones within the limits.
///
/// # Errors
/// A decomposition that fails.
pub fn excitation(columns: Columns, seed: u64) -> Result<(Fourier, f64), LeastSquaresError> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut best: Option<(Fourier, f64)> = None;
    let mut row = Vec::new();
    for _ in 0..CANDIDATES {
        let draw = |rng: &mut ChaCha8Rng| rng.random_range(-1.0..1.0);
        let mut series = Fourier {
            fundamental_hz: FUNDAMENTAL_HZ,
            centre: 0.0,
            waves: (0..HARMONICS)
                .map(|_| [draw(&mut rng), draw(&mut rng)])
                .collect(),
        };
        let states = |series: &Fourier| {
            let each = 1.0 / FUNDAMENTAL_HZ / 400.0;
            (0..400)
                .map(|k| series.at(each * f64::from(k)))
                .collect::<Vec<_>>()
        };
        let shrink = states(&series).iter().fold(f64::INFINITY, |m, s| {
            let room = s.iter().zip(LIMITS).map(|(s, limit)| limit / s.abs());
            room.fold(m, f64::min)
        });
        for wave in series.waves.iter_mut().flatten() {
            *wave *= shrink;
        }
        let mut rows = Accumulator::new(columns.len());
        for [q, v, a] in states(&series) {
            columns.row(q, v, a, v > 0.0, &mut row);
            rows.push(&row, 0.0, 1.0)?;
        }
        let condition = SubRegressors::scaled(&rows.finish()?)?;
        if best.as_ref().is_none_or(|b| condition < b.1) {
            best = Some((series, condition));
        }
    }
    best.ok_or(LeastSquaresError::NoRows)
}

/// All axes, `draws` times each with noise of their own. The same seed gives the same figures on any number of threads.
///
/// # Errors
/// A run that cannot be identified.
pub fn study(draws: usize, setup: &Setup, seed: u64) -> Result<Vec<AxisStudy>, DecoupledError> {
    axes()
        .iter()
        .enumerate()
        .map(|(i, joint)| axis(i + 1, joint, draws, setup, seed))
        .collect()
}

/// One draw: estimates of every estimator, gravity, friction.
type Draw = (Vec<Estimate>, Option<Gravity>, Estimate);

fn axis(
    number: usize,
    joint: &Joint,
    draws: usize,
    setup: &Setup,
    seed: u64,
) -> Result<AxisStudy, DecoupledError> {
    let columns = columns(joint);
    let (series, condition) = excitation(columns, seed ^ number as u64)?;
    let reference = Reference::Periodic(series);
    let made: Vec<Draw> = (0..draws)
        .into_par_iter()
        .map(|draw| {
            let seed = stream(seed, number, draw);
            let run = simulate(joint, &reference, SECONDS, setup, None, seed).run;
            let all = ALL.iter().map(|e| e.estimate(&run, columns, &|_| 0.0));
            let estimates = all.collect::<Result<Vec<_>, _>>()?;
            let shuttle = |motion: Shuttle, ways: f64, seed: u64| {
                let seconds = ways * motion.period();
                simulate(
                    joint,
                    &Reference::Shuttle(motion),
                    seconds,
                    setup,
                    None,
                    seed,
                )
                .run
            };
            let gravity = columns
                .gravity
                .then(|| Gravity::of(&shuttle(SLOPES, WAYS[0], seed ^ 1)))
                .transpose()?;
            let friction = friction::of(&shuttle(BANG_BANG, WAYS[1], seed ^ 2), gravity.as_ref())?;
            Ok((estimates, gravity, friction))
        })
        .collect::<Result<_, DecoupledError>>()?;
    let truth = joint.parameters();
    let over = |value: &dyn Fn(&Draw) -> f64| {
        let values: Vec<f64> = made.iter().map(value).collect();
        Repeats::of(&values)
    };
    let estimators = ALL.iter().enumerate().map(|(e, estimator)| {
        let of = |j: usize| over(&|d| d.0[e].parameters[j]);
        let repeats: Vec<Repeats> = (0..truth.len()).map(of).collect();
        EstimatorStudy {
            name: estimator.name(),
            stated: (0..truth.len())
                .map(|j| over(&|d| d.0[e].std[j]).mean)
                .collect(),
            bias: (repeats.iter().zip(&truth))
                .map(|(r, t)| (r.mean - t) / r.std)
                .collect(),
            repeats,
        }
    });
    let moment = |k: usize| over(&|d| d.1.as_ref().map_or(0.0, |g| g.moments[k]));
    Ok(AxisStudy {
        axis: number,
        names: columns.names(),
        condition,
        correlation: over(&|d| d.0.iter().find_map(|e| e.correlation).unwrap_or(0.0)).mean,
        estimators: estimators.collect(),
        gravity: columns.gravity.then(|| [moment(0), moment(1)]),
        friction: (0..5).map(|j| over(&|d| d.2.parameters[j])).collect(),
        truth,
    })
}

/// A seed of its own for every draw of every axis.
fn stream(seed: u64, axis: usize, draw: usize) -> u64 {
    let index = (axis as u64) << 32 | draw as u64;
    seed.wrapping_mul(0x9e37_79b9_7f4a_7c15)
        .wrapping_add(index << 2)
}
