//! `time_delay`: torque and motion recorded with a shift in time, τ(t) = τ̂(t − delay), by interpolation of the whole
//! prediction, friction jumps included. All joints share it, but for a joint whose current is filtered more or less than the
//! others'. A current's filter makes it late, too: a first-order lag, which rounds the friction jumps. Confounders: presliding
//! (reversals only), elasticity (second derivative), viscous friction of the acceleration.

use super::candidate::{Bound, Candidate, Column, Quantity, Shape};
use super::effect::Effect;
use super::info::{Carried, Info};
use super::reported::{Parameter, size};
use super::unit::Unit;
use crate::motion::channel::Channel;
use crate::motion::delay::Late;
use crate::motion::scene::Scene;
use ndarray::Array1;

/// Name of a low-pass's shape parameter: its corner frequency, Hz.
const CORNER: &str = "corner";

/// Description of `time_delay`: confounders, remedy, rules.
pub(super) const INFO: Info = Info {
    name: "time_delay",
    plain: "a time shift between torque and motion",
    confounders: &[
        Effect::JointElasticity,
        Effect::Backlash,
        Effect::PreslidingHysteresis,
    ],
    place: Some("comment in the MJCF"),
    by_hand: of_actuators,
    remedy: "shift the torque in the recording, or delay the actuator ({})",
    late: true,
    carried: |_| Carried::Delay,
    ..Info::NEW
};

/// Delay of one joint's actuator, or of every actuator, to be set in an MJCF.
fn of_actuators(joints: &[String], parameters: &[Parameter]) -> Option<String> {
    let (delay, _) = size(parameters, "delay")?;
    let whose = match joints {
        [joint] => format!("actuator of {joint}"),
        _ => "every actuator".to_owned(),
    };
    Some(format!(
        "{whose}: delay=\"{delay}\" and nsample, at least delay / timestep (MuJoCo 4)"
    ))
}

/// Delays of all joints that are tried, in sampling intervals; the coefficient interpolates between them.
const DELAYS: [f64; 12] = [
    -12.0, -6.0, -3.0, -1.5, -0.75, 0.75, 1.5, 3.0, 5.0, 8.0, 12.0, 18.0,
];

/// Delays of a single joint beside the common one that are tried, in sampling intervals.
const OWN: [f64; 7] = [-4.0, -2.0, -1.0, 1.0, 2.0, 4.0, 8.0];
/// Time constants of a filter that are tried, in sampling intervals.
const LAGS: [f64; 4] = [0.75, 1.5, 3.0, 6.0];

/// Parts of a known delay that are tried as a filter's, the remainder being a shift.
const PARTS: [f64; 4] = [0.0, 0.35, 0.7, 1.0];
/// Factors on a known delay with which the delay is tried again.
const FACTORS: [f64; 5] = [0.7, 0.85, 1.0, 1.2, 1.45];

/// Candidates of a delay of all joints.
pub(super) fn candidates(scene: &Scene) -> Vec<Candidate> {
    all(scene, (0..scene.dof()).collect(), &DELAYS, false)
}

/// Candidates of a delay of one joint alone.
pub(super) fn own(scene: &Scene, joint: usize) -> Vec<Candidate> {
    if scene.dof() > 1 {
        all(scene, vec![joint], &OWN, true)
    } else {
        Vec::new()
    }
}

/// Changes of a joint's torque by shifts of about one interval or several, and by filters: a basis of any delay of that joint.
pub fn changes(scene: &Scene, joint: usize) -> Vec<Array1<f64>> {
    let step = scene.scale.step;
    let shifts = [-3.0, -1.0, 1.0, 3.0, 6.0].map(|s| Late::shifted(s * step));
    let filters = [1.5, 4.0].map(|s| Late::filtered(s * step));
    let each = shifts.into_iter().chain(filters);
    each.map(|late| {
        let own = &scene.rigid.column(joint) + &scene.drive.column(joint);
        late.of(scene.motion, own.view()) - own
    })
    .collect()
}

/// Change of a joint's torque by the delay `late` of all of it, or with `alone` beside the delay common to all
/// joints. Torque that other columns add to the model as given is delayed already where a delay is known; this
/// is the remaining change.
fn change(scene: &Scene, joint: usize, late: Late, alone: bool) -> Array1<f64> {
    let mut all = &scene.rigid.column(joint) + &scene.drive.column(joint);
    let (Some(channel), Some(given)) = (&scene.scale.channel, &scene.given) else {
        return late.of(scene.motion, all.view()) - all;
    };
    let mut added = &all - &given.column(joint);
    let mut known = channel.whole;
    if alone {
        all = channel.all(scene.motion, all.view());
        added = channel.all(scene.motion, added.view());
        known = channel.own[joint];
    }
    let known = known.map(|known| known.of(scene.motion, added.view()) - added);
    let change = late.of(scene.motion, all.view()) - all;
    known.map_or_else(|| change.clone(), |known| &change - &known)
}

