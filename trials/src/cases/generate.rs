//! Making a case.

use super::again::Again;
use super::case::Case;
use super::experiment::{Chosen, Experiment, Run, together};
use super::hard;
use super::kind::{CaseSpec, Kind};
use super::nearly::nearly;
use super::oracle::oracle;
use super::rehearsal::Rehearsal;
use super::sensors::{Sensors, link_and_warmth};
use super::size::{ROUNDS, Sized, column_rms, shares, sized, without_vibration};
use super::truth::Truth;
use super::witness::{Around, Telling, TorqueLog, Witness, drawn};
use crate::SimulateError;
use crate::effects::{EFFECTS, Effect, Scene, Shape};
use crate::lag::Lag;
use physics::robot::{RobotError, to_urdf};
use plant::arm::Arm;
use plant::families::relative;
use plant::measure::{Errors, record};
use plant::random::log_uniform;
use plant::reference::{Moves, Multisine, Pace, Segment, Session};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use sha2::{Digest, Sha256};
use std::f64::consts::TAU;
use std::time::Instant;

/// Rate of the recordings, Hz.
const RATE: f64 = 250.0;
/// Trajectories, their length and distance, s.
const TRAJECTORIES: usize = 12;
const LENGTH: f64 = 15.0;
const GAP: f64 = 2.0;
/// Every third trajectory is held out.
const HELD_OUT: [usize; 4] = [2, 5, 8, 11];
/// Largest number of attempts at a case; about one in ten draws does not suit its effect.
const ATTEMPTS: u64 = 200;

/// Random key of a case, from the seed, its index, and whether it is hard.
pub(super) fn key(spec: &CaseSpec, seed: u64) -> [u8; 32] {
    let mut key = Sha256::new();
    key.update(if spec.hard {
        &b"residyn hard case"[..]
    } else {
        b"residyn case"
    });
    key.update(seed.to_le_bytes());
    key.update(spec.index.to_le_bytes());
    key.finalize().into()
}

/// Name of the case that [`generate`] makes: ten hexadecimal digits.
pub fn name(spec: &CaseSpec, seed: u64) -> String {
    let key = key(spec, seed);
    key[..5].iter().map(|b| format!("{b:02x}")).collect()
}

/// Makes the case. The same specification and seed give the same case.
///
/// # Errors
/// No robot suited the case in 200 draws.
pub fn generate(spec: &CaseSpec, seed: u64) -> Result<Case, SimulateError> {
    generate_with(spec, seed, Sensors::default())
}

/// A case with recordings of further sensors; all else of it is unchanged.
///
/// # Errors
/// As [`generate`].
pub fn generate_with(spec: &CaseSpec, seed: u64, sensors: Sensors) -> Result<Case, SimulateError> {
    make(spec, seed, sensors).map(|(case, _)| case)
}

/// A case with what an observer may be told of it.
///
/// # Errors
/// As [`generate`].
pub fn witnessed(spec: &CaseSpec, seed: u64) -> Result<(Case, Witness), SimulateError> {
    let (case, telling) = make(spec, seed, Sensors::default())?;
    Ok((case, telling.witness()?))
}

fn make(spec: &CaseSpec, seed: u64, sensors: Sensors) -> Result<(Case, Telling), SimulateError> {
    let begun = Instant::now();
    let (key, id) = (key(spec, seed), name(spec, seed));
    let again = Again::draw(spec, key);
    for attempt in 0..ATTEMPTS {
        let mut rng = ChaCha8Rng::from_seed(key);
        rng.set_stream(attempt);
        let case = if spec.hard {
            hard::attempt(spec.kind, &id, again, &mut rng)
        } else {
            attempt_case(spec, &id, again, &mut rng)
        };
        // A rotor that its joint's link has no room for suits no gear.
        let case = match case {
            Err(SimulateError::Robot(_)) => None,
            case => case?,
        };
        if let Some((mut case, telling)) = case {
            case.truth.seed = [seed, spec.index, attempt];
            case.truth.generator = spec.generator;
            case.truth.repeats = again.is_some();
            case.truth.seconds = begun.elapsed().as_secs_f64();
            sensors.record(&mut case, key);
            return Ok((case, telling));
        }
    }
    Err(SimulateError::NoCase {
        kind: spec.kind.name(),
        index: spec.index,
    })
}

