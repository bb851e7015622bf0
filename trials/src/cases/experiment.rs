//! Simulation of a case's robot, and separation of the effect's torque from the whole.

use super::oracle::frictions;
use crate::effects::{Place, Source, Withheld};
use physics::dynamics::{Workspace, inverse_dynamics};
use physics::robot::RobotError;
use plant::arm::Arm;
use plant::build::{Build, noted};
use plant::control::{Controller, Sensing};
use plant::measure::Errors;
use plant::reference::{Command, Session};
use plant::run::{Clock, Trace, run};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

/// Step and control period of the simulation, s.
const STEP: f64 = 5e-4;
const CONTROL: f64 = 1e-3;

/// An effect with its size and the joint on which it was set.
pub struct Chosen {
    /// Name of the effect in the answers.
    pub name: &'static str,
    /// Shape of the effect, without its size.
    pub effect: Box<dyn Withheld>,
    /// Size of the effect, in the unit of its mechanism.
    pub size: f64,
    /// Index of the joint on which the size was set.
    pub at: usize,
    /// Share of that joint's torque that the effect was meant to make.
    pub share: f64,
    /// Draw that gave its shape.
    pub source: Option<Source>,
}

/// A run and its torque as noted.
pub struct Run {
    /// Motion and torque of the run, without errors of sensors.
    pub trace: Trace,
    /// Torque as the channel notes it, without noise, N·m, row after row.
    pub noted: Vec<f64>,
}

/// One robot under one controller on one session.
#[derive(Clone, Copy)]
pub struct Experiment<'a> {
    /// Arm as the controller's model has it.
    pub nominal: &'a Arm,
    /// The plant without effects.
    pub plain: &'a Arm,
    /// Effects that the case withholds.
    pub withheld: &'a [Chosen],
    /// Small additional effects of the plant that are not part of the answer; each is one mechanism.
    pub background: &'a [Chosen],
    /// Commanded motion of the session.
    pub session: &'a Session,
    /// Errors of the controller's sensors.
    pub errors: &'a Errors,
    /// Position bandwidth of the controller, Hz.
    pub bandwidth: f64,
    /// Sampling rate of the trace, Hz.
    pub rate: f64,
}

