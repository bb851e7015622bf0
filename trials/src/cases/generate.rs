//! Making a case.

use super::experiment::{Chosen, RATE, Run, effect_torques, simulate};
use super::kind::{CaseSpec, Kind};
use super::oracle::{low_passed, oracle, rms, unabsorbed};
use super::rehearsal::Rehearsal;
use super::truth::{PlantTruth, Truth, TruthEffect};
use crate::SimulateError;
use crate::effects::{EFFECTS, Effect, Scene, Shape, joint_name};
use datasets::Recording;
use nalgebra::Vector3;
use physics::dynamics::{Workspace, mass_matrix};
use physics::robot::{RobotError, to_urdf};
use plant::arm::{Arm, altered};
use plant::families::relative;
use plant::measure::{Errors, record};
use plant::random::log_uniform;
use plant::reference::{Moves, Multisine, Pace, Segment, Session};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use sha2::{Digest, Sha256};
use std::f64::consts::TAU;
use std::time::Instant;

/// A finished case.
#[derive(Debug, Clone)]
pub struct Case {
    /// Name: ten hexadecimal digits that say nothing about it.
    pub id: String,
    /// The simulator's model.
    pub urdf: String,
    /// Recording to fit on: 8 trajectories of 15 s at 250 Hz.
    pub train: Recording,
    /// Recording to be judged on: 4 trajectories in between.
    pub test: Recording,
    /// The answer.
    pub truth: Truth,
}

/// Trajectories, their length and distance, s.
const TRAJECTORIES: usize = 12;
const LENGTH: f64 = 15.0;
const GAP: f64 = 2.0;
/// Every third trajectory is held out.
const HELD_OUT: [usize; 4] = [2, 5, 8, 11];
/// Torque of effects that vibrate counts up to here, Hz.
const VIBRATION: f64 = 20.0;
/// Attempts at a case before giving up; one in some ten draws does not suit its effect.
const ATTEMPTS: u64 = 200;
/// Smallest part of a joint's torque, and largest, that an effect may make.
const SHARES: std::ops::Range<f64> = 0.03..0.6;

/// Makes the case. The same specification and seed give the same case.
///
/// # Errors
/// No robot suited the case in 200 draws.
pub fn generate(spec: &CaseSpec, seed: u64) -> Result<Case, SimulateError> {
    let begun = Instant::now();
    let mut key = Sha256::new();
    key.update(b"residyn case");
    key.update(seed.to_le_bytes());
    key.update(spec.index.to_le_bytes());
    let key: [u8; 32] = key.finalize().into();
    let id: String = key[..5].iter().map(|b| format!("{b:02x}")).collect();
    for attempt in 0..ATTEMPTS {
        let mut rng = ChaCha8Rng::from_seed(key);
        rng.set_stream(attempt);
        if let Some(mut case) = attempt_case(spec.kind, &id, &mut rng)? {
            case.truth.seed = [seed, spec.index, attempt];
            case.truth.seconds = begun.elapsed().as_secs_f64();
            return Ok(case);
        }
    }
    Err(SimulateError::NoCase {
        kind: spec.kind.name(),
        index: spec.index,
    })
}