/// Candidates of delays of the joints, common to all, or with `alone` of one beside the common one.
fn all(scene: &Scene, joints: Vec<usize>, shifts: &[f64], alone: bool) -> Vec<Candidate> {
    let of = |c: &Channel| if alone { c.own[joints[0]] } else { c.whole };
    let known = scene.scale.channel.as_deref().and_then(of);
    let late: Vec<Late> = match known {
        None => {
            let step = scene.scale.step;
            let shifts = shifts.iter().map(|s| Late::shifted(s * step));
            let filters = LAGS.iter().map(|s| Late::filtered(s * step));
            shifts.chain(filters).collect()
        }
        Some(known) if known.delay() <= 0.0 => FACTORS.map(|f| known.times(f)).to_vec(),
        Some(known) => {
            let parts = PARTS.map(|part| Late {
                shift: (1.0 - part) * known.delay(),
                constant: part * known.delay(),
            });
            let near = parts.iter().flat_map(|p| FACTORS.map(|f| p.times(f)));
            near.chain([known]).collect()
        }
    };
    late.into_iter()
        .map(|late| candidate(joints.clone(), late, alone))
        .collect()
}

fn candidate(joints: Vec<usize>, late: Late, alone: bool) -> Candidate {
    let of = joints.clone();
    let column = Column::several(joints.clone(), move |s| {
        of.iter().map(|&j| change(s, j, late, alone)).collect()
    });
    let corner = 1.0 / (std::f64::consts::TAU * late.constant);
    let corner = (late.constant > 0.0).then_some(Shape::new(CORNER, corner, Unit::Hertz));
    let joint = joints.first().copied().filter(|_| joints.len() == 1);
    Candidate {
        effect: Effect::TimeDelay,
        joints,
        driver: None,
        columns: vec![column.late_already()],
        bounds: vec![Bound::Between(0.6, 1.6)],
        quantities: vec![Quantity::scaled("delay", Unit::Second, joint, late.delay())],
        shape: corner.into_iter().collect(),
        sizes: Vec::new(),
        change: None,
        known: None,
        evidence: 0.0,
        shown: None,
    }
}

/// Delay of the recorded torque by a candidate with the coefficient `size`.
pub fn said(candidate: &Candidate, size: f64) -> Late {
    let delay = candidate.quantities[0].factor;
    let corner = candidate.shape(CORNER);
    let constant = corner.map_or(0.0, |c| 1.0 / (std::f64::consts::TAU * c));
    Late {
        shift: delay - constant,
        constant,
    }
    .times(size)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::scene::Scale;
    use ndarray::Array2;
    use physics::robot::Robot;
    use signal::Motion;
    use std::sync::Arc;

    /// What is recorded is the real robot's torque, all of it late: less the model as given, that is what the parameters
    /// change, late, and the delays of all joints and of one.
    #[test]
    fn what_is_late_adds_up() {
        let given = Robot::builtin("ur5").unwrap();
        let mut parameters = given.parameters();
        parameters.iter_mut().for_each(|p| *p *= 1.3);
        let real = given.with_parameters(&parameters).unwrap();
        let (n, dof, step) = (400, given.dof(), 0.01);
        let table = |f: &dyn Fn(f64, f64) -> f64| {
            Array2::from_shape_fn((n, dof), |(i, j)| f(step * i as f64, 2.0 + 0.3 * j as f64))
        };
        let motion = Motion {
            time: (0..n).map(|i| step * i as f64).collect(),
            q: table(&|t, w| (w * t).sin()),
            qd: table(&|t, w| w * (w * t).cos()),
            qdd: table(&|t, w| -w * w * (w * t).sin()),
            segments: vec![0..150, 150..n],
        };
        let mut beside = vec![None; dof];
        beside[2] = Some(Late::shifted(0.013));
        let channel = Channel {
            whole: Some(Late::filtered(0.02)),
            own: beside,
            given: given.clone(),
        };
        let scale = Scale {
            softness: vec![0.01; dof],
            lead: vec![0.0; dof],
            speed: vec![1.0; dof],
            range: vec![(-1.0, 1.0); dof],
            torque: vec![3.0; dof],
            session: (0.0, 4.0),
            step,
            channel: Some(Arc::new(channel.clone())),
            correlation_rows: None,
        };
        let scene = Scene::new(&real, &motion, &scale);
        let [real, given] = [&real, &given].map(|r| Scene::new(r, &motion, &scale).predicted());
        for j in 0..dof {
            let recorded = channel.recorded(&motion, j, real.column(j));
            let changed = &real.column(j) - &given.column(j);
            let mut sum = channel.recorded(&motion, j, changed.view());
            sum += &change(&scene, j, channel.whole.unwrap(), false);
            if let Some(late) = channel.own[j] {
                sum += &change(&scene, j, late, true);
            }
            let gap = &recorded - &given.column(j);
            let worst = (&sum - &gap).iter().fold(0.0f64, |m, x| m.max(x.abs()));
            assert!(worst < 1e-9, "joint {j}: {worst}");
        }
        // What was found is tried again as it was, and what is said of a candidate is what it was made of.
        let off = |c: &Candidate| (said(c, 1.0).constant - 0.02).abs() + said(c, 1.0).shift.abs();
        assert!(candidates(&scene).iter().any(|c| off(c) < 1e-9));
        assert_eq!(own(&scene, 2).len(), PARTS.len() * FACTORS.len() + 1);
    }
}
