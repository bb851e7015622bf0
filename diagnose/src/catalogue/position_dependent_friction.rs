//! `position_dependent_friction`: friction scaled periodically by the joint's position, as a bent shaft, an eccentric gear
//! or a seal that is not round make it: sin(k q) and cos(k q) times the sign of the velocity, or times sign and velocity. Orders
//! are whole turns of the joint, and lines of what is left over position once it is turned with the motion (motor and
//! gear stages turn at ratios that need not be whole). Confounders: Coulomb friction (over less than half a period),
//! load-dependent friction (gravity's load is periodic in position), torque ripple (which does not turn with the motion).

use super::candidate::{Bound, Candidate, Column, Quantity};
use super::effect::Effect;
use super::experiment::Experiment;
use super::info::{Info, Need};
use super::unit::Unit;
use crate::motion::scene::Scene;
use physics::effects::{FrictionShape, Harmonic, Phase, PositionFriction, Sliding, Term};
use std::f64::consts::TAU;

/// Description of `position_dependent_friction`: confounders, needs, experiment, rules.
pub(super) const INFO: Info = Info {
    name: "position_dependent_friction",
    plain: "friction that changes with position",
    confounders: &[
        Effect::FrictionParameters,
        Effect::LoadDependentFriction,
        Effect::TorqueRipple,
    ],
    friction: true,
    least_fraction: 0.06,
    needs: &[Need::Reversals, Need::Range, Need::Minute],
    coded: true,
    experiment: Experiment::WholeRange,
    ..Info::NEW
};

/// Largest number of lines of one joint that are tried.
pub const LINES: usize = 2;

/// Whole orders that are tried, periods per turn.
const WHOLE: [f64; 6] = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
/// Fewest cycles over the recorded range: with fewer the friction is about constant.
const FEWEST_CYCLES: f64 = 0.4;
/// Difference in cycles over the range below which two orders count as one.
const SAME: f64 = 0.25;

/// Candidates of a joint at whole orders and at the orders `lines`, 1/rad (1/m).
pub fn candidates(scene: &Scene, joint: usize, lines: &[f64]) -> Vec<Candidate> {
    let (low, high) = scene.scale.range[joint];
    let cycles = |order: f64| order * (high - low) / TAU;
    let whole = WHOLE.into_iter().filter(|&k| {
        scene.robot.joints()[joint].kind.is_rotation()
            && cycles(k) > FEWEST_CYCLES
            && lines.iter().all(|l| cycles((l - k).abs()) > SAME)
    });
    let orders = whole.chain(lines.iter().copied());
    orders.flat_map(|order| at(scene, joint, order)).collect()
}

/// Candidates at one order: Coulomb friction alone, and Coulomb with viscous friction.
fn at(scene: &Scene, joint: usize, order: f64) -> [Candidate; 2] {
    let column = |phase, friction| {
        let term = PositionFriction {
            harmonic: Harmonic { order, phase },
            friction: FrictionShape::Sliding(friction),
        };
        Column::term(joint, Term::Position(term))
    };
    let sign = scene.coulomb(joint);
    let coulomb = |name| Quantity::plain(name, Unit::NewtonMetre, Some(joint));
    let viscous = |name| Quantity::plain(name, Unit::NewtonMetreSecondPerRad, Some(joint));
    let alone = || {
        let first = coulomb("coulomb_sine");
        let effect = Effect::PositionDependentFriction;
        let (sine, cosine) = (column(Phase::Sin, sign), column(Phase::Cos, sign));
        Candidate::single(effect, joint, first, Bound::Free, sine)
            .and(coulomb("coulomb_cosine"), Bound::Free, cosine)
            .with_shape("order", order, Unit::PerRad)
    };
    let speed = Sliding::Viscous;
    let both = alone()
        .and(
            viscous("viscous_sine"),
            Bound::Free,
            column(Phase::Sin, speed),
        )
        .and(
            viscous("viscous_cosine"),
            Bound::Free,
            column(Phase::Cos, speed),
        );
    [alone(), both]
}
