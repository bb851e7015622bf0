//! Simulated contacts: what the detectors find of them, and what they find where there is nothing.

use super::residual::Signal;
use super::threshold::{Thresholds, alarms, thresholds};
use super::{DETECTORS, Momentum, Regimes, Sudden, TIME_CONSTANT, TorqueError, WINDOW};
use crate::ControlError;
use crate::model::Model;
use crate::motion::{Fourier, Motion};
use crate::subject::Subject;
use crate::track::{Instant, Mode, Settings, Surroundings, run};
use identify::excitation::MotionLimits;
use plant::reference::Command;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;
use serde::Serialize;
use trials::protocols::Machine;

/// What to simulate.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Session time of every run's start, s.
    pub time: f64,
    /// What the controller adds.
    pub mode: Mode,
    /// Runs from which the thresholds are chosen.
    pub calibration: usize,
    /// Runs with one contact each.
    pub contacts: usize,
    /// Runs with none.
    pub clean: usize,
    /// Wanted false alarms per hour, of all joints together.
    pub per_hour: f64,
    /// Size of a contact over the RMS of the touched joint's residual.
    pub factor: f64,
    /// Seed.
    pub seed: u64,
    /// Loop.
    pub settings: Settings,
}

/// Length of a run, s: one period of a Fourier motion.
const PERIOD: f64 = 10.0;
/// When a contact begins, s, and how long it lasts.
const BEGINS: std::ops::Range<f64> = 2.0..8.0;
const LASTS: f64 = 0.3;
/// Time within which it is to be found, s.
const WITHIN: f64 = 0.05;

/// What one detector found.
#[derive(Debug, Clone, Serialize)]
pub struct Found {
    /// One of [`DETECTORS`].
    pub name: &'static str,
    /// Thresholds of every joint.
    pub thresholds: Vec<Thresholds>,
    /// Contacts at each joint found within 50 ms, and all.
    pub by_joint: Vec<[usize; 2]>,
    /// Time to an alarm of those that were found, s, median.
    pub latency: f64,
    /// Alarms in the runs without contact.
    pub false_alarms: usize,
}

/// Results.
#[derive(Debug, Clone, Serialize)]
pub struct Contacts {
    /// RMS of every joint's residual, measured minus model torque, N·m or N.
    pub residual_rms: Vec<f64>,
    /// Size of a contact at every joint, N·m or N.
    pub size: Vec<f64>,
    /// Hours without contact.
    pub clean_hours: f64,
    /// Each of [`DETECTORS`].
    pub detectors: [Found; 3],
}

impl Found {
    /// Contacts found within 50 ms, and all.
    pub fn count(&self) -> [usize; 2] {
        let joints = self.by_joint.iter();
        joints.fold([0, 0], |s, b| [s[0] + b[0], s[1] + b[1]])
    }

    /// Part of the contacts that was found within 50 ms.
    pub fn share(&self) -> f64 {
        let [found, all] = self.count();
        found as f64 / all.max(1) as f64
    }
}

/// A torque from outside on one link.
#[derive(Debug, Clone, Copy)]
struct Contact {
    joint: usize,
    start: f64,
    size: f64,
}

/// The residual, then what each detector shows.
type Signals = [Signal; 1 + DETECTORS.len()];

/// The detectors beside a loop.
struct Watch<'a> {
    contact: Option<Contact>,
    model: &'a mut dyn Model,
    noise: &'a [f64],
    rng: ChaCha8Rng,
    period: f64,
    error: TorqueError,
    observer: Momentum,
    sudden: Sudden,
    regimes: Regimes,
    signals: Signals,
}

impl Surroundings for Watch<'_> {
    fn push(&mut self, time: f64, push: &mut [f64]) {
        if let Some(c) = self.contact
            && (c.start..c.start + LASTS).contains(&time)
        {
            push[c.joint] = c.size;
        }
    }

    fn watch(&mut self, now: &Instant) {
        let Command { q, qd, qdd } = now.command;
        let draw = |s: &f64| s * Distribution::<f64>::sample(&StandardNormal, &mut self.rng);
        let noise: Vec<f64> = self.noise.iter().map(draw).collect();
        let measured: Vec<f64> = now.torque.iter().zip(noise).map(|(t, e)| t + e).collect();
        // Friction as the model has it for the commanded motion.
        let mut net = vec![0.0; measured.len()];
        self.model.rigid(q, qd, qdd, &mut net);
        for j in 0..net.len() {
            net[j] += measured[j] - now.additive[j];
        }
        let shown = self.error.step(now.additive, &measured);
        let seen = self
            .observer
            .step(self.model, now.q, now.v, &net, self.period);
        let jump = self.sudden.step(seen);
        let moves = self.regimes.step(qd, self.period);
        // While the arm takes up its load before the motion they settle.
        if now.time < 0.0 {
            return;
        }
        let first = self.signals[0].time.is_empty();
        let left: Vec<f64> = measured
            .iter()
            .zip(now.additive)
            .map(|(m, a)| m - a)
            .collect();
        self.signals[0].push(now.time, &left, moves, first);
        self.signals[1].push(now.time, shown, moves, first);
        self.signals[2].push(now.time, seen, moves, first);
        self.signals[3].push(now.time, jump, moves, first);
    }
}

