//! The robot that is recorded, and its motion.

use crate::effects::{
    Asymmetry, CoggingWaves, FluidFriction, LoadFriction, Presliding, StartingFriction, Withheld,
};
use nalgebra::Vector3;
use physics::robot::RobotError;
use plant::arm::{Arm, altered};
use plant::build::Build;
use plant::control::{Controller, Sensing};
use plant::families::relative;
use plant::mechanism::{DragKind, StribeckKind};
use plant::random::log_uniform;
use plant::reference::{Command, Moves, Multisine, Pace, Segment, Session};
use plant::run::{Clock, Trace, run as run_loop};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

/// Step and control period of the simulation, s.
const STEP: f64 = 5e-4;
const CONTROL: f64 = 1e-3;
/// Time between trajectories, s.
const GAP: f64 = 2.0;

/// A robot in its description, and the true one.
pub struct Drawn {
    /// The described robot; its friction is that of the controller's model.
    pub nominal: Arm,
    /// Real robot without the mechanisms.
    pub plain: Arm,
    /// Largest relative error of a described mass or inertia.
    pub inertial_error: f64,
    /// Mechanisms beyond viscous and Coulomb friction, with sizes.
    mechanisms: Vec<(Box<dyn Withheld>, f64)>,
}

/// Part of the robots of raw recordings whose torque is that of sensors at the joints.
pub const SEEN_AT_THE_JOINT: f64 = 0.2;

/// A random robot with a little of everything; a part `at_the_joint` of them shows little of its gears' friction, as
/// sensors at the joints do.
pub fn draw(at_the_joint: f64, rng: &mut ChaCha8Rng) -> Drawn {
    let mut nominal = relative(rng);
    if rng.random_bool(at_the_joint) {
        let part = rng.random_range(0.05..0.2);
        for joint in &mut nominal.joints {
            joint.friction *= part;
            joint.damping *= part;
        }
    }
    let inertial_error = [0.0, 0.02, 0.05][rng.random_range(0..3)];
    let mut plain = nominal.clone();
    for joint in &mut plain.joints {
        let body = &joint.link.inertia;
        let mut off = |part: f64| part * inertial_error * rng.random_range(-1.0..1.0);
        let shift = Vector3::from_fn(|_, _| off(0.6)) * body.com().norm();
        let (mass, inertia) = (1.0 + off(1.0), 1.0 + off(1.0));
        joint.link.inertia = altered(body, mass, shift, inertia);
        joint.damping *= rng.random_range(0.8..1.25);
        joint.friction *= rng.random_range(0.8..1.25);
    }
    let mechanisms = mechanisms(&plain, rng);
    Drawn {
        nominal,
        plain,
        inertial_error,
        mechanisms,
    }
}

/// Mechanisms of its gears beyond viscous and Coulomb friction, joint by joint.
fn mechanisms(arm: &Arm, rng: &mut ChaCha8Rng) -> Vec<(Box<dyn Withheld>, f64)> {
    let mut all: Vec<(Box<dyn Withheld>, f64)> = Vec::new();
    for (joint, j) in arm.joints.iter().enumerate() {
        let (coulomb, top) = (j.friction, j.limits.velocity);
        let reach = arm.reach[joint] / 1.4;
        if rng.random_bool(0.35) {
            let effect = Presliding {
                joint,
                elastic: rng.random_range(0.2..0.7),
                more: 0.0,
                damping: 0.0,
            };
            all.push((Box::new(effect), log_uniform(rng, 3e-4, 5e-3) * reach));
        }
        if rng.random_bool(0.3) {
            let effect = StartingFriction {
                joint,
                v_s: log_uniform(rng, 0.01, 0.08) * top,
                law: StribeckKind::Lorentz,
            };
            all.push((Box::new(effect), coulomb * rng.random_range(0.1..0.5)));
        }
        if rng.random_bool(0.4) {
            let effect = FluidFriction {
                joint,
                v_0: rng.random_range(0.1..0.4) * top,
                v_top: top,
                law: if rng.random_bool(0.7) {
                    DragKind::Eyring
                } else {
                    DragKind::Churning
                },
            };
            all.push((
                Box::new(effect),
                j.damping * top * rng.random_range(0.1..0.5),
            ));
        }
        if rng.random_bool(0.25) {
            all.push((
                Box::new(LoadFriction { joint }),
                rng.random_range(0.02..0.08),
            ));
        }
        if rng.random_bool(0.3) {
            let effect = Asymmetry {
                joint,
                coulomb: 1.0,
                viscous: 0.0,
            };
            all.push((Box::new(effect), coulomb * rng.random_range(-0.15..0.15)));
        }
        if rng.random_bool(0.25) {
            let order = rng.random_range(4.0..60.0f64) / reach;
            let waves = vec![[order, 1.0, rng.random_range(0.0..TAU)]];
            let effect = CoggingWaves { joint, waves };
            all.push((Box::new(effect), coulomb * rng.random_range(0.03..0.15)));
        }
    }
    all
}

