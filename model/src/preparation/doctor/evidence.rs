//! Evidence on each joint's torque: its numbers, its channel, and a fit of rigid body and friction.

use super::blocks::{Blocks, Estimate};
use super::number::Numbers;
use crate::preparation::channel::systems::{Joint, Systems};
use datasets::Recording;
use datasets::channel::{ChannelEstimate, JointChannel};
use datasets::prepare::Prepared;
use nalgebra::Vector3;
use physics::robot::{PARAMETERS_PER_LINK, Robot};
use rayon::prelude::*;
use signal::delay::{Search, rows_at};

/// Part of the samples below zero above which a torque counts as having a sign.
pub(super) const FEW: f64 = 0.002;
/// Number of columns of a joint's friction beside the offset: viscous, Coulomb, two bends.
const FRICTION: usize = 4;
/// Number of standard deviations by which gravity's coefficient must differ from zero to count as certain.
const SHOWS: f64 = 3.0;
/// Part of the described torque below which its gravity or inertia counts as rounding.
const ROUNDING: f64 = 1e-9;
/// Common error of a described centre of mass, m.
const MISPLACED: f64 = 0.01;

/// Evidence on one joint's torque.
pub(super) struct Evidence {
    /// Statistics of the recorded numbers, without a model.
    pub numbers: Numbers,
    /// Estimated delay, scale, offset and sign of the torque channel.
    pub channel: JointChannel,
    /// Fit of the model to the torque; none for a joint that never moves or whose torque keeps one value.
    pub fitted: Option<Fitted>,
}

/// Fit of a rigid body with friction to one joint's torque alone, on low-passed rows.
pub(super) struct Fitted {
    /// Part of the torque's variance that the fit explains.
    pub explained: f64,
    /// Squared error of the fit over that of a fit without gravity. It is near 1 where gravity does not show.
    pub gravity: f64,
    /// Part of the standard deviation of the described torque that comes from gravity.
    pub loaded: f64,
    /// Ratio of recorded to described torque, with friction fitted beside it. Rotor inertia, which is not described,
    /// raises it.
    pub scale: Estimate,
    /// Ratio of recorded to described inertia, divided by the same ratio of gravity. Rotor inertia counts as inertia,
    /// and friction is free. None where gravity does not show.
    pub inertia: Option<Estimate>,
    /// Mean power of friction over the product of the standard deviations of torque and velocity. It is positive where
    /// friction takes energy.
    pub friction: Estimate,
    /// Standard deviation of the described torque, N·m (N).
    pub described: f64,
    /// Part of `described` that small errors of the described centres of mass would make. From 1 on, the described
    /// torque is no measure of scale or sign.
    pub doubt: f64,
    /// Squared error of a fit to |torque| with the model's sign put before it, over that of a fit to the torque itself.
    pub folded: f64,
    /// Level at which the largest torques may be cut off.
    pub limit: Limit,
}

/// Level at which the largest torques of a joint may be cut off, with the signs of that.
pub(super) struct Limit {
    /// Level of the largest torques, in the recorded unit.
    pub level: f64,
    /// Part of the rows whose torque is at the level.
    pub share: f64,
    /// Part of the rows at which the torque stays at the level while a model of the smaller torques exceeds it.
    pub beyond: f64,
    /// Number of separate runs of such rows.
    pub visits: usize,
    /// Number of rows at the level, over that in an equally wide band a tenth below it.
    pub crowd: f64,
    /// Part of the rows at the level that the model of the smaller torques puts there as well. The motion itself makes
    /// such a level, as with a weight held far out.
    pub made: f64,
}

/// Evidence of all joints; none without torque.
pub(super) fn gather(
    robot: &Robot,
    recording: &Recording,
    prepared: &Prepared,
    channel: &ChannelEstimate,
) -> Option<Vec<Evidence>> {
    let with = Systems::new(robot, recording, prepared)?;
    let weightless = robot.clone().with_gravity(Vector3::zeros());
    let without = Systems::new(&weightless, recording, prepared)?;
    let delay = channel.delay.value.unwrap_or(0.0);
    let parameters = robot.parameters();
    (0..robot.dof())
        .into_par_iter()
        .map(|j| {
            let joints = with.joints[j].as_ref().zip(without.joints[j].as_ref());
            let numbers = Numbers::of(recording, j)?;
            Some(Evidence {
                channel: channel.joints[j].clone(),
                fitted: joints.and_then(|(a, b)| {
                    let both = [(&with, a), (&without, b)];
                    fit(both, j, delay, numbers.negative, &parameters)
                }),
                numbers,
            })
        })
        .collect()
}

/// Rows of one joint's regression at a delay.
struct Rows {
    /// Values of the columns, row after row; the last column is the described torque.
    values: Vec<f64>,
    /// Recorded torque of each row.
    target: Vec<f64>,
    /// Number of columns.
    width: usize,
}

impl Rows {
    /// Values of column `c`.
    fn column(&self, c: usize) -> impl Iterator<Item = f64> + '_ {
        self.values.iter().skip(c).step_by(self.width).copied()
    }
}

