//! The loop: commanded motion, torque model, drive, robot.

use crate::drive::{Cascade, Gains};
use crate::model::Model;
use crate::motion::Motion;
use crate::subject::Subject;
use nalgebra::Vector3;
use plant::reference::Command;
use serde::Serialize;
use std::collections::VecDeque;

/// What the controller adds to the drive's own feedback.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Mode {
    /// Nothing: position and velocity loop alone.
    Cascade,
    /// Torque of the model without friction, at the commanded motion.
    Rigid,
    /// Torque of the model with friction, at the commanded motion.
    Physics,
    /// Torque of model and compensator, at the commanded motion.
    Compensated,
    /// Torque of the model at the measured state and an acceleration that the feedback asks for; friction at the commanded
    /// motion.
    ComputedTorque,
}

impl Mode {
    /// All modes, in the order of tables.
    pub const ALL: [Self; 5] = [
        Self::Cascade,
        Self::Rigid,
        Self::Physics,
        Self::Compensated,
        Self::ComputedTorque,
    ];

    /// Words for tables.
    pub fn words(self) -> &'static str {
        match self {
            Self::Cascade => "cascade alone",
            Self::Rigid => "rigid feedforward",
            Self::Physics => "physics",
            Self::Compensated => "physics + compensator",
            Self::ComputedTorque => "computed torque",
        }
    }
}

/// Times and gains of a loop.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Settings {
    /// Step of plant and drive, s.
    pub step: f64,
    /// Steps in one cycle of the controller, which sends set-points and additive torque.
    pub cycle: usize,
    /// Crossover of the velocity loop, Hz.
    pub crossover_hz: f64,
    /// Cycles from a set-point's time to the drive's acting on it.
    pub command_delay: usize,
    /// Cycles by which the additive torque is held back (softMC: AdditiveTorqueDelay, by default 3); right where it equals
    /// the delay of the set-points.
    pub additive_delay: usize,
    /// Standstill before the motion, in which the integrals take up the load, s.
    pub hold: f64,
    /// What is watched after the motion, s.
    pub after: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            step: 250e-6,
            cycle: 4,
            crossover_hz: 20.0,
            command_delay: 3,
            additive_delay: 3,
            hold: 1.0,
            after: 2.0,
        }
    }
}

impl Settings {
    /// Cycle of the controller, s.
    pub fn period(&self) -> f64 {
        self.step * self.cycle as f64
    }
}

/// What a drive knows at the end of a cycle; N values each.
pub struct Instant<'a> {
    /// Time since the start of the motion, as the drive acts on it, s.
    pub time: f64,
    /// Motion that it was to make.
    pub command: &'a Command,
    /// Measured positions.
    pub q: &'a [f64],
    /// Measured velocities.
    pub v: &'a [f64],
    /// True positions of the links, which no drive knows.
    pub links: &'a [f64],
    /// Torque that the motors gave.
    pub torque: &'a [f64],
    /// Torque of the model for the same motion.
    pub additive: &'a [f64],
}

/// What surrounds a loop.
pub trait Surroundings {
    /// Sets the torque from outside on each link at time `time`, N·m or N.
    fn push(&mut self, _time: f64, _push: &mut [f64]) {}

    /// Is told every cycle.
    fn watch(&mut self, _instant: &Instant) {}
}

/// Where the tool is for positions of the links, m.
pub type Tool<'a> = &'a (dyn Fn(&[f64]) -> Option<Vector3<f64>> + Sync);

/// Errors of a run, once a cycle; tables are row after row, N values each.
#[derive(Debug, Clone, Default)]
pub struct Trace {
    /// N.
    pub dof: usize,
    /// Time since the start of the motion, s.
    pub time: Vec<f64>,
    /// From when on errors count, s.
    pub from: f64,
    /// Length of the motion, s.
    pub duration: f64,
    /// Commanded minus measured position.
    pub error: Vec<f64>,
    /// Distance of the tool from where it was to be, m; empty where no tool is known.
    pub tool: Vec<f64>,
}

