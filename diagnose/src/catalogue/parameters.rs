//! `link_parameters`, `friction_parameters`, `payload`, `rotor_inertia`: wider freedom for
//! parameters that the model has, and the inertia of a motor that it lacks.
//!
//! The base of every fit already holds all inertial and friction parameters, tied to the given values
//! by a narrow prior. A candidate of this file fits one link's or joint's parameters a second time
//! with a wide prior, so that a change beyond a few percent is paid for once, not per sample.

use super::candidate::{Bound, Candidate, Column, ColumnTorque, Quantity};
use super::effect::Effect;
use super::experiment::Experiment;
use super::info::{Correction, Info, Need};
use super::reported::{Parameter, size};
use super::unit::Unit;
use crate::motion::scene::Scene;
use crate::simulator::link_sizes;
use nalgebra::{Rotation3, Vector3};
use physics::effects::{Sliding, Term};
use physics::robot::{Inertia, PARAMETERS_PER_LINK, Robot};
use std::f64::consts::{FRAC_PI_2, PI};

/// Description of `rotor_inertia`: confounders, needs, remedy, rules.
pub(super) const ROTOR: Info = Info {
    name: "rotor_inertia",
    plain: "rotor inertia",
    confounders: &[
        Effect::LinkParameters,
        Effect::TorqueGain,
        Effect::JointElasticity,
    ],
    absorbable: true,
    place: Some("drive file, MJCF"),
    correction: Some(Correction::Rotor),
    needs: &[Need::Speed],
    remedy: "set the joint's armature ({})",
    ..Info::NEW
};

/// Description of `payload`: confounders, remedy, experiment, rules.
pub(super) const PAYLOAD: Info = Info {
    name: "payload",
    plain: "a payload on the last link",
    confounders: &[Effect::LinkParameters],
    absorbable: true,
    place: Some("URDF"),
    correction: Some(Correction::Load),
    by_mass: true,
    remedy: "attach a body to the last link ({}); --patch writes it",
    body: true,
    experiment: Experiment::KnownMass,
    reported: centre_of_mass,
    ..Info::NEW
};

/// Description of `friction_parameters`: confounders, remedy, rules.
pub(super) const FRICTION: Info = Info {
    name: "friction_parameters",
    plain: "friction coefficients",
    confounders: &[Effect::NonlinearViscousFriction, Effect::StribeckFriction],
    parameter: true,
    friction: true,
    absorbable: true,
    place: Some("URDF"),
    correction: Some(Correction::Friction),
    remedy: "set joint damping and friction loss ({}); --patch writes them",
    ..Info::NEW
};

/// Description of `link_parameters`: confounders, needs, remedy, experiment, rules.
pub(super) const LINKS: Info = Info {
    name: "link_parameters",
    plain: "inertial parameters of links",
    confounders: &[Effect::Payload, Effect::RotorInertia, Effect::TorqueGain],
    parameter: true,
    absorbable: true,
    place: Some("URDF"),
    correction: Some(Correction::Links),
    needs: &[Need::Minute],
    remedy: "set the links' inertials to ({}); --patch writes them",
    body: true,
    experiment: Experiment::KnownMass,
    ..Info::NEW
};

/// Velocity over which a part of a joint's Coulomb friction may build up, in widths of its softened sign. No
/// law is known for how a real contact comes to rest, and a wrong one looks like Stribeck or degressive
/// friction.
const BUILD_UP: f64 = 4.0;

const LINK: [(&str, Unit); PARAMETERS_PER_LINK] = [
    ("mass", Unit::Kilogram),
    ("first_moment_x", Unit::KilogramMetre),
    ("first_moment_y", Unit::KilogramMetre),
    ("first_moment_z", Unit::KilogramMetre),
    ("inertia_xx", Unit::KilogramMetre2),
    ("inertia_xy", Unit::KilogramMetre2),
    ("inertia_yy", Unit::KilogramMetre2),
    ("inertia_xz", Unit::KilogramMetre2),
    ("inertia_yz", Unit::KilogramMetre2),
    ("inertia_zz", Unit::KilogramMetre2),
];