/// Rows of a joint with the torque moved by `delay`, s; none where too few are left.
fn rows(systems: &Systems, joint: &Joint, index: usize, delay: f64) -> Option<Rows> {
    let mut system = systems.system(joint, index);
    // The described torque comes last: it is looked at, not fitted.
    system.columns.push(joint.rigid.clone());
    let width = system.columns.len();
    let (values, target) = rows_at(&system, delay, &Search::default())?;
    Some(Rows {
        values,
        target,
        width,
    })
}

/// Fit of a joint's torque, from its systems with and without gravity. `negative` is the part of its samples below
/// zero.
fn fit(
    [(with, joint), (without, bare)]: [(&Systems, &Joint); 2],
    index: usize,
    delay: f64,
    negative: f64,
    parameters: &[f64],
) -> Option<Fitted> {
    let all = rows(with, joint, index, delay)?;
    let none = rows(without, bare, index, delay)?;
    let count = all.target.len();
    let blocks = Blocks::new(&all.values, &all.target, all.width);
    let model: Vec<usize> = (0..all.width - 1).collect();
    let friction_starts = all.width - 1 - joint.friction.len();
    let offset = friction_starts;
    let spread = blocks.left(&[offset]);
    let left = blocks.left(&model);
    let left_without = {
        let blocks = Blocks::new(&none.values, &none.target, none.width);
        blocks.left(&(0..none.width - 1).collect::<Vec<_>>())
    };
    let rigid: Vec<f64> = all.column(all.width - 1).collect();
    let moved: Vec<f64> = none.column(none.width - 1).collect();
    let gravity: Vec<f64> = rigid.iter().zip(&moved).map(|(a, b)| a - b).collect();
    let described = deviation(&rigid);
    let sliding: Vec<usize> = (offset + 1..offset + 1 + FRICTION).collect();
    let speed: Vec<f64> = all.column(offset + 1).collect();
    let power: Vec<f64> = sliding
        .iter()
        .map(|&c| all.column(c).zip(&speed).map(|(f, v)| f * v).sum::<f64>() / count as f64)
        .collect();
    let size = (spread / count as f64).sqrt() * rms(&speed);
    let friction = blocks.estimate(&model, |x| {
        let own = sliding.iter().zip(&power);
        own.map(|(&c, p)| x[c] * p).sum::<f64>() / size.max(f64::MIN_POSITIVE)
    });
    let mut plain = vec![all.width - 1];
    plain.extend(offset..offset + 1 + FRICTION);
    let scale = blocks.estimate(&plain, |x| x[0]);
    let inertia = inertia(&all, [&gravity, &moved], offset);
    Some(Fitted {
        inertia,
        explained: 1.0 - left / spread.max(f64::MIN_POSITIVE),
        gravity: left / left_without.max(f64::MIN_POSITIVE),
        loaded: deviation(&gravity) / described.max(f64::MIN_POSITIVE),
        scale,
        friction,
        described,
        doubt: doubt(joint, parameters) / described.max(f64::MIN_POSITIVE),
        folded: if negative < FEW {
            folded(&all, &model, &rigid, &speed, left)
        } else {
            1.0
        },
        limit: limit(&all, &model),
    })
}

/// Ratio of recorded to described inertia, divided by the same ratio of gravity. Both parts of the described torque are
/// fitted with offset and friction. None where either part is only rounding, or gravity does not show.
fn inertia(rows: &Rows, parts: [&[f64]; 2], offset: usize) -> Option<Estimate> {
    // An axis that is upright up to rounding.
    if parts
        .iter()
        .any(|p| rms(p) <= ROUNDING * (rms(parts[0]) + rms(parts[1])))
    {
        return None;
    }
    let columns = 2 + 1 + FRICTION;
    let lines = rows.values.chunks(rows.width).enumerate();
    let values: Vec<f64> = lines
        .flat_map(|(k, line)| {
            let own = parts.map(|p| p[k]).into_iter();
            own.chain(line[offset..offset + 1 + FRICTION].iter().copied())
        })
        .collect();
    let blocks = Blocks::new(&values, &rows.target, columns);
    let all: Vec<usize> = (0..columns).collect();
    let gravity = blocks.estimate(&all, |x| x[0]);
    (gravity.value.abs() > SHOWS * gravity.std).then(|| blocks.estimate(&all, |x| x[1] / x[0]))
}

/// Standard deviation of a joint's torque, N·m (N), by errors of [`MISPLACED`] in the described centre of mass of every
/// link.
fn doubt(joint: &Joint, parameters: &[f64]) -> f64 {
    let links = joint.standard.chunks(PARAMETERS_PER_LINK);
    let own = links.zip(parameters.chunks(PARAMETERS_PER_LINK));
    let square = own.flat_map(|(columns, p)| {
        let moments = columns[1..4].iter();
        moments.map(|c| (MISPLACED * p[0] * deviation(c)).powi(2))
    });
    square.sum::<f64>().sqrt()
}

/// Number of rounds in which the sign of a torque without sign is searched.
const ROUNDS: usize = 10;

