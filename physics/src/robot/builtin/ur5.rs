//! Universal Robots UR5 (CB series).

use super::super::dh::{Convention, Row};
use super::assembly::{Axis, assemble};
use crate::robot::{Inertia, Limits, Robot};
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Kinematics: lengths and twists of Table 1 of the source paper (uncertainty compensation of a UR5 by
/// LSTM and attention). The table counts joints 2 and 4 from the upright pose (θ − π/2) and lengths as
/// positive; here q is what the robot's controller shows, so the offsets are zero and a₂, a₃ negative.
///
/// Gear ratio 101 and torque constants 0.125 and 0.0922 N·m/A: same paper, section IV-C.
///
/// Masses and centres of mass: Universal Robots, "DH parameters for calculations of kinematics and
/// dynamics", in the frames of the table. The manufacturer gives no inertia for the CB series; the
/// principal moments about the centres of mass are those used in the literature on this robot (Kebria et al.,
/// "Kinematic and dynamic modelling of UR5 manipulator", IEEE SMC 2016), which nobody measured. Joint
/// torques and speeds: UR5 data sheet. Rotor inertia is not published and left out.
pub(super) fn robot() -> Robot {
    let rows = [
        Row::revolute(0.0, FRAC_PI_2, 0.08916, 0.0),
        Row::revolute(-0.425, 0.0, 0.0, 0.0),
        Row::revolute(-0.39225, 0.0, 0.0, 0.0),
        Row::revolute(0.0, FRAC_PI_2, 0.10915, 0.0),
        Row::revolute(0.0, -FRAC_PI_2, 0.09456, 0.0),
        Row::revolute(0.0, 0.0, 0.0823, 0.0),
    ];
    let joints = [
        ("shoulder_pan_joint", "shoulder_link"),
        ("shoulder_lift_joint", "upper_arm_link"),
        ("elbow_joint", "forearm_link"),
        ("wrist_1_joint", "wrist_1_link"),
        ("wrist_2_joint", "wrist_2_link"),
        ("wrist_3_joint", "wrist_3_link"),
    ];
    // kg, m, kg·m².
    let bodies = [
        (3.7, [0.0, -0.02561, 0.00193], [0.0084, 0.0064, 0.0084]),
        (8.393, [0.2125, 0.0, 0.11336], [0.0078, 0.21, 0.21]),
        (2.33, [0.15, 0.0, 0.0265], [0.0016, 0.0462, 0.0462]),
        (1.219, [0.0, -0.0018, 0.01634], [0.0016, 0.0016, 0.0009]),
        (1.219, [0.0, 0.0018, 0.01634], [0.0016, 0.0016, 0.0009]),
        (0.1879, [0.0, 0.0, -0.001159], [0.0001, 0.0001, 0.0001]),
    ];
    let efforts = [150.0, 150.0, 150.0, 28.0, 28.0, 28.0];
    let axes = (0..6)
        .map(|i| {
            let (mass, com, moments) = bodies[i];
            let about_com = Matrix3::from_diagonal(&Vector3::from(moments));
            let (r, t) = Convention::Standard.link_frame(&rows[i]);
            Axis {
                joint: joints[i].0,
                link: joints[i].1,
                row: rows[i],
                inertia: Inertia::from_com(mass, com.into(), about_com).transformed(&r, &t),
                limits: Limits {
                    lower: -TAU,
                    upper: TAU,
                    velocity: PI,
                    effort: efforts[i],
                },
                rotor_inertia: 0.0,
                gear_ratio: Some(101.0),
                torque_constant: Some(if i < 3 { 0.125 } else { 0.0922 }),
            }
        })
        .collect();
    let base = (Matrix3::identity(), Vector3::zeros());
    assemble("ur5", Convention::Standard, base, axes)
}