/// One motion of 15 to 60 s, or several of 6 to 12 s; before each of them `run_in` seconds that are not recorded.
pub fn session(arm: &Arm, run_in: f64, rng: &mut ChaCha8Rng) -> Session {
    let lengths: Vec<f64> = if rng.random_bool(0.65) {
        vec![log_uniform(rng, 15.0, 60.0)]
    } else {
        (0..rng.random_range(3..7))
            .map(|_| rng.random_range(6.0..12.0))
            .collect()
    };
    let segments = lengths.into_iter().map(|length| {
        let length = (10.0 * (length + run_in)).round() / 10.0;
        let segment = match rng.random_range(0..10) {
            0..2 => Segment::Moves(Moves::draw(arm, length, rng.random_range(0.5..0.85), rng)),
            2..6 => Segment::Multisine(Multisine::draw(arm, &Pace::lively(), length, rng)),
            _ => {
                let fundamental = log_uniform(rng, 0.05, 0.2);
                let pace = Pace::constant(fundamental, 5, rng.random_range(0.5..0.9));
                Segment::Multisine(Multisine::draw(arm, &pace, length, rng))
            }
        };
        (segment, length)
    });
    Session::new(segments.collect(), GAP, arm.dof())
}

/// Motion and torque of the session at `rate_hz`. None if the robot does not follow its reference. `coarse` is a factor
/// on the errors of the controller's own sensors.
///
/// # Errors
/// The drawn bodies do not make a possible robot.
pub fn run(
    drawn: &Drawn,
    session: &Session,
    rate_hz: f64,
    coarse: f64,
    rng: &mut ChaCha8Rng,
) -> Result<Option<Trace>, RobotError> {
    let n = drawn.nominal.dof();
    let mut build = Build::plain(&drawn.plain);
    for (effect, size) in &drawn.mechanisms {
        effect.apply(*size, &mut build)?;
    }
    let speed = drawn.nominal.speed();
    let sensing = Sensing {
        count: drawn
            .nominal
            .reach
            .iter()
            .map(|r| r * 1e-5 * coarse)
            .collect(),
        velocity_noise: speed.iter().map(|v| v * 3e-4 * coarse).collect(),
        corner: 60.0,
    };
    let bandwidth = rng.random_range(4.0..9.0);
    let control = ChaCha8Rng::from_rng(rng);
    let mut controller = Controller::new(&drawn.nominal, bandwidth, CONTROL, sensing, control)?;
    let mut start = Command::new(n);
    session.sample(session.span().0, &mut start);
    let (mut plant, axes) = build.plant(&start.q)?;
    let clock = Clock {
        step: STEP,
        control: (CONTROL / STEP).round() as usize,
        sample: (1.0 / (rate_hz * STEP)).round() as usize,
    };
    let trace = run_loop(session, &mut controller, &mut plant, &axes, clock, 0.0);
    let follows = trace
        .q
        .iter()
        .zip(&trace.q_ref)
        .enumerate()
        // Also false for what is not a number.
        .all(|(i, (q, r))| (q - r).abs() < 0.25 * drawn.nominal.reach[i % n]);
    Ok(follows.then_some(trace))
}
