//! Visibility: the size from which a planned motion shows each effect of the catalogue, before it is run.
//!
//! The expected recording is the torque of the described robot and of one effect at one size, by the effect's
//! own columns, with white noise. Sums of products are all that the search needs, and they follow from the
//! columns: xᵀy = γ xᵀc and yᵀy = γ² cᵀc + n σ² for the effect c of size γ. By bisection the size is found at
//! which the search's own rule accepts the effect, with nothing else wrong and the given parameters free within
//! their tolerances. Noise that is fitted by chance, surrogates and rivals are not counted: a real recording
//! needs a slightly larger effect.

mod choice;
mod expected;

pub use choice::Visible;

use crate::catalogue::{Candidate, catalogue, position_dependent_friction, torque_ripple};
use crate::motion::scene::{SOFT_SIGN, Scale, Scene};
use crate::settings::Settings;
use choice::Choice;
use expected::Judge;
use ndarray::{Array2, ArrayView1, Axis};
use physics::robot::Robot;
use rayon::prelude::*;
use signal::Motion;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Longest motion on which columns are evaluated, s; the remainder of a longer one is counted as more of the same.
const MOST_SECONDS: f64 = 150.0;
/// Frequency up to which a ripple passes into the rows, Hz, and its order where the gear is unknown, 1/rad.
const RIPPLE_HZ: f64 = 25.0;
const RIPPLE_ORDER: f64 = 100.0;

/// Least accepted size of each effect of the catalogue on a motion of a robot, in the order of the catalogue.
///
/// `motion` is evenly sampled within its segments; `noise` is the standard deviation of one torque sample at that rate,
/// N·m, by joint. Effects that are found in a residual itself (pushes, a saturated signal) are not among them. `progress` is told how
/// many effects of how many are done.
pub fn visible(
    robot: &Robot,
    motion: &Motion,
    noise: &[f64],
    settings: &Settings,
    progress: &(dyn Fn(usize, usize) + Sync),
) -> Vec<Visible> {
    let rate = rate(motion);
    let (motion, share) = on_one_clock(motion, rate);
    let scale = scale(robot, &motion, rate);
    let scene = Scene::new(robot, &motion, &scale);
    let candidates = candidates(&scene, &motion);
    let judge = Judge::new(&scene, &candidates, noise, settings, rate, share);
    let mut groups: Vec<Vec<Choice>> = Vec::new();
    for (i, c) in candidates.iter().enumerate() {
        // Of a body's ten parameters the first stands for all.
        let several = if c.columns.len() > FEW { 1 } else { FEW };
        for (k, quantity) in c.quantities.iter().enumerate().take(several) {
            let alike = |g: &&mut Vec<Choice>| {
                let other = &candidates[g[0].candidate];
                let same =
                    other.effect == c.effect && other.quantities[g[0].place].unit == quantity.unit;
                same && other.joints == c.joints && other.driver == c.driver
            };
            let choice = Choice {
                candidate: i,
                place: k,
            };
            match groups.iter_mut().find(alike) {
                Some(group) => group.push(choice),
                None => groups.push(vec![choice]),
            }
        }
    }
    let done = AtomicUsize::new(0);
    groups
        .par_iter()
        .map(|g| {
            let found = judge.first(g);
            progress(1 + done.fetch_add(1, Ordering::Relaxed), groups.len());
            found
        })
        .collect()
}

/// Largest number of coefficients of a candidate for which each is tried; with more, the first alone.
const FEW: usize = 2;

/// Sampling rate of a motion, Hz.
fn rate(motion: &Motion) -> f64 {
    let steps = motion.segments.iter().filter(|s| s.len() > 1);
    let (time, steps) = steps.fold((0.0, 0), |(t, n), s| {
        (
            t + motion.time[s.end - 1] - motion.time[s.start],
            n + s.len() - 1,
        )
    });
    steps as f64 / f64::max(time, f64::MIN_POSITIVE)
}

/// First stretches of a motion on one running clock, and the factor by which they count for the whole.
fn on_one_clock(motion: &Motion, rate: f64) -> (Motion, f64) {
    let most = (MOST_SECONDS * rate) as usize;
    let mut segments: Vec<Range<usize>> = Vec::new();
    let mut samples = 0;
    for s in &motion.segments {
        let len = s.len().min(most - samples);
        segments.push(samples..samples + len);
        samples += len;
        if samples >= most {
            break;
        }
    }
    let table = |t: &Array2<f64>| t.slice_axis(Axis(0), (0..samples).into()).to_owned();
    let part = Motion {
        time: (0..samples).map(|i| i as f64 / rate).collect(),
        q: table(&motion.q),
        qd: table(&motion.qd),
        qdd: table(&motion.qdd),
        segments,
    };
    (part, motion.len() as f64 / samples.max(1) as f64)
}

fn scale(robot: &Robot, motion: &Motion, rate: f64) -> Scale {
    let n = motion.dof();
    let seen = |column: ArrayView1<f64>| {
        column
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| {
                (a.min(*x), b.max(*x))
            })
    };
    let rms = |x: ArrayView1<f64>| (x.dot(&x) / x.len().max(1) as f64).sqrt().max(1e-9);
    let mut scale = Scale {
        softness: vec![SOFT_SIGN; n],
        lead: vec![0.0; n],
        speed: motion.qd.columns().into_iter().map(rms).collect(),
        range: motion.q.columns().into_iter().map(seen).collect(),
        torque: vec![1.0; n],
        session: (0.0, motion.time.last().copied().unwrap_or(0.0)),
        step: 1.0 / rate,
        channel: None,
        correlation_rows: None,
    };
    let predicted = Scene::new(robot, motion, &scale).predicted();
    scale.torque = predicted
        .columns()
        .into_iter()
        .map(|c| c.std(0.0).max(1e-9))
        .collect();
    scale
}

/// Candidates of the catalogue, with a ripple of each joint. For each effect, quantity and place those with the
/// fewest coefficients. Links turned by right angles and friction that builds up slowly are left out: they have
/// no size of their own.
fn candidates(scene: &Scene, motion: &Motion) -> Vec<Candidate> {
    let mut all = catalogue(scene, &[]);
    for (j, joint) in scene.robot.joints().iter().enumerate() {
        let fastest = motion
            .qd
            .column(j)
            .iter()
            .fold(0.0f64, |m, v| m.max(v.abs()));
        let seen = std::f64::consts::TAU * RIPPLE_HZ / fastest.max(1e-9);
        let order = joint.gear_ratio.unwrap_or(RIPPLE_ORDER).abs().min(seen);
        all.extend(torque_ripple::candidates(j, &[order]));
        all.extend(position_dependent_friction::candidates(scene, j, &[]));
    }
    all.retain(|c| !c.effect.info().parameter || c.shape.is_empty());
    let least: Vec<usize> = all
        .iter()
        .map(|c| {
            let alike = |o: &&Candidate| {
                let name = |c: &Candidate| c.quantities.first().map(|q| q.name);
                let same = o.effect == c.effect && name(o) == name(c);
                same && o.joints == c.joints && o.driver == c.driver
            };
            let counts = all.iter().filter(alike).map(|o| o.columns.len());
            counts.min().unwrap_or(0)
        })
        .collect();
    let mut least = least.into_iter();
    all.retain(|c| least.next() == Some(c.columns.len()));
    all
}
