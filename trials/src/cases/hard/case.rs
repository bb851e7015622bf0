//! Making a hard case.

use super::background::Settled;
use super::motion::{Day, Role};
use super::robot::Drawn;
use super::truth::{Bias, HardTruth, LowPass, NamedShare};
use super::{TRACE_HZ, background, channel, motion, robot, sensors};
use crate::SimulateError;
use crate::cases::case::Case;
use crate::cases::experiment::{Chosen, Experiment, Run, beyond};
use crate::cases::kind::Kind;
use crate::cases::oracle::{Oracle, oracle, unabsorbed};
use crate::cases::rehearsal::Rehearsal;
use crate::cases::size::{self, ROUNDS, Sized, column_rms, sized, without_vibration};
use crate::cases::truth::{PlantTruth, Truth, truth_effect};
use crate::effects::{EFFECTS, Effect, Scene, Shape, joint_name, pushes_at_rest};
use datasets::Recording;
use physics::robot::{RobotError, to_urdf};
use plant::arm::Arm;
use plant::families::relative;
use plant::measure::{Errors, record};
use plant::random::log_uniform;
use plant::run::Trace;
use rand::seq::IndexedRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;
use std::ops::Range;

/// Effects of which two can be on one joint.
const OF_A_GEAR: [&str; 8] = [
    "asymmetric_friction",
    "stribeck_friction",
    "nonlinear_viscous_friction",
    "load_dependent_friction",
    "position_dependent_friction",
    "presliding_hysteresis",
    "friction_drift",
    "torque_ripple",
];
/// Draws until two effects meet on one joint.
const MEETINGS: usize = 80;
/// Further rounds for the background.
const MORE: usize = 2;
/// Shortest rest in which somebody pushes, s.
const REST: f64 = 0.8;

/// A case, or none where this draw does not suit its kind.
pub fn attempt(kind: Kind, id: &str, rng: &mut ChaCha8Rng) -> Result<Option<Case>, SimulateError> {
    let nominal = relative(rng);
    let drawn = robot::draw(&nominal, rng);
    let n = nominal.dof();
    // Touches are set on one clock.
    let touched = kind.name() == "external_contact" || kind == Kind::ContactAtRest;
    let other_day = rng.random_bool(0.3) && !touched && kind != Kind::Outside;
    let days = motion::draw(&nominal, kind == Kind::ContactAtRest, other_day, rng);
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
    for round in 0..ROUNDS + MORE {
        let experiment = Experiment {
            nominal: &nominal,
            plain: &drawn.plain,
            withheld: &withheld,
            background: &background,
            session: &days[0].session,
            errors: &errors,
            bandwidth,
            rate: TRACE_HZ,
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
            nominal: &nominal,
            drawn: &drawn,
            days: &days,
            withheld: &withheld,
            background: &background,
            errors: &errors,
            bandwidth,
            pushed,
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
        });
    }
    Ok(Some(chosen))
}

/// Two different effects on one joint; the last is one whose torque the simulation notes by itself.
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

/// A robot that has been recorded, on its way into files.
struct Recorded<'a> {
    kind: Kind,
    id: &'a str,
    nominal: &'a Arm,
    drawn: &'a Drawn,
    days: &'a [Day],
    withheld: &'a [Chosen],
    background: &'a [Chosen],
    errors: &'a Errors,
    bandwidth: f64,
    pushed: Role,
}

