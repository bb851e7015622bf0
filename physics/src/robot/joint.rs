//! One moving joint and the link that it moves.

use super::Inertia;
use nalgebra::{Matrix3, Vector3};

/// Kind of a joint's motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JointKind {
    /// Rotation about the axis, with limits; q in rad.
    Revolute,
    /// Rotation about the axis, without limits; q in rad.
    Continuous,
    /// Translation along the axis; q in m.
    Prismatic,
}

impl JointKind {
    /// Whether the position q is an angle.
    pub fn is_rotation(self) -> bool {
        self != Self::Prismatic
    }
}

/// Limits of a joint; infinite where the description gives none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Lowest position, rad or m.
    pub lower: f64,
    /// Highest position, rad or m.
    pub upper: f64,
    /// Highest speed, rad/s or m/s.
    pub velocity: f64,
    /// Highest torque or force, N·m or N.
    pub effort: f64,
}

impl Limits {
    /// Limits of a joint without limits: infinite.
    pub const NONE: Self = Self {
        lower: f64::NEG_INFINITY,
        upper: f64::INFINITY,
        velocity: f64::INFINITY,
        effort: f64::INFINITY,
    };
}

/// The rigid body moved by a joint, everything fixed to it included.
#[derive(Debug, Clone, PartialEq)]
pub struct Link {
    /// Name of the joint's child link.
    pub name: String,
    /// Inertia in the joint's frame, about its origin.
    pub inertia: Inertia,
}

/// A moving joint, the frame it moves, and the link in that frame.
///
/// The joint frame turns (or slides) with the joint. At q it has, in the parent's joint frame (the
/// base frame for the first joint), orientation `rotation`·Rot(`axis`, q) and origin
/// `translation` for a rotation; orientation `rotation` and origin `translation` + `rotation`·`axis`·q for a
/// translation.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Name of the joint in the description.
    pub name: String,
    /// Kind of the joint's motion: it turns or slides.
    pub kind: JointKind,
    /// Unit vector of the axis in the joint frame.
    pub axis: Vector3<f64>,
    /// Orientation of the joint frame in the parent frame at q = 0.
    pub rotation: Matrix3<f64>,
    /// Origin of the joint frame in the parent frame at q = 0, m.
    pub translation: Vector3<f64>,
    /// Limits of motion and effort.
    pub limits: Limits,
    /// Viscous friction, N·m·s/rad or N·s/m.
    pub damping: f64,
    /// Coulomb friction, N·m or N.
    pub friction: f64,
    /// Inertia of motor and gear seen from the link, kg·m² (kg for a prismatic joint). Not part of the
    /// rigid-body functions; pass it as `armature` where it belongs.
    pub rotor_inertia: f64,
    /// Motor turns per joint turn, where known.
    pub gear_ratio: Option<f64>,
    /// Motor torque per current, N·m/A, where known.
    pub torque_constant: Option<f64>,
    /// Link that the joint moves.
    pub link: Link,
}
