//! `joint_coupling`: another joint's motion drives this joint's transmission. A sparse screen over pairs, one
//! column each: the driver's velocity, direction, acceleration or position, and the direction of both motions
//! combined. Confounders: Coriolis and inertial coupling (all base parameters), kinematic errors.

use super::candidate::{Bound, Candidate, Column, Quantity};
use super::effect::Effect;
use super::info::Info;
use super::unit::Unit;
use crate::motion::scene::{SOFT_SIGN, Scene};
use physics::effects::{Coupling, Sliding, Term};

/// Description of `joint_coupling`: confounders, rules.
pub(super) const INFO: Info = Info {
    name: "joint_coupling",
    plain: "coupling to another joint",
    confounders: &[Effect::FrictionParameters, Effect::LinkParameters],
    least_fraction: 0.06,
    coded: true,
    ..Info::NEW
};

/// Ratios of driver to driven motion in a shared transmission that are tried.
const RATIOS: [f64; 10] = [-4.0, -2.0, -1.0, -0.5, -0.25, 0.25, 0.5, 1.0, 2.0, 4.0];

pub(super) fn candidates(scene: &Scene, driven: usize) -> Vec<Candidate> {
    let mut all = Vec::new();
    for driver in (0..scene.dof()).filter(|&d| d != driven) {
        let new = |name, unit, column| {
            let quantity = Quantity::plain(name, unit, Some(driven));
            let mut c =
                Candidate::single(Effect::JointCoupling, driven, quantity, Bound::Free, column);
            c.driver = Some(driver);
            c
        };
        let (low, high) = scene.scale.range[driver];
        let middle = (low + high) / 2.0;
        let column = |coupling| Column::term(driven, Term::Coupling(coupling));
        let friction = |shape| column(Coupling::Friction { driver, shape });
        let qd = friction(Sliding::Viscous);
        let sign = friction(scene.coulomb(driver));
        let qdd = column(Coupling::Inertia { driver });
        let q = column(Coupling::Spring { driver, middle });
        all.push(new("viscous", Unit::NewtonMetreSecondPerRad, qd));
        all.push(new("coulomb", Unit::NewtonMetre, sign));
        all.push(new("inertia", Unit::KilogramMetre2, qdd));
        all.push(new("stiffness", Unit::NewtonMetrePerRad, q));
        for ratio in RATIOS {
            // Friction of what both motions turn together.
            let relative = column(Coupling::Relative {
                driver,
                ratio,
                velocity: SOFT_SIGN,
            });
            all.push(new("coulomb", Unit::NewtonMetre, relative).with_shape(
                "ratio",
                ratio,
                Unit::One,
            ));
        }
    }
    all
}
