//! Foxbot A05, the robot of Han, Wu, Liu and Xiong (2020).

use super::super::dh::{Convention, Row};
use super::assembly::{Axis, assemble};
use crate::robot::{Inertia, Limits, Robot};
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::FRAC_PI_2;

/// Kinematics: modified Denavit–Hartenberg table of "An Iterative Approach for Accurate Dynamic Model
/// Identification of Industrial Robots" (IEEE Transactions on Robotics 36(5), 2020), Table I: a₂ = 0.075 m,
/// a₃ = 0.27 m, a₄ = 0.11 m, d₄ = 0.306 m, spherical wrist.
///
/// **Everything else is assumed**, because the authors publish no nominal values: masses and centres of mass of a
/// 5 kg-payload arm of about 30 kg, links as solid cylinders, rotor inertias, limits and ratios of
/// common harmonic drives. Use it for simulation, not as a model of a real Foxbot.
pub(super) fn robot() -> Robot {
    let rows = [
        Row::revolute(0.0, 0.0, 0.0, 0.0),
        Row::revolute(0.075, -FRAC_PI_2, 0.0, -FRAC_PI_2),
        Row::revolute(0.27, 0.0, 0.0, 0.0),
        Row::revolute(0.11, -FRAC_PI_2, 0.306, 0.0),
        Row::revolute(0.0, FRAC_PI_2, 0.0, 0.0),
        Row::revolute(0.0, -FRAC_PI_2, 0.0, 0.0),
    ];
    // Assumed: mass kg, centre of mass m, principal moments about it kg·m².
    let bodies = [
        (9.0, [0.03, 0.005, -0.08], [0.065, 0.06, 0.045]),
        (7.0, [0.13, 0.004, 0.06], [0.018, 0.062, 0.058]),
        (5.0, [0.06, 0.03, -0.01], [0.026, 0.02, 0.028]),
        (3.0, [0.002, -0.003, -0.09], [0.018, 0.017, 0.005]),
        (1.6, [0.001, 0.02, 0.004], [0.0032, 0.0018, 0.003]),
        (0.4, [0.0005, -0.0004, 0.065], [0.0003, 0.0003, 0.00025]),
    ];
    let rotor_inertias = [0.9, 0.8, 0.45, 0.12, 0.1, 0.06];
    let gear_ratios = [120.0, 120.0, 100.0, 80.0, 80.0, 50.0];
    // Assumed: range ± degrees, speed degrees/s, torque N·m.
    let limits = [
        (160.0, 220.0, 200.0),
        (110.0, 220.0, 200.0),
        (120.0, 250.0, 120.0),
        (180.0, 320.0, 40.0),
        (115.0, 320.0, 40.0),
        (350.0, 420.0, 20.0),
    ];
    let joints = [
        "joint_1", "joint_2", "joint_3", "joint_4", "joint_5", "joint_6",
    ];
    let links = ["link_1", "link_2", "link_3", "link_4", "link_5", "link_6"];
    let axes = (0..6)
        .map(|i| {
            let (mass, com, moments) = bodies[i];
            let (range, velocity, effort): (f64, f64, f64) = limits[i];
            let about_com = Matrix3::from_diagonal(&Vector3::from(moments));
            Axis {
                joint: joints[i],
                link: links[i],
                row: rows[i],
                inertia: Inertia::from_com(mass, com.into(), about_com),
                limits: Limits {
                    lower: -range.to_radians(),
                    upper: range.to_radians(),
                    velocity: velocity.to_radians(),
                    effort,
                },
                rotor_inertia: rotor_inertias[i],
                gear_ratio: Some(gear_ratios[i]),
                torque_constant: None,
            }
        })
        .collect();
    let base = (Matrix3::identity(), Vector3::zeros());
    assemble("foxbot_a05", Convention::Modified, base, axes)
}