impl Recorded<'_> {
    /// The files and the answer. `first` is the run of the first day, `found` and `background` the torques of effects in it.
    fn finish(
        &self,
        first: Run,
        found: &[Vec<f64>],
        background: &[Vec<f64>],
        rng: &mut ChaCha8Rng,
    ) -> Result<Option<Case>, SimulateError> {
        let n = self.nominal.dof();
        let torque_rms = column_rms(&first.noted, n);
        let channel = channel::draw(&torque_rms, rng);
        let log = sensors::draw(rng);
        let first_log = channel.log(&first.noted, &first.trace.bounds(), rng);
        let day = &self.days[0];
        let rows = day.rows(&first.trace.bounds(), Role::Train);
        let train = log.record(&first.trace, &first_log.recorded, self.errors, &rows, rng);
        // Another day is another run of the same robot.
        let later = match self.days.get(1) {
            None => None,
            Some(later) => {
                let plain = robot::another_day(&self.drawn.plain, rng);
                let Some(run) = self.run_again(&plain, later, ChaCha8Rng::from_rng(rng))? else {
                    return Ok(None);
                };
                let logged = channel.log(&run.noted, &run.trace.bounds(), rng);
                Some((plain, later, run, logged))
            }
        };
        let (plain, day, run, logged) = match &later {
            None => (&self.drawn.plain, day, &first, &first_log),
            Some((plain, day, run, logged)) => (plain, *day, run, logged),
        };
        let rows = day.rows(&run.trace.bounds(), Role::Test);
        let test = log.record(&run.trace, &logged.recorded, self.errors, &rows, rng);
        let best = self.oracle(plain, run, logged, &rows, rng)?;
        let noise: Vec<f64> = first_log
            .recorded
            .iter()
            .zip(&first_log.clean)
            .map(|(r, c)| r - c)
            .collect();
        let noise_rms = column_rms(&noise, n);
        let mut all = found[0].clone();
        for more in &found[1..] {
            all.iter_mut().zip(more).for_each(|(a, m)| *a += m);
        }
        let mut parts = vec![all];
        if self.withheld.len() > 1 {
            parts.extend(found.iter().cloned());
        }
        let trace = &first.trace;
        let real = &self.drawn.plain;
        let left = unabsorbed(real, &trace.q, &trace.qd, &trace.qdd, &noise_rms, &parts)?;
        let effects = self.withheld.iter().enumerate().map(|(i, w)| {
            let own = if self.withheld.len() > 1 { i + 1 } else { 0 };
            let strength = column_rms(&parts[own], n);
            truth_effect(w, &strength, &left[own], &torque_rms, &noise_rms)
        });
        let truth = Truth {
            case: self.id.to_owned(),
            kind: self.kind.name().to_owned(),
            robot: self.nominal.family.to_owned(),
            seed: [0; 3],
            joints: n,
            effects: effects.collect(),
            effect_rms: column_rms(&parts[0], n),
            unabsorbed_rms: left[0].clone(),
            noise_rms,
            v_eps: real.v_eps.clone(),
            oracle: best,
            plant: PlantTruth::of(real),
            seconds: 0.0,
            hard: Some(self.besides(&channel, &log, background, &torque_rms)),
            torque_rms,
        };
        Ok(Some(Case {
            id: self.id.to_owned(),
            urdf: to_urdf(&self.drawn.given.robot()?),
            train,
            test,
            truth,
        }))
    }

    /// The run of another day.
    fn run_again(
        &self,
        plain: &Arm,
        day: &Day,
        rng: ChaCha8Rng,
    ) -> Result<Option<Run>, RobotError> {
        Experiment {
            nominal: self.nominal,
            plain,
            withheld: self.withheld,
            background: self.background,
            session: &day.session,
            errors: self.errors,
            bandwidth: self.bandwidth,
            rate: TRACE_HZ,
        }
        .run(rng)
    }

    /// The best that can be had on the held-out rows, sampled evenly: the true plant with all that the channel does but noise.
    fn oracle(
        &self,
        plain: &Arm,
        run: &Run,
        logged: &channel::Logged,
        rows: &[Range<usize>],
        rng: &mut ChaCha8Rng,
    ) -> Result<Oracle, SimulateError> {
        let n = run.trace.dof;
        let cut = |table: &[f64]| -> Vec<f64> {
            let spans = rows.iter().map(|r| &table[r.start * n..r.end * n]);
            spans.flatten().copied().collect()
        };
        let held_out = Trace {
            dof: n,
            time: rows
                .iter()
                .flat_map(|r| run.trace.time[r.clone()].to_vec())
                .collect(),
            lengths: rows.iter().map(Range::len).collect(),
            q: cut(&run.trace.q),
            qd: cut(&run.trace.qd),
            ..Trace::default()
        };
        let (even, _): (Recording, _) = record(&held_out, &cut(&logged.recorded), self.errors, rng);
        let effect = cut(&beyond(plain, &run.trace, &logged.clean)?);
        let noise: Vec<f64> = cut(&logged.recorded)
            .iter()
            .zip(cut(&logged.clean))
            .map(|(r, c)| r - c)
            .collect();
        let vibrates = self.withheld.iter().any(|w| w.effect.vibrates());
        oracle(
            &self.drawn.given,
            plain,
            &even,
            TRACE_HZ,
            &effect,
            vibrates,
            &noise,
        )
    }

    /// What was drawn beside robot and effect.
    fn besides(
        &self,
        channel: &channel::Channel,
        log: &sensors::Log,
        background: &[Vec<f64>],
        torque_rms: &[f64],
    ) -> HardTruth {
        let n = torque_rms.len();
        let count = |role: Role| {
            let roles = self.days.iter().flat_map(|d| &d.roles);
            roles.filter(|r| **r == role).count()
        };
        let at_rest = (self.kind == Kind::ContactAtRest).then_some(match self.pushed {
            Role::Train => "train",
            Role::Test => "heldout",
        });
        HardTruth {
            inertial_width: self.drawn.inertial_width,
            friction_width: self.drawn.friction_width,
            no_friction: self
                .drawn
                .no_friction
                .iter()
                .map(|&j| joint_name(j))
                .collect(),
            rest: format!("{:?}", self.drawn.plain.rest).to_lowercase(),
            train: count(Role::Train),
            test: count(Role::Test),
            duration: self.days[0].session.lengths[0],
            rate: log.rate,
            jitter: log.jitter.name(),
            velocity: log.velocity,
            other_day: self.days.len() > 1,
            contact: at_rest,
            lowpass: LowPass {
                same: channel.same,
                lag_ms: channel.lateness().iter().map(|s| 1e3 * s).collect(),
            },
            bias: Bias {
                joint: joint_name(channel.bias.0),
                share: channel.bias.1 / torque_rms[channel.bias.0],
            },
            outliers: channel.outliers,
            background: self
                .background
                .iter()
                .zip(background)
                .map(|(b, torque)| NamedShare {
                    effect: b.name,
                    joint: joint_name(b.at),
                    share: column_rms(torque, n)[b.at] / torque_rms[b.at],
                })
                .collect(),
        }
    }
}