/// Simulates on the threads of the current pool; `model` makes what each run's controller knows. The same plan gives the same
/// figures on any number of threads.
///
/// # Errors
/// A robot or model that cannot be used.
pub fn contacts<M: Model>(
    machine: &Machine,
    limits: &[MotionLimits],
    model: impl Fn() -> Result<M, ControlError> + Sync,
    plan: &Plan,
) -> Result<Contacts, ControlError> {
    let n = machine.arm.dof();
    let speeds: Vec<f64> = limits.iter().map(|l| l.velocity).collect();
    let run_of = |index: usize, contact: Option<Contact>| -> Result<Signals, ControlError> {
        let seed = plan.seed.wrapping_mul(1_000_003).wrapping_add(index as u64);
        let motion = Fourier::draw(limits.to_vec(), PERIOD, seed)?;
        let mut begin = Command::new(n);
        motion.at(0.0, &mut begin);
        let mut subject = Subject::arm(machine, &begin.q, plan.time)?;
        let (mut drives, mut watches) = (model()?, model()?);
        let period = plan.settings.period();
        let mut watch = Watch {
            contact,
            model: &mut watches,
            noise: &machine.errors.torque,
            rng: ChaCha8Rng::seed_from_u64(seed),
            period,
            error: TorqueError::new(n, TorqueError::filter(TIME_CONSTANT, period)),
            observer: Momentum::new(n, 1.0 / TIME_CONSTANT),
            sudden: Sudden::new(n, 1.0 / TIME_CONSTANT, WINDOW, period),
            regimes: Regimes::new(&speeds),
            signals: std::array::from_fn(|_| Signal::new(n)),
        };
        run(
            &mut subject,
            &mut drives,
            plan.mode,
            &motion,
            &plan.settings,
            &mut watch,
        );
        Ok(watch.signals)
    };
    let runs = |first: usize, count: usize| -> Result<Vec<Signals>, ControlError> {
        (first..first + count)
            .into_par_iter()
            .map(|index| run_of(index, None))
            .collect()
    };
    let calm = joined(&runs(0, plan.calibration)?, n);
    let residual_rms = calm[0].rms();
    let chosen: [Vec<Thresholds>; DETECTORS.len()] =
        std::array::from_fn(|d| thresholds(&calm[1 + d], plan.per_hour));
    let size: Vec<f64> = residual_rms.iter().map(|r| plan.factor * r).collect();

    let mut rng = ChaCha8Rng::seed_from_u64(plan.seed);
    let touched: Vec<Contact> = (0..plan.contacts)
        .map(|k| {
            let joint = k % n;
            let sign = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
            Contact {
                joint,
                start: rng.random_range(BEGINS),
                size: sign * size[joint],
            }
        })
        .collect();
    // Time to the first alarm of each detector.
    let latencies: Vec<[Option<f64>; DETECTORS.len()]> = touched
        .par_iter()
        .enumerate()
        .map(|(k, contact)| {
            let signals = run_of(plan.calibration + k, Some(*contact))?;
            Ok(std::array::from_fn(|d| {
                latency(&signals[1 + d], &chosen[d], contact.start)
            }))
        })
        .collect::<Result<_, ControlError>>()?;

    // In parts, for signals of hours would fill the memory.
    const PART: usize = 60;
    let mut false_alarms = [0usize; DETECTORS.len()];
    let mut done = 0;
    while done < plan.clean {
        let count = PART.min(plan.clean - done);
        for signals in runs(plan.calibration + plan.contacts + done, count)? {
            for (d, count) in false_alarms.iter_mut().enumerate() {
                *count += alarms(&signals[1 + d], &chosen[d]).len();
            }
        }
        done += count;
    }
    let found = |d: usize| {
        let mut by_joint = vec![[0, 0]; n];
        let mut times: Vec<f64> = Vec::new();
        for (contact, latency) in touched.iter().zip(&latencies) {
            by_joint[contact.joint][1] += 1;
            if let Some(time) = latency[d].filter(|t| *t <= WITHIN) {
                by_joint[contact.joint][0] += 1;
                times.push(time);
            }
        }
        times.sort_by(f64::total_cmp);
        Found {
            name: DETECTORS[d],
            thresholds: chosen[d].clone(),
            by_joint,
            latency: times.get(times.len() / 2).copied().unwrap_or(f64::NAN),
            false_alarms: false_alarms[d],
        }
    };
    Ok(Contacts {
        size,
        clean_hours: plan.clean as f64 * (PERIOD + plan.settings.after) / 3600.0,
        detectors: std::array::from_fn(found),
        residual_rms,
    })
}

/// Signals of runs one behind the other.
fn joined(runs: &[Signals], dof: usize) -> Signals {
    std::array::from_fn(|k| {
        let mut all = Signal::new(dof);
        runs.iter().for_each(|signals| all.append(&signals[k]));
        all
    })
}

/// Time from `start` to the first sample at which a joint exceeds its threshold, while the contact lasts.
fn latency(signal: &Signal, thresholds: &[Thresholds], start: f64) -> Option<f64> {
    let first = signal.time.partition_point(|&t| t < start);
    let mut after = (first..signal.time.len()).take_while(|&row| signal.time[row] < start + LASTS);
    let limit = |row: usize, j: usize| thresholds[j].of(signal.regime(row, j));
    let beyond = |row: usize| (0..signal.dof).any(|j| signal.at(row, j).abs() > limit(row, j));
    after
        .find(|&row| beyond(row))
        .map(|row| signal.time[row] - start)
}
