//! KUKA KR300 R2500 ultra SE.

use super::super::dh::{Convention, Row};
use super::assembly::{Axis, assemble, symmetric};
use crate::robot::{Counterbalance, Inertia, Limits, Passive, Robot};
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::{FRAC_PI_2, PI};

/// Index of the joint with the counterbalance.
const COUNTERBALANCED: usize = 1;

/// Dimensions, masses, inertias, rotor inertias, gear ratios and the parameters of the counterbalance: model
/// files of the robot by the authors of the benchmark (repository JonasWeigand/Robot_Identification, MIT licence).
/// Link 6 includes their guess of the payload, 200 kg as a point mass. Position and velocity limits: "absolute" limits of Table 7
/// of the benchmark paper (Weigand, Götz, Ulmen and Ruskowski, 2022, DOI 10.26204/DATA/5). The law of
/// the counterbalance: appendix A.2 of that paper. Effort limits are not published.
///
/// Standard Denavit–Hartenberg on a base turned by π about x; q is what the measurements show, which the table's
/// angles exceed by [0, −90, 180, 0, 0, 0]°.
pub(super) fn robot() -> Robot {
    let rows = [
        Row::revolute(0.35, FRAC_PI_2, -0.675, 0.0),
        Row::revolute(1.15, 0.0, -0.189, -FRAC_PI_2),
        Row::revolute(0.041, -FRAC_PI_2, 0.189, PI),
        Row::revolute(0.0, FRAC_PI_2, -1.0, 0.0),
        Row::revolute(0.0, -FRAC_PI_2, 0.0, 0.0),
        Row::revolute(0.0, PI, -0.24, 0.0),
    ];
    // Mass, centre of mass, inertia about it [xx, xy, xz, yy, yz, zz]; joint frames.
    let bodies = [
        (
            395.4,
            [-0.003, 0.004, -0.501],
            [16.7338, -4.40406, -1.70366, 32.815, -0.129384, 29.7991],
        ),
        (
            339.12,
            [0.441, -0.001, -0.166],
            [7.50782, 0.430046, -4.39661, 88.8867, 0.173157, 88.6738],
        ),
        (
            105.21,
            [0.023, -0.076, 0.207],
            [10.7838, -0.10195, -0.118474, 1.94318, 0.606384, 10.1861],
        ),
        (
            35.8,
            [0.0, -0.001, -0.764],
            [0.425035, 2.7e-5, -4e-6, 0.428465, 0.011353, 0.217993],
        ),
        (
            31.46,
            [0.0, -0.009, 0.08],
            [0.283826, -0.00012, 4e-6, 0.258266, 0.019521, 0.229562],
        ),
        (217.78, [0.0, 0.0, -0.327754], [0.0; 6]),
    ];
    let gear_ratios = [
        1798.0 / 7.0,
        1872.0 / 7.0,
        757.0 / 3.0,
        221.0,
        5032.0 / 21.0,
        206793.0 / 1340.0,
    ];
    let rotor_inertias = [609.0, 844.0, 751.0, 84.5, 99.3, 41.2];
    // Lower, upper, speed; degrees.
    let limits = [
        (-147.0, 147.0, 84.6),
        (-50.0, 85.0, 82.3),
        (-202.0, 63.0, 79.3),
        (-350.0, 350.0, 122.0),
        (-122.5, 122.5, 113.0),
        (-350.0, 350.0, 175.0),
    ];
    let joints = [
        "joint_1", "joint_2", "joint_3", "joint_4", "joint_5", "joint_6",
    ];
    let links = ["link_1", "link_2", "link_3", "link_4", "link_5", "link_6"];
    let axes = (0..6)
        .map(|i| {
            let (mass, com, about_com) = bodies[i];
            let (lower, upper, velocity): (f64, f64, f64) = limits[i];
            Axis {
                joint: joints[i],
                link: links[i],
                row: rows[i],
                inertia: Inertia::from_com(mass, com.into(), symmetric(about_com)),
                limits: Limits {
                    lower: lower.to_radians(),
                    upper: upper.to_radians(),
                    velocity: velocity.to_radians(),
                    effort: f64::INFINITY,
                },
                rotor_inertia: rotor_inertias[i],
                gear_ratio: Some(gear_ratios[i]),
                torque_constant: None,
            }
        })
        .collect();
    let turned = Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, -1.0));
    assemble(
        "kr300",
        Convention::Standard,
        (turned, Vector3::zeros()),
        axes,
    )
    .with_passive(Passive::Counterbalance(counterbalance()))
    .expect("joint 2 exists")
}

/// Two cylinders in parallel; δ = q₂ − 90° + 95°.
fn counterbalance() -> Counterbalance {
    let (outer, rod): (f64, f64) = (0.055, 0.030);
    let (compressibility, specific_gas_constant, temperature) = (1.01, 296.8, 328.0);
    let gas_mass = 2.0 * 0.0795;
    Counterbalance {
        joint: COUNTERBALANCED,
        zero: 5.0_f64.to_radians(),
        distance: 0.8,
        radius: 0.2,
        area: PI * (outer * outer - rod * rod) / 4.0,
        volume: 2.0 * 0.00048,
        gas_energy: gas_mass * compressibility * specific_gas_constant * temperature,
        scale: 1.0,
    }
}