fn attempt_case(
    spec: &CaseSpec,
    id: &str,
    again: Option<Again>,
    rng: &mut ChaCha8Rng,
) -> Result<Option<(Case, Telling)>, SimulateError> {
    let nominal = relative(rng);
    let plain = nearly(&nominal, rng);
    let n = nominal.dof();
    let session = session(&nominal, again, rng);
    let rehearsal = Rehearsal::new(&plain, &session)?;
    let inertia = plain.inertia()?;
    let scene = Scene {
        arm: &plain,
        session: &session,
        demand: &rehearsal.demand,
        inertia: &inertia,
    };
    let Some(mut withheld) = effects(spec, &scene, &rehearsal, rng)? else {
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
    let bare = Experiment {
        nominal: &nominal,
        plain: &plain,
        withheld: &[],
        background: &[],
        session: &session,
        errors: &errors,
        bandwidth,
        rate: RATE,
    };
    // Sizes of effects that change the motion itself are only guessed; correct them on what came out.
    for round in 0..ROUNDS {
        let experiment = Experiment {
            withheld: &withheld,
            ..bare
        };
        let Some(run) = experiment.run(control_rng.clone())? else {
            return Ok(None);
        };
        let found = experiment.effect_torques(&run)?;
        let found = without_vibration(found, &withheld, &run, RATE);
        let shares = shares(&withheld, &found, &run);
        match sized(&mut withheld, &shares, round) {
            Sized::Again => continue,
            Sized::Unsuited => return Ok(None),
            Sized::Well => {}
        }
        let experiment = Experiment {
            withheld: &withheld,
            ..bare
        };
        return finish(spec.kind, id, &experiment, run, &found, rng).map(Some);
    }
    Ok(None)
}

/// Draws the effects of a case; none if the arm has no place for them.
fn effects(
    spec: &CaseSpec,
    scene: &Scene,
    rehearsal: &Rehearsal,
    rng: &mut ChaCha8Rng,
) -> Result<Option<Vec<Chosen>>, RobotError> {
    let listed: Vec<usize> = (0..EFFECTS.len())
        .filter(|e| Some(*e) != spec.without)
        .collect();
    let mut any = || Effect::listed(listed[rng.random_range(0..listed.len())]);
    let drawn = match spec.kind {
        Kind::None => vec![],
        Kind::Single(e) => vec![Effect::listed(e)],
        Kind::Outside => vec![Effect::OUTSIDE],
        Kind::Two => vec![any(), any()],
        // Only hard cases have these.
        Kind::TwoOfOneJoint | Kind::ContactAtRest => return Ok(None),
    };
    let mut chosen: Vec<Chosen> = Vec::new();
    for one in drawn {
        let Some(Shape {
            effect,
            joint,
            share,
            source,
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
            source,
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

fn session(arm: &Arm, again: Option<Again>, rng: &mut ChaCha8Rng) -> Session {
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
    let mut trajectories: Vec<(Segment, f64)> = trajectories.collect();
    if let Some(again) = again {
        let fitted = (0..TRAJECTORIES).filter(|i| !HELD_OUT.contains(i));
        again.repeat(&mut trajectories, &fitted.collect::<Vec<_>>());
    }
    Session::new(trajectories, GAP, arm.dof())
}

/// The files and the answer. `found` are the torques of the effects in `run`.
fn finish(
    kind: Kind,
    id: &str,
    experiment: &Experiment,
    run: Run,
    found: &[Vec<f64>],
    rng: &mut ChaCha8Rng,
) -> Result<(Case, Telling), SimulateError> {
    let (nominal, trace) = (experiment.nominal, &run.trace);
    let n = nominal.dof();
    let torque_rms = column_rms(&run.noted, n);
    let shares = experiment.errors.torque.iter().zip(&torque_rms);
    let scaled = Errors {
        torque: shares.map(|(e, t)| e * t).collect(),
        ..experiment.errors.clone()
    };
    let (mut recording, noise) = record(trace, &run.noted, &scaled, rng);
    link_and_warmth(trace, experiment.plain, &mut recording);
    let (train, test) = recording.split(&HELD_OUT);
    let held_out = |table: &[f64]| -> Vec<f64> {
        let bounds = trace.bounds();
        HELD_OUT
            .iter()
            .flat_map(|&i| table[bounds[i] * n..bounds[i + 1] * n].to_vec())
            .collect()
    };
    let vibrates = experiment.withheld.iter().any(|w| w.effect.vibrates());
    let oracle = oracle(
        nominal,
        experiment.plain,
        &test,
        RATE,
        &held_out(&together(found)),
        vibrates,
        &held_out(&noise),
    )?;
    let case = Case {
        id: id.to_owned(),
        urdf: to_urdf(&nominal.robot()?),
        train,
        test,
        truth: Truth::of(kind, id, experiment, &run, found, &noise, oracle)?,
    };
    let log = TorqueLog {
        torque: run.noted.iter().zip(&noise).map(|(t, e)| t + e).collect(),
        rms: torque_rms,
        bounds: trace.bounds(),
        tick: 1.0 / RATE,
        every: 1,
        lag: vec![Lag::None; n],
        noise: scaled.torque,
        colour: 0.0,
        quantum: vec![0.0; n],
        outlier: vec![false; noise.len()],
        bias: None,
    };
    let telling = Telling {
        nominal: nominal.clone(),
        plain: experiment.plain.clone(),
        session: experiment.session.clone(),
        log,
        background: Vec::new(),
        withheld: drawn(experiment.withheld),
        around: Around::Nearly,
        rests: Vec::new(),
        trace: run.trace,
    };
    Ok((case, telling))
}
