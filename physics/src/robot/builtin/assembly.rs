//! Construction of a robot from a table.

use crate::robot::dh::{Convention, Pose, Row, placements};
use crate::robot::{Inertia, Joint, Limits, Link, Robot};
use nalgebra::{Matrix3, Vector3};

/// Description of one joint and its link.
pub(super) struct Axis {
    pub(super) joint: &'static str,
    pub(super) link: &'static str,
    pub(super) row: Row,
    /// Inertia of the link in the joint frame.
    pub(super) inertia: Inertia,
    pub(super) limits: Limits,
    pub(super) rotor_inertia: f64,
    pub(super) gear_ratio: Option<f64>,
    pub(super) torque_constant: Option<f64>,
}

/// Assembles a robot of this folder. Its tests build every one, so that a refusal cannot reach a user.
pub(super) fn assemble(name: &str, convention: Convention, base: Pose, axes: Vec<Axis>) -> Robot {
    let rows: Vec<Row> = axes.iter().map(|a| a.row).collect();
    let joints = placements(convention, base, &rows)
        .into_iter()
        .zip(axes)
        .map(|((rotation, translation), axis)| Joint {
            name: axis.joint.to_owned(),
            kind: axis.row.kind,
            axis: Vector3::z(),
            rotation,
            translation,
            limits: axis.limits,
            damping: 0.0,
            friction: 0.0,
            rotor_inertia: axis.rotor_inertia,
            gear_ratio: axis.gear_ratio,
            torque_constant: axis.torque_constant,
            link: Link {
                name: axis.link.to_owned(),
                inertia: axis.inertia,
            },
        })
        .collect();
    Robot::new(name, joints).expect("the built-in tables are valid")
}

/// Symmetric matrix from `[xx, xy, xz, yy, yz, zz]`, the order of a URDF.
pub(super) fn symmetric([xx, xy, xz, yy, yz, zz]: [f64; 6]) -> Matrix3<f64> {
    Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
}
