//! Running the robot of a case, and telling the effect's torque from the rest.

use super::oracle::frictions;
use crate::effects::{Place, Withheld};
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

/// Rate of the recordings, Hz.
pub const RATE: f64 = 250.0;
/// Step and control period of the simulation, s.
const STEP: f64 = 5e-4;
const CONTROL: f64 = 1e-3;

/// An effect with its size and the joint on which it was set.
pub struct Chosen {
    /// Its name in the answers.
    pub name: &'static str,
    /// Its shape.
    pub effect: Box<dyn Withheld>,
    /// Its size.
    pub size: f64,
    /// Joint on which the size was set.
    pub at: usize,
    /// Share of that joint's torque that was meant.
    pub share: f64,
}

/// A run and its torque as noted.
pub struct Run {
    /// The trace.
    pub trace: Trace,
    /// Torque as noted, without noise.
    pub noted: Vec<f64>,
}

/// Runs the plant with its effects; none if it does not follow its reference.
pub fn simulate(
    nominal: &Arm,
    plain: &Arm,
    withheld: &[Chosen],
    session: &Session,
    errors: &Errors,
    bandwidth: f64,
    rng: ChaCha8Rng,
) -> Result<Option<Run>, RobotError> {
    let mut build = Build::plain(plain);
    let mut finest = STEP;
    for w in withheld {
        w.effect.apply(w.size, &mut build)?;
        let Some(step) = step_for(w.effect.as_ref(), w.size, plain) else {
            return Ok(None);
        };
        finest = finest.min(step);
    }
    let measurement = build.measurement.clone();
    let sensing = Sensing {
        count: errors.count.clone(),
        velocity_noise: errors.velocity.iter().map(|v| v * 0.4).collect(),
        corner: 60.0,
    };
    let mut controller = Controller::new(nominal, bandwidth, CONTROL, sensing, rng)?;
    let mut start = Command::new(nominal.dof());
    session.sample(session.span().0, &mut start);
    let (mut plant, axes) = build.plant(&start.q)?;
    let clock = Clock {
        step: finest,
        control: (CONTROL / finest).round() as usize,
        sample: (1.0 / (RATE * finest)).round() as usize,
    };
    let trace = run(
        session,
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
            (q - r).abs() < 0.25 * nominal.reach[i % n]
        });
    Ok(follows.then(|| Run {
        noted: noted(&trace, &measurement),
        trace,
    }))
}

/// Integration step for an effect's stiffest part, or none where that is too stiff or too soft.
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

/// Torque of each effect in every row: all that separates the noted torque from the plain plant's on the true motion,
/// and of two effects the part of the last as it was exerted.
pub fn effect_torques(
    plain: &Arm,
    withheld: &[Chosen],
    run: &Run,
) -> Result<Vec<Vec<f64>>, RobotError> {
    let trace = &run.trace;
    let n = trace.dof;
    let robot = plain.robot()?;
    let mut workspace = Workspace::new(&robot);
    let friction = frictions(plain);
    let mut model = vec![0.0; n];
    let mut all = Vec::with_capacity(run.noted.len());
    for (k, noted) in run.noted.chunks(n).enumerate() {
        let at = k * n..(k + 1) * n;
        let (q, qd, qdd) = (&trace.q[at.clone()], &trace.qd[at.clone()], &trace.qdd[at]);
        inverse_dynamics(&robot, &mut workspace, q, qd, qdd, &mut model);
        all.extend((0..n).map(|j| noted[j] - model[j] - friction[j].torque(qd[j])));
    }
    if withheld.len() < 2 {
        return Ok(vec![all]);
    }
    let mechanisms = trace.exerted.len() / trace.q.len();
    let last: Vec<f64> = trace
        .exerted
        .chunks(n)
        .skip(mechanisms.saturating_sub(1))
        .step_by(mechanisms.max(1))
        .flatten()
        .copied()
        .collect();
    let rest = all.iter().zip(&last).map(|(a, l)| a - l).collect();
    Ok(vec![rest, last])
}