/// Runs a motion and keeps its errors.
pub fn track(
    subject: &mut Subject,
    model: &mut dyn Model,
    mode: Mode,
    motion: &dyn Motion,
    tool: Option<Tool>,
    settings: &Settings,
) -> Trace {
    struct Watch<'a> {
        trace: Trace,
        tool: Option<Tool<'a>>,
    }
    impl Surroundings for Watch<'_> {
        fn watch(&mut self, now: &Instant) {
            if now.time < 0.0 {
                return;
            }
            let trace = &mut self.trace;
            trace.time.push(now.time);
            let errors = now.command.q.iter().zip(now.q).map(|(r, q)| r - q);
            trace.error.extend(errors);
            if let Some(tool) = self.tool {
                let away = tool(now.links).zip(tool(&now.command.q));
                trace
                    .tool
                    .push(away.map_or(f64::NAN, |(at, to)| (at - to).norm()));
            }
        }
    }
    let mut watch = Watch {
        trace: Trace {
            dof: subject.dof(),
            duration: motion.duration(),
            ..Trace::default()
        },
        tool,
    };
    run(subject, model, mode, motion, settings, &mut watch);
    watch.trace
}

/// Runs a motion with something around.
pub fn run(
    subject: &mut Subject,
    model: &mut dyn Model,
    mode: Mode,
    motion: &dyn Motion,
    settings: &Settings,
    around: &mut dyn Surroundings,
) {
    let n = subject.dof();
    let zeros = || vec![0.0; n];
    let sample = |t: f64, out: &mut Command| motion.at(t.clamp(0.0, motion.duration()), out);
    let mut command = Command::new(n);
    sample(0.0, &mut command);
    let inertia: Vec<f64> = model
        .inertia(&command.q)
        .iter()
        .map(|m| m.max(1e-9))
        .collect();
    let mut cascade = Cascade::new(Gains::of(&inertia, settings.crossover_hz));
    model.reset();
    let (mut q, mut v, mut u, mut push) = (zeros(), zeros(), zeros(), zeros());
    let (mut wanted, mut sum, mut links) = (zeros(), zeros(), zeros());
    // Additive torque on its way, oldest first.
    let mut sent: VecDeque<Vec<f64>> = VecDeque::with_capacity(settings.additive_delay + 1);
    let late = settings.command_delay as f64 * settings.period();
    let start = -settings.hold;
    let end = motion.duration() + settings.after + late;
    let steps = ((end - start) / settings.step).round() as usize;
    let mut additive = zeros();
    for k in 0..steps {
        let t = start + k as f64 * settings.step;
        if k % settings.cycle == 0 {
            sample(t, &mut command);
            let mut torque = zeros();
            match mode {
                Mode::Cascade => {}
                Mode::Rigid => model.rigid(&command.q, &command.qd, &command.qdd, &mut torque),
                Mode::Physics => model.physics(&command, &mut torque),
                Mode::Compensated => model.compensated(&command, &mut torque),
                Mode::ComputedTorque => {
                    model.physics(&command, &mut torque);
                    model.rigid(&command.q, &command.qd, &command.qdd, &mut sum);
                    torque.iter_mut().zip(&sum).for_each(|(t, s)| *t -= s);
                }
            }
            sent.push_back(torque);
            if sent.len() > settings.additive_delay
                && let Some(due) = sent.pop_front()
            {
                additive = due;
            }
        }
        sample(t - late, &mut command);
        subject.measure(&mut q, &mut v);
        cascade.torque(&command, &q, &v, settings.step, &mut u);
        if mode == Mode::ComputedTorque {
            for j in 0..n {
                wanted[j] = command.qdd[j] + u[j] / inertia[j];
            }
            model.rigid(&q, &v, &wanted, &mut u);
        }
        u.iter_mut().zip(&additive).for_each(|(u, a)| *u += a);
        sum.copy_from_slice(&u);
        subject.limit(&mut u);
        for j in 0..n {
            if u[j] != sum[j] {
                cascade.saturated(j, &command, &q, &v, settings.step);
            }
        }
        if k % settings.cycle == 0 {
            subject.links(&mut links);
            around.watch(&Instant {
                time: t - late,
                command: &command,
                q: &q,
                v: &v,
                links: &links,
                torque: &u,
                additive: &additive,
            });
        }
        push.fill(0.0);
        around.push(t - late, &mut push);
        subject.step(t, settings.step, &u, &push);
    }
}
