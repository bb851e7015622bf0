//! Built-in robots. Each file states where its numbers come from.

mod foxbot;
mod kr300;
mod ur5;

use super::dh::{Convention, Pose, Row, placements};
use super::{Inertia, Joint, Limits, Link, Robot};
use nalgebra::{Matrix3, Vector3};

/// Names of the built-in robots.
pub const NAMES: [&str; 3] = ["ur5", "kr300", "foxbot_a05"];

/// The built-in robot of that name.
pub(super) fn robot(name: &str) -> Option<Robot> {
    match name {
        "ur5" => Some(ur5::robot()),
        "kr300" => Some(kr300::robot()),
        "foxbot_a05" => Some(foxbot::robot()),
        _ => None,
    }
}

/// What is known about one joint and its link.
struct Axis {
    joint: &'static str,
    link: &'static str,
    row: Row,
    /// In the joint frame.
    inertia: Inertia,
    limits: Limits,
    rotor_inertia: f64,
    gear_ratio: Option<f64>,
    torque_constant: Option<f64>,
}

/// Assembles a robot of this folder. Its tests build every one, so that a refusal cannot reach a user.
fn assemble(name: &str, convention: Convention, base: Pose, axes: Vec<Axis>) -> Robot {
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
fn symmetric([xx, xy, xz, yy, yz, zz]: [f64; 6]) -> Matrix3<f64> {
    Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
}
