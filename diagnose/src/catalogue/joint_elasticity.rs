//! `joint_elasticity`: a compliant transmission, q being the motor side. The link stands at q_link = q − T/K, T being
//! the torque through the spring, which is the rigid torque of the link's own motion: two fixed-point
//! steps, the rigid model linearised there, gravity gradient and the neighbours' torques included; or, where the link
//! oscillates, by [`super::transmission`].
//! Confounders: backlash (odd in T but flat), delay (first derivative), rotor and link inertia.

use super::candidate::{Bound, Candidate, Column, Quantity};
use super::effect::Effect;
use super::info::{Carried, Info, Need};
use super::reported::{Parameter, size};
use super::transmission::Spring;
use super::unit::Unit;
use crate::motion::motor::Band;
use crate::motion::scene::Scene;
use ndarray::{Array1, Array2};

/// Description of `joint_elasticity`: confounders, needs, remedy, rules.
pub(super) const INFO: Info = Info {
    name: "joint_elasticity",
    plain: "elasticity of the transmission",
    confounders: &[Effect::Backlash, Effect::TimeDelay, Effect::RotorInertia],
    vibrates: true,
    place: Some("comment in the MJCF"),
    by_hand: second_joint,
    needs: &[Need::Rate],
    remedy: "split the joint into motor and link with a spring ({})",
    gear: true,
    carried: |_| Carried::Not,
    unwritten: "needs a joint of its own between rotor and link, which is not written",
    reported: stiffness,
    ..Info::NEW
};

/// Joint of the spring, to be added to an MJCF.
fn second_joint(joints: &[String], parameters: &[Parameter]) -> Option<String> {
    let (joint, (stiffness, _)) = (joints.first()?, size(parameters, "stiffness")?);
    Some(format!(
        "at {joint}: a second joint between rotor and link, stiffness=\"{stiffness}\""
    ))
}

/// Natural frequencies of the joint against the rigid arm that are tried, Hz.
const FREQUENCIES: [f64; 4] = [4.5, 7.5, 12.0, 20.0];
/// Time constants of the spring torque's smoothing before it is differentiated twice, s. Noise of the
/// acceleration grows with the square of the frequency; the wind-up of a motion does not.
pub(super) const ROUNDING: [f64; 2] = [0.01, 0.025];

/// Natural frequencies of the oscillating link that are tried, Hz, and damping ratios.
const RESONANCES: [f64; 7] = [3.5, 5.0, 7.0, 9.5, 13.0, 18.0, 25.0];
const DAMPING: [f64; 2] = [0.06, 0.2];
/// Parts of the joint's inertia that turn with the motor.
const ROTORS: [f64; 2] = [0.0, 0.45];

pub(super) fn candidates(scene: &Scene, joint: usize) -> Vec<Candidate> {
    let inertia = own_inertia(scene, joint);
    let single = |stiffness: f64, rotor: f64, bound, column| {
        let compliance = Quantity::scaled(
            "compliance",
            Unit::RadPerNewtonMetre,
            Some(joint),
            1.0 / stiffness,
        );
        let one = Candidate::single(Effect::JointElasticity, joint, compliance, bound, column);
        one.with_shape("rotor_share", rotor, Unit::One)
    };
    // Of what the spring moves.
    let stiffness = |frequency: f64, rotor: f64| {
        (1.0 - rotor) * inertia * (std::f64::consts::TAU * frequency).powi(2)
    };
    let mut all = Vec::new();
    for rotor in ROTORS {
        for frequency in FREQUENCIES {
            for rounding in ROUNDING {
                let stiffness = stiffness(frequency, rotor);
                let column = Column::whole(scene.dof(), move |s| {
                    compliant(s, joint, 1.0 / stiffness, rotor, rounding)
                });
                // The column is nearly proportional to 1/K: the coefficient corrects the compliance.
                let bound = Bound::Between(0.1, 2.5);
                all.push(single(stiffness, rotor, bound, column));
            }
        }
        for frequency in RESONANCES {
            for damping in DAMPING {
                let spring = Spring {
                    frequency,
                    damping,
                    rotor,
                    half_play: 0.0,
                };
                let column = Column::whole(scene.dof(), move |s| spring.change(s, joint));
                let bound = Bound::Between(0.5, 2.0);
                all.push(single(stiffness(frequency, rotor), rotor, bound, column));
            }
        }
    }
    all
}

/// Change of the rigid torque by a transmission of the given compliance, rad/(N·m), shape (samples, joints).
/// The part `rotor` of the joint's inertia turns with the motor.
pub(super) fn compliant(
    scene: &Scene,
    joint: usize,
    compliance: f64,
    rotor: f64,
    rounding: f64,
) -> Array2<f64> {
    let own = rotor * own_inertia(scene, joint);
    let mut carried = scene.rigid.column(joint).to_owned();
    carried.scaled_add(-own, &scene.motion.qdd.column(joint));
    // The rotor stays with the motor.
    let departure = |spring: &Array1<f64>| {
        let dq = spring * -compliance;
        let mut change = scene.departure(joint, &dq);
        let acceleration = scene.derivative(&scene.derivative(&dq));
        change.column_mut(joint).scaled_add(-own, &acceleration);
        change
    };
    let rigid = scene.rounded(&carried, rounding);
    let first = departure(&rigid);
    let spring = rigid + scene.rounded(&first.column(joint).to_owned(), rounding);
    departure(&spring)
}

/// Mean inertia that the joint turns, kg·m².
pub(super) fn own_inertia(scene: &Scene, joint: usize) -> f64 {
    scene.inertia(joint, Band::Motion).max(1e-9)
}

/// Converts compliance into stiffness.
fn stiffness(parameters: &mut Vec<Parameter>) {
    let compliances = parameters.iter_mut();
    for p in compliances.filter(|p| p.name == "compliance" && p.value > 0.0) {
        p.name = "stiffness".to_owned();
        p.std = p.std.map(|s| s / (p.value * p.value));
        p.value = 1.0 / p.value;
        p.unit = Unit::NewtonMetrePerRad;
    }
    parameters.retain(|p| p.name != "share");
}
