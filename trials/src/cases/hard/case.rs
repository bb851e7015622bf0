//! Making a hard case.

use super::background::Settled;
use super::motion::{Day, Role};
use super::recorded::Recorded;
use super::{TRACE_HZ, background, motion, robot};
use crate::SimulateError;
use crate::cases::again::Again;
use crate::cases::case::Case;
use crate::cases::experiment::{Chosen, Experiment};
use crate::cases::kind::Kind;
use crate::cases::rehearsal::Rehearsal;
use crate::cases::size::{self, ROUNDS, Sized, sized, without_vibration};
use crate::cases::witness::Telling;
use crate::effects::{EFFECTS, Effect, Scene, Shape, pushes_at_rest};
use physics::robot::RobotError;
use plant::families::relative;
use plant::measure::Errors;
use plant::random::log_uniform;
use rand::seq::IndexedRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

/// Effects of which two can be on one joint.
pub const OF_A_GEAR: [&str; 8] = [
    "asymmetric_friction",
    "stribeck_friction",
    "nonlinear_viscous_friction",
    "load_dependent_friction",
    "position_dependent_friction",
    "presliding_hysteresis",
    "friction_drift",
    "torque_ripple",
];
/// Largest number of draws until two effects meet on one joint.
const MEETINGS: usize = 80;
/// Number of further rounds in which the background is simulated again.
const MORE: usize = 2;
/// Shortest rest in which a push occurs, s.
const REST: f64 = 0.8;

/// Hard case of a kind; none where the robot that was drawn does not suit the kind.
pub fn attempt(
    kind: Kind,
    id: &str,
    again: Option<Again>,
    rng: &mut ChaCha8Rng,
) -> Result<Option<(Case, Telling)>, SimulateError> {
    let nominal = relative(rng);
    let drawn = robot::draw(&nominal, rng);
    let n = nominal.dof();
    // Touches are set on one clock.
    let touched = kind.name() == "external_contact" || kind == Kind::ContactAtRest;
    let other_day = rng.random_bool(0.3) && !touched && kind != Kind::Outside;
    let resting = kind == Kind::ContactAtRest;
    let days = motion::draw(&nominal, [resting, other_day], again, rng);
    let rehearsal = Rehearsal::new(&drawn.plain, &days[0].session)?;
    let inertia = drawn.plain.inertia()?;
    let scene = Scene {
        arm: &drawn.plain,
        session: &days[0].session,
        demand: &rehearsal.demand,
        inertia: &inertia,
    };
    let pushed = if rng.random_bool(0.5) {
        Role::Train
    } else {
        Role::Test
    };
    let Some(mut withheld) = effects(kind, &scene, &rehearsal, &days[0], pushed, rng)? else {
        return Ok(None);
    };
    let mut background = background::draw(&scene, &rehearsal, &withheld, rng)?;
    let errors = Errors {
        count: (0..n)
            .map(|j| nominal.reach[j] / 1.4 * TAU / f64::from(1u32 << rng.random_range(16..21)))
            .collect(),
        velocity: nominal
            .speed()
            .iter()
            .map(|v| v * log_uniform(rng, 0.0004, 0.004))
            .collect(),
        torque: vec![0.0; n],
    };
    let bandwidth = rng.random_range(5.0..10.0);
    let control = ChaCha8Rng::from_rng(rng);
    let bare = Experiment {
        nominal: &nominal,
        plain: &drawn.plain,
        withheld: &[],
        background: &[],
        session: &days[0].session,
        errors: &errors,
        bandwidth,
        rate: TRACE_HZ,
    };
    for round in 0..ROUNDS + MORE {
        let experiment = Experiment {
            withheld: &withheld,
            background: &background,
            ..bare
        };
        let Some(run) = experiment.run(control.clone())? else {
            return Ok(None);
        };
        let found = without_vibration(experiment.effect_torques(&run)?, &withheld, &run, TRACE_HZ);
        let shares = size::shares(&withheld, &found, &run);
        let torques = experiment.background_torques(&run)?;
        let beside = size::shares(&background, &torques, &run);
        match (
            sized(&mut withheld, &shares, round),
            background::settle(&mut background, &beside),
        ) {
            (Sized::Unsuited, _) => return Ok(None),
            (Sized::Again, _) | (_, Settled::Again) => continue,
            (Sized::Well, Settled::Well) => {}
        }
        let recorded = Recorded {
            kind,
            id,
            drawn: &drawn,
            days: &days,
            experiment: Experiment {
                withheld: &withheld,
                background: &background,
                ..bare
            },
            pushed,
            nominal: &nominal,
            rests: if resting {
                days[0].rests(pushed, REST)
            } else {
                Vec::new()
            },
        };
        return recorded.finish(run, &found, &torques, rng);
    }
    Ok(None)
}

/// Draws the effects of a case; none if the arm or its motion has no place for them.
fn effects(
    kind: Kind,
    scene: &Scene,
    rehearsal: &Rehearsal,
    day: &Day,
    pushed: Role,
    rng: &mut ChaCha8Rng,
) -> Result<Option<Vec<Chosen>>, RobotError> {
    let shapes: Option<Vec<(&'static str, Shape)>> = match kind {
        Kind::None => Some(Vec::new()),
        Kind::Single(e) => {
            let worn = Effect::WORN.into_iter().find(|w| w.name == EFFECTS[e]);
            // Of gears half are of the foreign kind.
            let effect = worn
                .filter(|_| rng.random_bool(0.5))
                .unwrap_or(Effect::listed(e));
            effect.draw(scene, rng).map(|s| vec![(effect.name, s)])
        }
        Kind::Outside => Effect::OUTSIDE
            .draw(scene, rng)
            .map(|s| vec![(Effect::OUTSIDE.name, s)]),
        Kind::ContactAtRest => pushes_at_rest(scene, &day.rests(pushed, REST), rng)
            .map(|s| vec![("external_contact", s)]),
        Kind::TwoOfOneJoint => two_of_one_joint(scene, rng),
        Kind::Two => None,
    };
    let Some(shapes) = shapes else {
        return Ok(None);
    };
    let mut chosen: Vec<Chosen> = Vec::new();
    for (name, shape) in shapes {
        let Shape {
            effect,
            joint,
            share,
            source,
        } = shape;
        let Some((size, at)) = rehearsal.size_for(effect.as_ref(), joint, share)? else {
            return Ok(None);
        };
        chosen.push(Chosen {
            name,
            effect,
            size,
            at,
            share,
            source,
        });
    }
    Ok(Some(chosen))
}

/// Two different effects on one joint; the last is one whose torque the simulation records separately.
fn two_of_one_joint(scene: &Scene, rng: &mut ChaCha8Rng) -> Option<Vec<(&'static str, Shape)>> {
    let any = |rng: &mut ChaCha8Rng| {
        let name = OF_A_GEAR.choose(rng)?;
        let place = EFFECTS.iter().position(|e| e == name)?;
        let effect = Effect::listed(place);
        Some((effect.name, effect.draw(scene, rng)?))
    };
    let first = any(rng)?;
    for _ in 0..MEETINGS {
        let Some(second) = any(rng) else { continue };
        if second.0 == first.0 || second.1.joint != first.1.joint {
            continue;
        }
        let mut both = vec![first, second];
        if !both[1].1.effect.is_self_contained() {
            both.swap(0, 1);
        }
        return both[1].1.effect.is_self_contained().then_some(both);
    }
    None
}