fn attempt_case(kind: Kind, id: &str, rng: &mut ChaCha8Rng) -> Result<Option<Case>, SimulateError> {
    let nominal = relative(rng);
    let plain = nearly(&nominal, rng);
    let n = nominal.dof();
    let session = session(&nominal, rng);
    let rehearsal = Rehearsal::new(&plain, &session)?;
    let inertia = inertia(&plain)?;
    let scene = Scene {
        arm: &plain,
        session: &session,
        demand: &rehearsal.demand,
        inertia: &inertia,
    };
    let Some(mut withheld) = effects(kind, &scene, &rehearsal, rng)? else {
        return Ok(None);
    };
    let errors = Errors {
        count: (0..n)
            .map(|j| nominal.reach[j] / 1.4 * TAU / f64::from(1u32 << rng.random_range(18..21)))
            .collect(),
        velocity: nominal
            .speed()
            .iter()
            .map(|v| v * rng.random_range(0.0004..0.0014))
            .collect(),
        torque: (0..n).map(|_| log_uniform(rng, 0.005, 0.02)).collect(),
    };
    let bandwidth = rng.random_range(6.0..10.0);
    let control_rng = ChaCha8Rng::from_rng(rng);
    // Sizes of effects that change the motion itself are only guessed; correct them on what came out.
    for round in 0..3 {
        let Some(run) = simulate(
            &nominal,
            &plain,
            &withheld,
            &session,
            &errors,
            bandwidth,
            control_rng.clone(),
        )?
        else {
            return Ok(None);
        };
        let mut found = effect_torques(&plain, &withheld, &run)?;
        for (e, _) in found
            .iter_mut()
            .zip(&withheld)
            .filter(|(_, w)| w.effect.vibrates())
        {
            *e = low_passed(e, &run.trace.bounds(), n, RATE, VIBRATION);
        }
        let shares: Vec<f64> = withheld
            .iter()
            .zip(&found)
            .map(|(w, e)| column_rms(e, n)[w.at] / column_rms(&run.noted, n)[w.at])
            .collect();
        let wrong = withheld
            .iter()
            .zip(&shares)
            .any(|(w, s)| !(0.55..1.8).contains(&(s / w.share)));
        if wrong && round < 2 {
            for (w, s) in withheld.iter_mut().zip(&shares) {
                w.size = (w.size * (w.share / s).clamp(0.2, 4.0)).min(w.effect.largest());
            }
            continue;
        }
        if shares.iter().any(|s| !SHARES.contains(s)) {
            return Ok(None);
        }
        return finish(
            kind, id, &nominal, &plain, &withheld, &run, &found, &errors, rng,
        )
        .map(Some);
    }
    Ok(None)
}

/// Draws the effects of a case; none if the arm has no place for them.
fn effects(
    kind: Kind,
    scene: &Scene,
    rehearsal: &Rehearsal,
    rng: &mut ChaCha8Rng,
) -> Result<Option<Vec<Chosen>>, RobotError> {
    let mut any = || Effect::listed(rng.random_range(0..EFFECTS.len()));
    let drawn = match kind {
        Kind::None => vec![],
        Kind::Single(e) => vec![Effect::listed(e)],
        Kind::Outside => vec![Effect::OUTSIDE],
        Kind::Two => vec![any(), any()],
    };
    let mut chosen: Vec<Chosen> = Vec::new();
    for one in drawn {
        let Some(Shape {
            effect,
            joint,
            share,
        }) = one.draw(scene, rng)
        else {
            return Ok(None);
        };
        let Some((size, at)) = rehearsal.size_for(effect.as_ref(), joint, share)? else {
            return Ok(None);
        };
        if chosen.iter().any(|c| c.at == at || c.name == one.name) {
            return Ok(None);
        }
        chosen.push(Chosen {
            name: one.name,
            effect,
            size,
            at,
            share,
        });
    }
    // With two, the last must be one whose torque the simulation notes by itself; the other is the rest.
    if chosen.len() == 2 {
        if !chosen[1].effect.is_self_contained() {
            chosen.swap(0, 1);
        }
        if !chosen[1].effect.is_self_contained() {
            return Ok(None);
        }
    }
    Ok(Some(chosen))
}

/// A robot slightly different from `nominal`: inertials by up to 3 %, friction by up to 10 %.
fn nearly(nominal: &Arm, rng: &mut ChaCha8Rng) -> Arm {
    let mut arm = nominal.clone();
    for joint in &mut arm.joints {
        let body = &joint.link.inertia;
        let shift = Vector3::from_fn(|_, _| rng.random_range(-0.017..0.017)) * body.com().norm();
        let (mass, inertia) = (rng.random_range(0.97..1.03), rng.random_range(0.97..1.03));
        joint.link.inertia = altered(body, mass, shift, inertia);
        joint.damping *= rng.random_range(0.9..1.1);
        joint.friction *= rng.random_range(0.9..1.1);
    }
    arm
}

fn session(arm: &Arm, rng: &mut ChaCha8Rng) -> Session {
    let with_moves = rng.random_bool(0.35);
    let trajectories = (0..TRAJECTORIES).map(|_| {
        let segment = if with_moves && rng.random_bool(0.3) {
            Segment::Moves(Moves::draw(arm, LENGTH, rng.random_range(0.5..0.85), rng))
        } else {
            let pace = if rng.random_bool(0.12) {
                Pace::slow()
            } else {
                Pace::lively()
            };
            Segment::Multisine(Multisine::draw(arm, &pace, LENGTH, rng))
        };
        (segment, LENGTH)
    });
    Session::new(trajectories.collect(), GAP, arm.dof())
}