impl Experiment<'_> {
    /// Runs the plant with its effects; none if it does not follow its reference.
    ///
    /// # Errors
    /// The bodies make no possible robot.
    pub fn run(&self, rng: ChaCha8Rng) -> Result<Option<Run>, RobotError> {
        let mut build = Build::plain(self.plain);
        let mut finest = STEP;
        // Effects that add joints come first: what is added after them finds its axes.
        for w in self.withheld.iter().chain(self.background) {
            w.effect.apply(w.size, &mut build)?;
            let Some(step) = step_for(w.effect.as_ref(), w.size, self.plain) else {
                return Ok(None);
            };
            finest = finest.min(step);
        }
        let measurement = build.measurement.clone();
        let sensing = Sensing {
            count: self.errors.count.clone(),
            velocity_noise: self.errors.velocity.iter().map(|v| v * 0.4).collect(),
            corner: 60.0,
        };
        let mut controller = Controller::new(self.nominal, self.bandwidth, CONTROL, sensing, rng)?;
        let mut start = Command::new(self.nominal.dof());
        self.session.sample(self.session.span().0, &mut start);
        let (mut plant, axes) = build.plant(&start.q)?;
        let clock = Clock {
            step: finest,
            control: (CONTROL / finest).round() as usize,
            sample: (1.0 / (self.rate * finest)).round() as usize,
        };
        let trace = run(
            self.session,
            &mut controller,
            &mut plant,
            &axes,
            clock,
            measurement.delay,
        );
        let n = trace.dof;
        let follows = trace
            .q
            .iter()
            .zip(&trace.q_ref)
            .enumerate()
            .all(|(i, (q, r))| {
                // Also false for what is not a number.
                (q - r).abs() < 0.25 * self.nominal.reach[i % n]
            });
        Ok(follows.then(|| Run {
            noted: noted(&trace, &measurement),
            trace,
        }))
    }

    /// The plant with its background alone.
    fn beside(&self) -> Result<Build, RobotError> {
        let mut build = Build::plain(self.plain);
        for b in self.background {
            b.effect.apply(b.size, &mut build)?;
        }
        Ok(build)
    }

    /// Torque of each background effect in every row, N·m: that of its mechanism minus the dry friction that it replaces.
    ///
    /// # Errors
    /// The bodies make no possible robot.
    pub fn background_torques(&self, run: &Run) -> Result<Vec<Vec<f64>>, RobotError> {
        let trace = &run.trace;
        let n = trace.dof;
        let (plain, beside) = (&frictions(self.plain), &self.beside()?.friction);
        let mechanisms = trace.exerted.len() / trace.q.len();
        let first = mechanisms - self.background.len();
        let of = |(i, b): (usize, &Chosen)| -> Vec<f64> {
            // Bristles carry their joint's Coulomb friction.
            let carries = (b.name == "presliding_hysteresis").then_some(b.at);
            let rows = trace.exerted.chunks(mechanisms * n).zip(trace.qd.chunks(n));
            rows.flat_map(|(exerted, qd)| {
                let own = &exerted[(first + i) * n..][..n];
                (0..n).map(move |j| {
                    let stands_for = carries
                        .filter(|&at| at == j)
                        .map_or(0.0, |_| plain[j].torque(qd[j]) - beside[j].torque(qd[j]));
                    own[j] - stands_for
                })
            })
            .collect()
        };
        Ok(self.background.iter().enumerate().map(of).collect())
    }

    /// Torque of each withheld effect in every row: all that separates the noted torque from that of the plant without it
    /// on the true motion, and of two effects the part of the last as it was exerted.
    ///
    /// # Errors
    /// The bodies make no possible robot.
    pub fn effect_torques(&self, run: &Run) -> Result<Vec<Vec<f64>>, RobotError> {
        let trace = &run.trace;
        let n = trace.dof;
        let mut all = beyond(self.plain, trace, &run.noted)?;
        for b in self.background_torques(run)? {
            all.iter_mut().zip(b).for_each(|(a, b)| *a -= b);
        }
        if self.withheld.len() < 2 {
            return Ok(vec![all]);
        }
        let mechanisms = trace.exerted.len() / trace.q.len();
        let own = mechanisms - self.background.len();
        let last: Vec<f64> = trace
            .exerted
            .chunks(n)
            .skip(own.saturating_sub(1))
            .step_by(mechanisms.max(1))
            .flatten()
            .copied()
            .collect();
        let rest = all.iter().zip(&last).map(|(a, l)| a - l).collect();
        Ok(vec![rest, last])
    }
}

/// The sum of the torques of one or more effects, row after row.
pub fn together(found: &[Vec<f64>]) -> Vec<f64> {
    let mut all = found[0].clone();
    for more in &found[1..] {
        all.iter_mut().zip(more).for_each(|(a, m)| *a += m);
    }
    all
}

/// Torque beyond rigid bodies, viscous and Coulomb friction of an arm on the true motion, N·m, row after row.
///
/// # Errors
/// The bodies make no possible robot.
pub fn beyond(plain: &Arm, trace: &Trace, torque: &[f64]) -> Result<Vec<f64>, RobotError> {
    let n = trace.dof;
    let robot = plain.robot()?;
    let mut workspace = Workspace::new(&robot);
    let friction = frictions(plain);
    let mut model = vec![0.0; n];
    let mut all = Vec::with_capacity(torque.len());
    for (k, noted) in torque.chunks(n).enumerate() {
        let at = k * n..(k + 1) * n;
        let (q, qd, qdd) = (&trace.q[at.clone()], &trace.qd[at.clone()], &trace.qdd[at]);
        inverse_dynamics(&robot, &mut workspace, q, qd, qdd, &mut model);
        all.extend((0..n).map(|j| noted[j] - model[j] - friction[j].torque(qd[j])));
    }
    Ok(all)
}

/// Integration step for an effect's stiffest part, s. None where that part is too stiff to integrate, or too soft to be
/// a gear.
fn step_for(effect: &dyn Withheld, size: f64, arm: &Arm) -> Option<f64> {
    let yielding = effect.yielding().map(|part| (part, part.place()));
    let Some((part, Place::Gear(joint))) = yielding else {
        return Some(STEP);
    };
    let (stiffness, disc) = (part.stiffness(size), arm.disc[joint]);
    // Rotor against a link that does not move, and against one as light as itself.
    let fast = (2.0 * stiffness / disc).sqrt();
    if (stiffness / disc).sqrt() < TAU * 5.0 {
        return None;
    }
    let mut step = STEP;
    while fast * step > 0.4 {
        step *= 0.5;
    }
    (step > 5e-5).then_some(step)
}
