//! Built-in robots. Each file states where its numbers come from.

mod foxbot;
mod kr300;
mod ur5;

use super::dh::{Convention, Pose, Row, placements};
use super::{Inertia, Joint, Limits, Link, Robot};
use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// Which built-in robot. What is known of one beyond its description (its benchmark's files, gears that
/// run inside each other) follows from this and never from the name that a description carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Builtin {
    /// Universal Robots UR5.
    Ur5,
    /// KUKA KR300 R2500 ultra SE of the benchmark.
    Kr300,
    /// Foxbot A05.
    #[serde(rename = "foxbot_a05")]
    FoxbotA05,
}

impl Builtin {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Ur5, Self::Kr300, Self::FoxbotA05];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ur5 => "ur5",
            Self::Kr300 => "kr300",
            Self::FoxbotA05 => "foxbot_a05",
        }
    }

    /// The one of that name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|b| b.name() == name)
    }

    /// The robot.
    pub fn robot(self) -> Robot {
        let robot = match self {
            Self::Ur5 => ur5::robot(),
            Self::Kr300 => kr300::robot(),
            Self::FoxbotA05 => foxbot::robot(),
        };
        robot.known_as(Some(self))
    }

    /// Two joints whose gears run inside each other, so that each one's friction depends on the other's
    /// speed; base first.
    pub fn nested_gears(self) -> Option<[usize; 2]> {
        (self == Self::Kr300).then_some([4, 5])
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