fn inertia(arm: &Arm) -> Result<Vec<f64>, RobotError> {
    let robot = arm.robot()?;
    let n = robot.dof();
    let mut mass = vec![0.0; n * n];
    mass_matrix(&robot, &mut Workspace::new(&robot), &arm.centre, &mut mass);
    Ok(mass.into_iter().step_by(n + 1).collect())
}

fn column_rms(table: &[f64], n: usize) -> Vec<f64> {
    (0..n)
        .map(|j| rms(table.iter().skip(j).step_by(n).copied()))
        .collect()
}

#[expect(
    clippy::too_many_arguments,
    reason = "the parts of one case, used once"
)]
fn finish(
    kind: Kind,
    id: &str,
    nominal: &Arm,
    plain: &Arm,
    withheld: &[Chosen],
    run: &Run,
    found: &[Vec<f64>],
    errors: &Errors,
    rng: &mut ChaCha8Rng,
) -> Result<Case, SimulateError> {
    let n = nominal.dof();
    let trace = &run.trace;
    let torque_rms = column_rms(&run.noted, n);
    let scaled = Errors {
        torque: errors
            .torque
            .iter()
            .zip(&torque_rms)
            .map(|(e, t)| e * t)
            .collect(),
        ..errors.clone()
    };
    let (recording, noise) = record(trace, &run.noted, &scaled, rng);
    let (train, test) = recording.split(&HELD_OUT);
    let noise_rms = column_rms(&noise, n);
    let mut all = found[0].clone();
    for more in &found[1..] {
        all.iter_mut().zip(more).for_each(|(a, m)| *a += m);
    }
    let mut parts = vec![all];
    if withheld.len() > 1 {
        parts.extend(found.iter().cloned());
    }
    let left = unabsorbed(plain, &trace.q, &trace.qd, &trace.qdd, &noise_rms, &parts)?;
    let held_out = |table: &[f64]| -> Vec<f64> {
        let bounds = trace.bounds();
        HELD_OUT
            .iter()
            .flat_map(|&i| table[bounds[i] * n..bounds[i + 1] * n].to_vec())
            .collect()
    };
    let vibrates = withheld.iter().any(|w| w.effect.vibrates());
    let oracle = oracle(
        nominal,
        plain,
        &test,
        RATE,
        &held_out(&parts[0]),
        vibrates,
        &held_out(&noise),
    )?;
    let effects = withheld.iter().enumerate().map(|(i, w)| {
        let own = if withheld.len() > 1 { i + 1 } else { 0 };
        let strength = column_rms(&parts[own], n);
        let description = w.effect.describe(w.size, n);
        let touched = || {
            (0..n)
                .filter(|&j| strength[j] > 0.02 * torque_rms[j])
                .collect()
        };
        TruthEffect {
            effect: w.name.to_owned(),
            mechanism: description.mechanism.to_owned(),
            scope: if description.joints.is_some() {
                "joint"
            } else {
                "global"
            }
            .to_owned(),
            joints: description
                .joints
                .unwrap_or_else(touched)
                .into_iter()
                .map(joint_name)
                .collect(),
            reference_joint: joint_name(w.at),
            level: w.size,
            parameters: description.parameters,
            share: strength[w.at] / torque_rms[w.at],
            share_after_reidentification: left[own][w.at] / torque_rms[w.at],
            snr_after_reidentification: left[own][w.at] / noise_rms[w.at],
            indistinguishable: description
                .indistinguishable
                .into_iter()
                .map(str::to_owned)
                .collect(),
        }
    });
    let truth = Truth {
        case: id.to_owned(),
        kind: kind.name().to_owned(),
        robot: nominal.family.to_owned(),
        seed: [0; 3],
        joints: n,
        effects: effects.collect(),
        effect_rms: column_rms(&parts[0], n),
        unabsorbed_rms: left[0].clone(),
        torque_rms,
        noise_rms,
        v_eps: plain.v_eps.clone(),
        oracle,
        plant: PlantTruth {
            inertias: plain
                .joints
                .iter()
                .map(|j| j.link.inertia.parameters().to_vec())
                .collect(),
            coulomb: plain.friction(),
            viscous: plain.damping(),
        },
        seconds: 0.0,
    };
    Ok(Case {
        id: id.to_owned(),
        urdf: to_urdf(&nominal.robot()?),
        train,
        test,
        truth,
    })
}
