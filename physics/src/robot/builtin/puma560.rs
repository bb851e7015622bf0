//! Unimation PUMA 560, the arm on which the field compares models.

use super::super::dh::{Convention, Row};
use super::assembly::{Axis, assemble, symmetric};
use crate::robot::{Inertia, Limits, Robot};
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::FRAC_PI_2;

/// Kinematics (standard Denavit–Hartenberg), masses, centres of mass, inertias, motor inertias, gear ratios and friction:
/// P. I. Corke and B. Armstrong-Hélouvry, "A search for consensus among model parameters reported for the PUMA 560 robot"
/// (ICRA 1994), in the frames of the table, as the Robotics Toolbox for MATLAB has them (`mdl_puma560`); most of it goes
/// back to Armstrong, Khatib and Burdick (ICRA 1986), as do the largest torques. Damping and friction are the motors'
/// seen from the joint, Coulomb friction as the mean of both directions.
///
/// **Assumed:** mass and centre of link 1, of which only the inertia about its own axis (0.35 kg·m²) is published and
/// acts; joint speeds, and a mass centre on joint 5's axis where the publication has no other.
pub(super) fn robot() -> Robot {
    let rows = [
        Row::revolute(0.0, FRAC_PI_2, 0.0, 0.0),
        Row::revolute(0.4318, 0.0, 0.0, 0.0),
        Row::revolute(0.0203, -FRAC_PI_2, 0.150_05, 0.0),
        Row::revolute(0.0, FRAC_PI_2, 0.4318, 0.0),
        Row::revolute(0.0, -FRAC_PI_2, 0.0, 0.0),
        Row::revolute(0.0, 0.0, 0.0, 0.0),
    ];
    // kg, m, kg·m² about the centre of mass.
    let bodies = [
        (13.0, [0.0, 0.0, 0.0], [0.35, 0.35, 0.35]),
        (17.4, [-0.3638, 0.006, 0.2275], [0.13, 0.524, 0.539]),
        (4.8, [-0.0203, -0.0141, 0.07], [0.066, 0.086, 0.0125]),
        (0.82, [0.0, 0.019, 0.0], [1.8e-3, 1.3e-3, 1.8e-3]),
        (0.34, [0.0, 0.0, 0.0], [0.3e-3, 0.4e-3, 0.3e-3]),
        (0.09, [0.0, 0.0, 0.032], [0.15e-3, 0.15e-3, 0.04e-3]),
    ];
    let gear_ratios: [f64; 6] = [62.6111, 107.815, 53.7063, 76.036_36, 71.923, 76.686];
    let motor_inertias = [200e-6, 200e-6, 200e-6, 33e-6, 33e-6, 33e-6];
    let torque_limits = [97.6, 186.4, 89.4, 24.2, 20.1, 21.3];
    // Degrees; the last is a continuous wrist that the controller stops.
    let ranges: [(f64, f64); 6] = [
        (-160.0, 160.0),
        (-45.0, 225.0),
        (-225.0, 45.0),
        (-110.0, 170.0),
        (-100.0, 100.0),
        (-266.0, 266.0),
    ];
    let joints = [
        "joint_1", "joint_2", "joint_3", "joint_4", "joint_5", "joint_6",
    ];
    let links = ["link_1", "link_2", "link_3", "link_4", "link_5", "link_6"];
    let axes = (0..6)
        .map(|i| {
            let (mass, com, [xx, yy, zz]) = bodies[i];
            let about_com = symmetric([xx, 0.0, 0.0, yy, 0.0, zz]);
            let (r, t) = Convention::Standard.link_frame(&rows[i]);
            Axis {
                joint: joints[i],
                link: links[i],
                row: rows[i],
                inertia: Inertia::from_com(mass, com.into(), about_com).transformed(&r, &t),
                limits: Limits {
                    lower: ranges[i].0.to_radians(),
                    upper: ranges[i].1.to_radians(),
                    velocity: 3.0,
                    effort: torque_limits[i],
                },
                rotor_inertia: motor_inertias[i] * gear_ratios[i].powi(2),
                gear_ratio: Some(gear_ratios[i]),
                torque_constant: None,
            }
        })
        .collect();
    let base = (Matrix3::identity(), Vector3::zeros());
    let robot = assemble("puma560", Convention::Standard, base, axes);
    // Motor side: N·m·s/rad and N·m.
    let viscous = [1.48e-3, 0.817e-3, 1.38e-3, 71.2e-6, 82.6e-6, 36.7e-6];
    let coulomb = [0.415, 0.0985, 0.1185, 14.05e-3, 11.88e-3, 7.23e-3];
    let damping: Vec<f64> = (0..6)
        .map(|i| viscous[i] * gear_ratios[i].powi(2))
        .collect();
    let friction: Vec<f64> = (0..6).map(|i| coulomb[i] * gear_ratios[i]).collect();
    robot
        .with_friction(&damping, &friction)
        .expect("six values each")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::{Workspace, inverse_dynamics};

    /// Gravity on joints 2 and 3 with the arm stretched out level, by hand from the table. In standard frames link 2's
    /// centre lies a + x = 0.068 m and link 3's 0.4318 + 0.0203 − 0.0203 m from joint 2.
    #[test]
    fn gravity_by_hand() {
        let robot = robot();
        let mut tau = [0.0; 6];
        let zero = [0.0; 6];
        inverse_dynamics(
            &robot,
            &mut Workspace::new(&robot),
            &zero,
            &zero,
            &zero,
            &mut tau,
        );
        // Links 4 to 6 hang at a₂ + a₃ = 0.4521 m; link 4's centre 0.019 m along its frame's y, which is upright there.
        let beyond = 0.82 + 0.34 + 0.09;
        let joint_3 = 9.81 * beyond * 0.0203;
        let joint_2 = 9.81 * (17.4 * 0.068 + 4.8 * 0.4318 + beyond * 0.4521);
        assert!((tau[1] - joint_2).abs() < 1e-9, "{tau:?} {joint_2}");
        assert!((tau[2] - joint_3).abs() < 1e-9, "{tau:?} {joint_3}");
        assert!(tau[0].abs() < 1e-9);
    }
}