/// Columns of the base: 10 inertial parameters per link, base first, then viscous, then Coulomb
/// friction. Changes of parameters, not parameters: the torque to explain is the gap.
pub fn base_columns(dof: usize) -> Vec<Column> {
    let inertial =
        (0..PARAMETERS_PER_LINK * dof).map(|c| (c, (0..=c / PARAMETERS_PER_LINK).collect()));
    let friction = (0..2 * dof).map(|f| (PARAMETERS_PER_LINK * dof + f, vec![f % dof]));
    inertial
        .chain(friction)
        .map(|(c, joints)| Column {
            joints,
            torque: ColumnTorque::Base(c),
            recorded: false,
        })
        .collect()
}

fn base(dof: usize, column: usize) -> Column {
    base_columns(dof).swap_remove(column)
}

pub(super) fn candidates(scene: &Scene) -> Vec<Candidate> {
    let dof = scene.dof();
    let link = |effect, link: usize| Candidate {
        effect,
        joints: vec![link],
        driver: None,
        columns: (0..PARAMETERS_PER_LINK)
            .map(|p| base(dof, PARAMETERS_PER_LINK * link + p))
            .collect(),
        bounds: vec![Bound::Free; PARAMETERS_PER_LINK],
        quantities: LINK
            .iter()
            .map(|&(name, unit)| Quantity::plain(name, unit, Some(link)))
            .collect(),
        change: None,
        shape: Vec::new(),
        sizes: Vec::new(),
        known: None,
        evidence: 0.0,
        shown: None,
    };
    // Before the last link's parameters, whose columns are the same: of two equal answers the first wins.
    let mut payload = link(Effect::Payload, dof - 1);
    payload.bounds[0] = Bound::Positive;
    let mut all = vec![payload];
    for l in 0..dof {
        all.extend([
            link(Effect::LinkParameters, l),
            heavier(scene, l),
            displaced(dof, l),
        ]);
        all.extend(turned(scene, l));
    }
    for j in 0..dof {
        all.extend(friction(scene, j));
        let inertia = Quantity::plain("inertia", Unit::KilogramMetre2, Some(j));
        let column = Column::term(j, Term::RotorInertia);
        all.push(Candidate::single(
            Effect::RotorInertia,
            j,
            inertia,
            Bound::Positive,
            column,
        ));
    }
    all
}

/// Candidate of a link with another density: all its parameters in proportion. It has one coefficient, where
/// the full set has ten.
fn heavier(scene: &Scene, link: usize) -> Candidate {
    let density = Quantity::plain("density", Unit::One, Some(link));
    let more = Bound::Between(-1.0, f64::INFINITY);
    changed(link, body(scene.robot, link).parameters(), density, more)
}

/// Quarter and half turns about the axes of a link's frame that are tried, rad.
const TURNS: [f64; 3] = [-FRAC_PI_2, FRAC_PI_2, PI];
/// Bound of the coefficient on such a turn.
const WHOLE: Bound = Bound::Between(0.75, 1.25);
/// Least change of the parameters by a turn, relative to the link's sizes; a smaller one is not tried.
const TURN_SHOWS: f64 = 0.2;

/// Candidates of a link whose inertials are given in a wrong frame: centre of mass and inertia turned.
fn turned(scene: &Scene, link: usize) -> Vec<Candidate> {
    let own = body(scene.robot, link);
    let sizes = link_sizes(&scene.robot.joints()[link]);
    let axes = [
        ("turn_x", Vector3::x()),
        ("turn_y", Vector3::y()),
        ("turn_z", Vector3::z()),
    ];
    let each = axes.into_iter().flat_map(|a| TURNS.map(|angle| (a, angle)));
    each.filter_map(|((name, axis), angle)| {
        let by = *Rotation3::new(axis * angle).matrix();
        let mut change = own.transformed(&by, &Vector3::zeros()).parameters();
        for (new, old) in change.iter_mut().zip(own.parameters()) {
            *new -= old;
        }
        let shows = change
            .iter()
            .zip(sizes)
            .any(|(c, s)| c.abs() > TURN_SHOWS * s);
        let part = Quantity::plain("part_of_turn", Unit::One, Some(link));
        shows.then(|| changed(link, change, part, WHOLE).with_shape(name, angle, Unit::Rad))
    })
    .collect()
}

/// Inertial parameters of a link in the present model.
fn body(robot: &Robot, link: usize) -> Inertia {
    robot.joints()[link].link.inertia
}

