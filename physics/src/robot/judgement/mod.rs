//! Doubts about a description: found once, when it is read, and reported wherever it is used.
//!
//! Nothing here compares a description with a recording. Each doubt follows from the description alone: from
//! numbers that no body can have, from densities that no material has, or from weights that its own drives
//! could not move.

mod judge;

pub(super) use judge::judge;

use super::{Inertia, Joint};
use nalgebra::{Matrix3, Vector3};
use std::fmt;

/// Density of the heaviest metal in use, tungsten, kg/m³: a denser body is doubted.
const HEAVIEST: f64 = 19_300.0;

/// Density of air, kg/m³: a body that is lighter is doubted.
const AIR: f64 = 1.2;

/// A body of a description as it is written, before bodies fixed to each other are merged.
pub(super) struct Body {
    /// Name of the link or body.
    pub name: String,
    /// Name of the joint that carries the body.
    pub joint: String,
    /// Inertia in a frame of its own.
    pub inertia: Inertia,
}

/// State of the masses in a description.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Masses {
    /// Masses that are those of real bodies.
    #[default]
    Described,
    /// Placeholder numbers in place of masses: a comparison with them means nothing.
    Placeholders,
    /// Missing masses: bodies of 1 kg are substituted, which serve as a scale and nothing else.
    Missing,
}

/// A doubt about a description, and the elements that it concerns.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// Doubt that was found.
    pub doubt: Doubt,
    /// Names of joints, or of links and bodies where these are meant.
    pub names: Vec<String>,
    /// Joints of the chain that these are, or that carry these.
    pub joints: Vec<String>,
}

impl Finding {
    /// Finding of a doubt about one joint.
    pub(super) fn of_joint(doubt: Doubt, joint: &str) -> Self {
        Self {
            doubt,
            names: vec![joint.to_owned()],
            joints: vec![joint.to_owned()],
        }
    }

    /// A doubt about the link that a joint moves.
    pub(super) fn of_link(doubt: Doubt, joint: &Joint) -> Self {
        Self {
            doubt,
            names: vec![joint.link.name.clone()],
            joints: vec![joint.name.clone()],
        }
    }

    fn of_bodies(doubt: Doubt, bodies: &[&Body]) -> Self {
        let mut joints: Vec<String> = bodies.iter().map(|b| b.joint.clone()).collect();
        joints.dedup();
        Self {
            doubt,
            names: bodies.iter().map(|b| b.name.clone()).collect(),
            joints,
        }
    }
}

/// Doubt about a description.
#[derive(Debug, Clone, PartialEq)]
pub enum Doubt {
    /// Description in which no link has a mass.
    NoMasses,
    /// Different links with one mass (kg) and one inertia.
    Placeholders(f64),
    /// Bodies of different shape that all have this mass, kg.
    EqualMasses(f64),
    /// Link whose inertia no distribution of mass has: one principal moment exceeds the sum of the others.
    NoDistribution,
    /// Mass and inertia together ask for this density, kg/m³, which no solid has.
    NoMaterial(f64),
    /// Mass of a light link, and that of the link that carries it, kg.
    Light(f64, f64),
    /// Distance of the nearest part of a body from its joint, and the longest link of the arm, m.
    FarAway(f64, f64),
    /// Torque or force that the described weight asks for at the worst pose, and the drive's limit.
    BeyondDrive(f64, f64),
    /// Kind and value of a friction below zero; taken as zero.
    NegativeFriction(&'static str, f64),
    /// An effort limit of zero; taken as unknown.
    NoEffort,
    /// Length of an axis that should be a unit vector.
    AxisLength(f64),
    /// Viscous torque at the speed (second number) and the drive's limit (third).
    ServoDamping([f64; 3]),
    /// Damping and friction that every joint has.
    EqualFriction(f64, f64),
}

impl Doubt {
    /// Whether the doubt is that inertial numbers of its links cannot be relied on.
    pub fn is_of_masses(&self) -> bool {
        matches!(
            self,
            Self::NoMasses
                | Self::Placeholders(_)
                | Self::EqualMasses(_)
                | Self::NoDistribution
                | Self::NoMaterial(_)
                | Self::Light(..)
                | Self::FarAway(..)
                | Self::BeyondDrive(..)
        )
    }