/// Squared error of a fit to |torque| with the model's sign put before it, over the squared error `left` of a fit to
/// the torque. The sign is that of the fitted model itself, found from several first guesses.
fn folded(rows: &Rows, model: &[usize], rigid: &[f64], speed: &[f64], left: f64) -> f64 {
    let (r, v) = (
        rms(rigid).max(f64::MIN_POSITIVE),
        rms(speed).max(f64::MIN_POSITIVE),
    );
    let mut best = left;
    for weight in [0.0, 0.7, 3.0] {
        let mut guess: Vec<f64> = rigid
            .iter()
            .zip(speed)
            .map(|(t, s)| t / r + weight * s / v)
            .collect();
        for _ in 0..ROUNDS {
            let target: Vec<f64> = rows
                .target
                .iter()
                .zip(&guess)
                .map(|(t, g)| t * g.signum())
                .collect();
            let blocks = Blocks::new(&rows.values, &target, rows.width);
            let x = blocks.coefficients(model);
            best = best.min(blocks.left(model));
            guess = predicted(rows, model, &x);
        }
    }
    best / left.max(f64::MIN_POSITIVE)
}

/// Torque of each row by the coefficients `x` of the columns `model`.
fn predicted(rows: &Rows, model: &[usize], x: &[f64]) -> Vec<f64> {
    let lines = rows.values.chunks(rows.width);
    lines
        .map(|line| model.iter().zip(x).map(|(&c, x)| x * line[c]).sum())
        .collect()
}

/// Quantile of |torque| that is taken as the level of a limit.
const TOP: f64 = 0.98;
/// Part of the level below which torques are fitted as the smaller ones.
const INSIDE: f64 = 0.95;
/// Part of the level above which the model counts as beyond it.
const OUTSIDE: f64 = 1.05;
/// Range of the torque, as parts of the level, within which it counts as staying at the level while the model is
/// beyond.
const KEEPS: [f64; 2] = [0.85, 1.1];

/// Band of |torque|, as parts of the level, that counts as at the level.
const AT: [f64; 2] = [0.97, 1.03];
/// Band of |torque|, as parts of the level, of the same width below it, for comparison.
const BELOW: [f64; 2] = [0.87, 0.93];

/// Level of the largest torques, and how a model fitted to the smaller torques alone exceeds it.
fn limit(rows: &Rows, model: &[usize]) -> Limit {
    let sizes: Vec<f64> = rows.target.iter().map(|t| t.abs()).collect();
    let level = signal::quantile::quantile(sizes.clone(), TOP).unwrap_or(0.0);
    let (mut values, mut target) = (Vec::new(), Vec::new());
    for (line, t) in rows.values.chunks(rows.width).zip(&rows.target) {
        if t.abs() < INSIDE * level {
            values.extend_from_slice(line);
            target.push(*t);
        }
    }
    let blocks = Blocks::new(&values, &target, rows.width);
    let error = (blocks.left(model) / target.len().max(1) as f64).sqrt();
    let modelled = predicted(rows, model, &blocks.coefficients(model));
    // Beyond the smaller torques the model extrapolates: there its coefficients' errors count as well.
    let others: Vec<Vec<f64>> = blocks
        .without(model)
        .iter()
        .map(|x| predicted(rows, model, x))
        .collect();
    let doubt = |k: usize| {
        let without: Vec<f64> = others.iter().map(|o| o[k]).collect();
        error.hypot(Estimate::of_jackknife(modelled[k], &without).std)
    };
    let (mut beyond, mut visits, mut was) = (0, 0, false);
    for (k, (t, m)) in rows.target.iter().zip(&modelled).enumerate() {
        let keeps = (KEEPS[0] * level..KEEPS[1] * level).contains(&(t * m.signum()));
        let is = keeps && m.abs() > OUTSIDE * level + 2.0 * doubt(k);
        beyond += usize::from(is);
        visits += usize::from(is && !was);
        was = is;
    }
    let both = || rows.target.iter().zip(&modelled);
    let at = |t: f64| (AT[0] * level..AT[1] * level).contains(&t.abs());
    let at_level = both().filter(|(t, _)| at(**t)).count();
    let made = both()
        .filter(|(t, m)| {
            let size = **m * t.signum();
            let band = AT[0] * level - 2.0 * error..AT[1] * level + 2.0 * error;
            at(**t) && band.contains(&size)
        })
        .count();
    let within = |[low, high]: [f64; 2]| {
        let count = sizes
            .iter()
            .filter(|s| (low * level..high * level).contains(s))
            .count();
        count as f64
    };
    Limit {
        level,
        beyond: beyond as f64 / sizes.len().max(1) as f64,
        visits,
        share: within(AT) / sizes.len().max(1) as f64,
        crowd: within(AT) / within(BELOW).max(1.0),
        made: made as f64 / at_level.max(1) as f64,
    }
}

/// Root mean square of some values.
fn rms(x: &[f64]) -> f64 {
    (x.iter().map(|v| v * v).sum::<f64>() / x.len().max(1) as f64).sqrt()
}

/// Standard deviation of some values.
fn deviation(x: &[f64]) -> f64 {
    let mean = x.iter().sum::<f64>() / x.len().max(1) as f64;
    (x.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / x.len().max(1) as f64).sqrt()
}