/// Candidate of a link whose parameters change by a multiple of `change`.
fn changed(
    link: usize,
    change: [f64; PARAMETERS_PER_LINK],
    quantity: Quantity,
    bound: Bound,
) -> Candidate {
    let torque = Column {
        joints: (0..=link).collect(),
        torque: ColumnTorque::Link(link, change),
        recorded: false,
    };
    let mut candidate = Candidate::single(Effect::LinkParameters, link, quantity, bound, torque);
    candidate.change = Some(change);
    candidate
}

/// Candidate of a link with its mass at another place: first moments. It has three coefficients, where a torque
/// of the joint's position that does the same needs more.
fn displaced(dof: usize, link: usize) -> Candidate {
    let moments = 1..4;
    Candidate {
        effect: Effect::LinkParameters,
        joints: vec![link],
        driver: None,
        columns: moments
            .clone()
            .map(|p| base(dof, PARAMETERS_PER_LINK * link + p))
            .collect(),
        bounds: vec![Bound::Free; moments.len()],
        quantities: LINK[moments]
            .iter()
            .map(|&(name, unit)| Quantity::plain(name, unit, Some(link)))
            .collect(),
        change: None,
        shape: Vec::new(),
        sizes: Vec::new(),
        known: None,
        evidence: 0.0,
        shown: None,
    }
}

/// Candidates of a joint's friction: change of the viscous and Coulomb coefficients, a part of Coulomb friction
/// that builds up more slowly, and all of these.
fn friction(scene: &Scene, j: usize) -> [Candidate; 3] {
    let dof = scene.dof();
    let new = |q, bound, c| Candidate::single(Effect::FrictionParameters, j, q, bound, c);
    let viscous = || Quantity::plain("viscous", Unit::NewtonMetreSecondPerRad, Some(j));
    let coulomb = || Quantity::plain("coulomb", Unit::NewtonMetre, Some(j));
    let slow = || Quantity::plain("slow_coulomb", Unit::NewtonMetre, Some(j));
    let slope = base(dof, PARAMETERS_PER_LINK * dof + j);
    let level = base(dof, (PARAMETERS_PER_LINK + 1) * dof + j);
    let velocity = BUILD_UP * scene.scale.softness[j];
    let late = Term::Sliding(Sliding::SoftCoulomb { velocity });
    let early = Term::Sliding(scene.coulomb(j));
    let slower = Column::terms(j, vec![(1.0, late), (-1.0, early)]);
    let shaped = |c: Candidate| c.with_shape("slow_velocity", velocity, Unit::RadPerSecond);
    let plain =
        || new(viscous(), Bound::Free, slope.clone()).and(coulomb(), Bound::Free, level.clone());
    [
        plain(),
        shaped(new(slow(), Bound::Positive, slower.clone())),
        shaped(plain().and(slow(), Bound::Positive, slower)),
    ]
}

/// Converts a payload's first moments into its centre of mass. Its deviation has that of the moment and that of the
/// mass, as if they were independent.
fn centre_of_mass(parameters: &mut Vec<Parameter>) {
    let Some((mass, of_mass)) = size(parameters, "mass") else {
        return;
    };
    for p in parameters {
        let name = match p.name.as_str() {
            "first_moment_x" => "com_x",
            "first_moment_y" => "com_y",
            "first_moment_z" => "com_z",
            _ => continue,
        };
        p.name = name.to_owned();
        p.value /= mass;
        let by_mass = p.value * of_mass.unwrap_or(0.0);
        p.std = p.std.map(|s| s.hypot(by_mass) / mass.abs());
        p.unit = Unit::Metre;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_centre_of_mass_is_known_no_better_than_the_mass() {
        let parameter = |name: &str, value, std, unit| Parameter {
            name: name.to_owned(),
            joint: None,
            value,
            std: Some(std),
            unit,
        };
        let mut all = vec![
            parameter("mass", 2.0, 0.4, Unit::Kilogram),
            parameter("first_moment_x", 1.0, 0.15, Unit::KilogramMetre),
            parameter("first_moment_y", 0.0, 0.15, Unit::KilogramMetre),
        ];
        centre_of_mass(&mut all);
        assert_eq!(all[1].name, "com_x");
        // A fifth by the mass and 0.15 by the moment, of half a metre.
        assert!((all[1].value - 0.5).abs() < 1e-12);
        assert!((all[1].std.unwrap() - 0.5 * 0.25).abs() < 1e-12);
        assert!((all[2].std.unwrap() - 0.075).abs() < 1e-12);
    }
}