    /// Whether the doubt is that friction of its joints cannot be relied on.
    pub fn is_of_friction(&self) -> bool {
        matches!(
            self,
            Self::NegativeFriction(..) | Self::ServoDamping(_) | Self::EqualFriction(..)
        )
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names = self.names.join(", ");
        match &self.doubt {
            Doubt::NoMasses => f.write_str(
                "the description has no masses: what its links weigh is learned, and no torque of the description itself \
                 can be judged",
            ),
            Doubt::Placeholders(mass) => write!(
                f,
                "the description's masses are placeholders: links of different shape ({names}) all have {mass} kg and one \
                 inertia; a comparison with them says nothing about the torque's unit or a payload"
            ),
            Doubt::EqualMasses(mass) => write!(
                f,
                "links of different shape ({names}) all weigh {mass} kg: a guess, not a measurement"
            ),
            Doubt::NoDistribution => write!(
                f,
                "link {names}: no mass distribution has its inertia: one principal moment exceeds the sum of the other \
                 two; check the numbers"
            ),
            Doubt::NoMaterial(density) => write!(
                f,
                "link {names}: a body of its mass and inertia has {density:.3e} kg/m³, and no solid has (air {AIR}, tungsten \
                 {HEAVIEST}); check both"
            ),
            Doubt::Light(mass, before) => write!(
                f,
                "link {names} weighs {mass} kg, less than a hundredth of the link before it ({before} kg); check its mass"
            ),
            Doubt::FarAway(distance, longest) => write!(
                f,
                "link {names}: all of its mass lies {distance:.2} m or more from its joint, farther than the arm's longest \
                 link is long ({longest:.2} m); check its centre of mass"
            ),
            Doubt::BeyondDrive(weight, effort) => write!(
                f,
                "joint {names}: to hold the described links takes up to {weight:.3} N·m or N, more than its effort limit of \
                 {effort}; check the masses and the limit"
            ),
            Doubt::NegativeFriction(what, value) => write!(
                f,
                "joint {names}: {what} is {value}, and friction takes energy; it is taken as 0"
            ),
            Doubt::NoEffort => write!(
                f,
                "joint {names}: the effort limit is 0; it is taken as unknown"
            ),
            Doubt::AxisLength(length) => write!(
                f,
                "joint {names}: its axis has the length {length:.6}; it is taken as a direction"
            ),
            Doubt::ServoDamping([torque, speed, effort]) => write!(
                f,
                "joint {names}: its damping alone takes {torque:.3} N·m or N at {speed} rad/s or m/s, more than its drive's \
                 {effort}; that is the gain of a servo, not friction"
            ),
            Doubt::EqualFriction(damping, friction) => write!(
                f,
                "every joint has the same friction (damping {damping}, friction {friction}): a guess, not a measurement"
            ),
        }
    }
}

/// Whether masses can be relied on at all.
pub(super) fn masses(findings: &[Finding], joints: &[Joint]) -> Masses {
    if findings.iter().any(|f| f.doubt == Doubt::NoMasses) {
        return Masses::Missing;
    }
    let no_mass = |f: &Finding| match f.doubt {
        Doubt::Placeholders(_) => true,
        Doubt::NoMaterial(density) => density < AIR,
        _ => false,
    };
    let named = |joint: &Joint| {
        let mut all = findings.iter().filter(|f| no_mass(f));
        all.any(|f| f.joints.contains(&joint.name))
    };
    match joints.iter().all(named) {
        true => Masses::Placeholders,
        false => Masses::Described,
    }
}

/// Bodies for a description without masses: balls of 1 kg that span half of each link, which serve as a scale.
pub(super) fn stand_ins(joints: &[Joint]) -> Vec<Inertia> {
    /// Radius where a description has no length at all, m.
    const RADIUS: f64 = 0.1;
    let lengths: Vec<f64> = joints
        .iter()
        .skip(1)
        .map(|j| j.translation.norm())
        .collect();
    let longest = lengths.iter().copied().fold(0.0, f64::max);
    let least = if longest > 0.0 { longest / 4.0 } else { RADIUS };
    (0..joints.len())
        .map(|k| {
            let next = joints
                .get(k + 1)
                .map_or(Vector3::zeros(), |j| j.translation);
            let radius = (next.norm() / 2.0).max(least);
            let about_com = Matrix3::identity() * (0.4 * radius * radius);
            // Where nothing follows, the body hangs beside its joint, so that its weight is one.
            let com = if next.norm() > 0.0 {
                next / 2.0
            } else {
                joints[k].axis.cross(&Vector3::new(0.48, 0.6, 0.64)) * least
            };
            Inertia::from_com(1.0, com, about_com)
        })
        .collect()
}
