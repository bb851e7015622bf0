//! Robots of the simulated cases: shapes and sizes of common arms, and random variants of them.
//!
//! Lengths and masses are rounded from public data sheets and descriptions; inertias are those of cylinders and
//! boxes of these masses with the motors in the joints. They need not match any maker's robot, since a case is
//! about the difference between two models.

use crate::arm::Arm;
use crate::mechanism::RestLaw;
use crate::random::log_uniform;
use nalgebra::{Matrix3, Rotation3, Vector3};
use physics::robot::{Inertia, Joint, JointKind, Limits, Link};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use std::f64::consts::FRAC_PI_2;

/// Makers of the families that [`relative`] draws from.
pub const FAMILIES: [fn() -> Arm; 6] = [ur5, panda_like7, scara4, heavy6, planar3, desk5];

/// One joint and its link, all in the joint's frame.
struct Row {
    kind: JointKind,
    axis: [f64; 3],
    xyz: [f64; 3],
    rpy: [f64; 3],
    /// Middle and half width of the joint's region of motion, and its fastest speed.
    centre: f64,
    reach: f64,
    speed: f64,
    mass: f64,
    com: [f64; 3],
    /// Principal radii of gyration, m.
    gyration: [f64; 3],
    /// Viscous friction of the joint, N·m·s/rad; in `coulomb`, Coulomb friction, N·m.
    viscous: f64,
    coulomb: f64,
}

const X: [f64; 3] = [1.0, 0.0, 0.0];
const Y: [f64; 3] = [0.0, 1.0, 0.0];
const Z: [f64; 3] = [0.0, 0.0, 1.0];
const DOWN: [f64; 3] = [0.0, 0.0, -1.0];
use JointKind::{Prismatic, Revolute};

/// A six-joint arm of 850 mm reach.
pub fn ur5() -> Arm {
    #[rustfmt::skip]
    let rows = [
        Row { kind: Revolute, axis: Z, xyz: [0.0, 0.0, 0.0892], rpy: [0.0; 3], centre: 0.0, reach: 1.4, speed: 2.2, mass: 3.7, com: [0.0, -0.002, 0.06], gyration: [0.062, 0.060, 0.058], viscous: 8.0, coulomb: 10.0 },
        Row { kind: Revolute, axis: Y, xyz: [0.0, 0.1358, 0.0], rpy: [0.0, FRAC_PI_2, 0.0], centre: -1.2, reach: 0.9, speed: 1.9, mass: 8.4, com: [-0.21, 0.0, 0.11], gyration: [0.07, 0.17, 0.17], viscous: 9.0, coulomb: 9.0 },
        Row { kind: Revolute, axis: Y, xyz: [0.0, -0.1197, 0.425], rpy: [0.0; 3], centre: 0.9, reach: 1.1, speed: 2.3, mass: 2.3, com: [-0.25, 0.0, 0.025], gyration: [0.05, 0.15, 0.15], viscous: 7.5, coulomb: 8.0 },
        Row { kind: Revolute, axis: Y, xyz: [0.0, 0.0, 0.3922], rpy: [0.0, FRAC_PI_2, 0.0], centre: -0.3, reach: 1.3, speed: 2.8, mass: 1.25, com: [0.0, -0.016, 0.11], gyration: [0.29, 0.29, 0.28], viscous: 1.0, coulomb: 2.5 },
        Row { kind: Revolute, axis: Z, xyz: [0.0, 0.093, 0.0], rpy: [0.0; 3], centre: 0.1, reach: 1.4, speed: 2.9, mass: 1.2, com: [0.0, 0.016, 0.09], gyration: [0.29, 0.29, 0.28], viscous: 1.0, coulomb: 1.1 },
        Row { kind: Revolute, axis: Y, xyz: [0.0, 0.0, 0.0946], rpy: [0.0; 3], centre: 0.0, reach: 1.6, speed: 3.1, mass: 0.42, com: [0.006, 0.0, 0.1], gyration: [0.2, 0.2, 0.28], viscous: 0.9, coulomb: 0.6 },
    ];
    arm("ur5", &rows)
}

/// A seven-joint arm with offset elbow.
pub fn panda_like7() -> Arm {
    #[rustfmt::skip]
    let rows = [
        Row { kind: Revolute, axis: Z, xyz: [0.0, 0.0, 0.333], rpy: [0.0; 3], centre: 0.0, reach: 1.4, speed: 2.0, mass: 3.6, com: [0.0, 0.02, -0.17], gyration: [0.13, 0.12, 0.11], viscous: 2.4, coulomb: 1.6 },
        Row { kind: Revolute, axis: Z, xyz: [0.0, 0.0, 0.0], rpy: [-FRAC_PI_2, 0.0, 0.0], centre: 0.1, reach: 0.9, speed: 1.9, mass: 4.2, com: [0.0, -0.06, 0.032], gyration: [0.12, 0.10, 0.12], viscous: 2.2, coulomb: 2.1 },
        Row { kind: Revolute, axis: Z, xyz: [0.0, -0.316, 0.0], rpy: [FRAC_PI_2, 0.0, 0.0], centre: 0.0, reach: 1.3, speed: 2.0, mass: 2.5, com: [0.0, 0.03, -0.06], gyration: [0.12, 0.12, 0.12], viscous: 1.6, coulomb: 1.5 },
        Row { kind: Revolute, axis: Z, xyz: [0.0825, 0.0, 0.0], rpy: [FRAC_PI_2, 0.0, 0.0], centre: -1.6, reach: 0.9, speed: 1.9, mass: 2.8, com: [-0.03, 0.07, 0.028], gyration: [0.11, 0.09, 0.11], viscous: 1.5, coulomb: 1.7 },
        Row { kind: Revolute, axis: Z, xyz: [-0.0825, 0.384, 0.0], rpy: [-FRAC_PI_2, 0.0, 0.0], centre: 0.0, reach: 1.4, speed: 2.6, mass: 3.3, com: [0.0, 0.03, -0.11], gyration: [0.13, 0.12, 0.10], viscous: 0.8, coulomb: 0.75 },
        Row { kind: Revolute, axis: Z, xyz: [0.0, 0.0, 0.0], rpy: [FRAC_PI_2, 0.0, 0.0], centre: 1.6, reach: 1.1, speed: 2.4, mass: 1.6, com: [0.03, -0.03, 0.0], gyration: [0.08, 0.08, 0.08], viscous: 0.6, coulomb: 0.75 },
        Row { kind: Revolute, axis: Z, xyz: [0.088, 0.0, 0.0], rpy: [FRAC_PI_2, 0.0, 0.0], centre: 0.3, reach: 1.6, speed: 3.0, mass: 0.75, com: [0.004, 0.003, 0.09], gyration: [0.12, 0.12, 0.14], viscous: 0.6, coulomb: 0.45 },
    ];
    arm("panda_like7", &rows)
}

/// A SCARA: two parallel joints, a sliding quill, a turning tool.
pub fn scara4() -> Arm {
    #[rustfmt::skip]
    let rows = [
        Row { kind: Revolute, axis: Z, xyz: [0.0, 0.0, 0.35], rpy: [0.0; 3], centre: 0.0, reach: 1.9, speed: 4.5, mass: 10.8, com: [0.15, 0.01, 0.02], gyration: [0.055, 0.15, 0.158], viscous: 8.5, coulomb: 4.8 },
        Row { kind: Revolute, axis: Z, xyz: [0.35, 0.0, 0.06], rpy: [0.0; 3], centre: 0.2, reach: 1.9, speed: 5.2, mass: 6.2, com: [0.12, -0.005, 0.05], gyration: [0.065, 0.13, 0.136], viscous: 2.1, coulomb: 5.0 },
        Row { kind: Prismatic, axis: DOWN, xyz: [0.3, 0.0, 0.05], rpy: [0.0; 3], centre: 0.1, reach: 0.085, speed: 0.75, mass: 1.6, com: [0.0, 0.0, -0.05], gyration: [0.1, 0.1, 0.08], viscous: 32.0, coulomb: 11.5 },
        Row { kind: Revolute, axis: DOWN, xyz: [0.0, 0.0, -0.2], rpy: [0.0; 3], centre: 0.0, reach: 2.4, speed: 7.0, mass: 1.3, com: [0.03, 0.01, -0.03], gyration: [0.1, 0.105, 0.115], viscous: 0.26, coulomb: 0.31 },
    ];
    arm("scara4", &rows)
}

/// A heavy six-joint arm, 210 kg class.
pub fn heavy6() -> Arm {
    #[rustfmt::skip]
    let rows = [
        Row { kind: Revolute, axis: Z, xyz: [0.0, 0.0, 0.675], rpy: [0.0; 3], centre: 0.0, reach: 1.3, speed: 1.6, mass: 260.0, com: [0.14, 0.03, -0.1], gyration: [0.30, 0.34, 0.33], viscous: 420.0, coulomb: 330.0 },
        Row { kind: Revolute, axis: Y, xyz: [0.35, 0.0, 0.0], rpy: [0.0; 3], centre: 0.0, reach: 0.7, speed: 1.3, mass: 190.0, com: [0.02, -0.16, 0.5], gyration: [0.42, 0.43, 0.14], viscous: 460.0, coulomb: 380.0 },
        Row { kind: Revolute, axis: Y, xyz: [0.0, 0.0, 1.15], rpy: [0.0; 3], centre: 0.2, reach: 0.8, speed: 1.5, mass: 150.0, com: [0.18, 0.04, 0.1], gyration: [0.18, 0.32, 0.31], viscous: 260.0, coulomb: 220.0 },
        Row { kind: Revolute, axis: X, xyz: [0.5, 0.0, 0.04], rpy: [0.0; 3], centre: 0.0, reach: 1.5, speed: 2.4, mass: 58.0, com: [0.35, 0.0, 0.01], gyration: [0.16, 0.24, 0.24], viscous: 38.0, coulomb: 45.0 },
        Row { kind: Revolute, axis: Y, xyz: [0.5, 0.0, 0.0], rpy: [0.0; 3], centre: 0.5, reach: 1.1, speed: 2.4, mass: 36.0, com: [0.06, 0.0, 0.0], gyration: [0.13, 0.15, 0.15], viscous: 32.0, coulomb: 40.0 },
        Row { kind: Revolute, axis: X, xyz: [0.2, 0.0, 0.0], rpy: [0.0; 3], centre: 0.0, reach: 1.7, speed: 2.9, mass: 42.0, com: [0.16, 0.03, 0.05], gyration: [0.2, 0.2, 0.2], viscous: 17.0, coulomb: 26.0 },
    ];
    arm("heavy6", &rows)
}

/// Three joints in one upright plane.
pub fn planar3() -> Arm {
    #[rustfmt::skip]
    let rows = [
        Row { kind: Revolute, axis: Y, xyz: [0.0, 0.0, 0.4], rpy: [0.0, 0.0, 0.2], centre: 0.3, reach: 1.3, speed: 2.6, mass: 5.5, com: [0.01, 0.02, 0.24], gyration: [0.15, 0.15, 0.06], viscous: 2.6, coulomb: 3.4 },
        Row { kind: Revolute, axis: Y, xyz: [0.0, 0.05, 0.48], rpy: [0.0; 3], centre: 0.8, reach: 1.3, speed: 3.0, mass: 3.4, com: [0.0, -0.03, 0.19], gyration: [0.13, 0.13, 0.05], viscous: 1.5, coulomb: 1.9 },
        Row { kind: Revolute, axis: Y, xyz: [0.0, -0.05, 0.38], rpy: [0.03, 0.0, 0.0], centre: 0.0, reach: 1.5, speed: 3.6, mass: 1.5, com: [0.02, 0.0, 0.1], gyration: [0.09, 0.1, 0.05], viscous: 0.5, coulomb: 0.7 },
    ];
    arm("planar3", &rows)
}

/// A small five-joint arm for a desk.
pub fn desk5() -> Arm {
    #[rustfmt::skip]
    let rows = [
        Row { kind: Revolute, axis: Z, xyz: [0.0, 0.0, 0.12], rpy: [0.0; 3], centre: 0.0, reach: 1.6, speed: 3.0, mass: 1.4, com: [0.01, 0.0, 0.05], gyration: [0.05, 0.05, 0.05], viscous: 0.7, coulomb: 0.9 },
        Row { kind: Revolute, axis: Y, xyz: [0.02, 0.0, 0.09], rpy: [0.0; 3], centre: 0.2, reach: 1.0, speed: 2.4, mass: 1.2, com: [0.0, 0.01, 0.16], gyration: [0.1, 0.1, 0.04], viscous: 0.8, coulomb: 0.8 },
        Row { kind: Revolute, axis: Y, xyz: [0.0, 0.0, 0.30], rpy: [0.0; 3], centre: 1.0, reach: 1.1, speed: 2.8, mass: 0.8, com: [0.03, 0.0, 0.12], gyration: [0.08, 0.08, 0.04], viscous: 0.5, coulomb: 0.55 },
        Row { kind: Revolute, axis: Y, xyz: [0.0, 0.0, 0.24], rpy: [0.0; 3], centre: 0.6, reach: 1.2, speed: 3.2, mass: 0.5, com: [0.0, 0.0, 0.05], gyration: [0.07, 0.07, 0.06], viscous: 0.2, coulomb: 0.22 },
        Row { kind: Revolute, axis: Z, xyz: [0.0, 0.0, 0.09], rpy: [0.0; 3], centre: 0.0, reach: 1.9, speed: 4.2, mass: 0.45, com: [0.02, 0.008, 0.05], gyration: [0.08, 0.07, 0.09], viscous: 0.09, coulomb: 0.12 },
    ];
    arm("desk5", &rows)
}

fn arm(family: &'static str, rows: &[Row]) -> Arm {
    let joints = rows.iter().enumerate().map(|(i, row)| {
        let k = Vector3::from(row.gyration);
        let about_com = Matrix3::from_diagonal(&(k.component_mul(&k) * row.mass));
        let [roll, pitch, yaw] = row.rpy;
        Joint {
            name: format!("joint{}", i + 1),
            kind: row.kind,
            axis: Vector3::from(row.axis),
            rotation: *Rotation3::from_euler_angles(roll, pitch, yaw).matrix(),
            translation: Vector3::from(row.xyz),
            limits: Limits {
                lower: row.centre - 1.15 * row.reach,
                upper: row.centre + 1.15 * row.reach,
                velocity: row.speed,
                effort: 1e5,
            },
            damping: row.viscous,
            friction: row.coulomb,
            rotor_inertia: 0.0,
            gear_ratio: None,
            torque_constant: None,
            link: Link {
                name: format!("link{}", i + 1),
                inertia: Inertia::from_com(row.mass, Vector3::from(row.com), about_com),
            },
        }
    });
    Arm {
        family,
        joints: joints.collect(),
        centre: rows.iter().map(|r| r.centre).collect(),
        reach: rows.iter().map(|r| r.reach).collect(),
        v_eps: rows.iter().map(|r| 0.0008 * r.speed).collect(),
        rest: RestLaw::Root,
        disc: vec![0.0; rows.len()],
    }
}

/// A relative of a random family: every length, mass, centre of mass, inertia and friction coefficient is
/// its own, and so are speeds and region of motion.
pub fn relative(rng: &mut ChaCha8Rng) -> Arm {
    let mut arm = FAMILIES[rng.random_range(0..FAMILIES.len())]();
    let size = rng.random_range(0.85..1.2f64);
    let weight = size.powi(3) * rng.random_range(0.8..1.25);
    for (i, joint) in arm.joints.iter_mut().enumerate() {
        let slides = !joint.kind.is_rotation();
        let stretch = size * rng.random_range(0.93..1.07);
        joint.translation *= stretch;
        let body = &joint.link.inertia;
        let mass = body.mass * weight * rng.random_range(0.8..1.25);
        let shift = Vector3::from_fn(|_, _| rng.random_range(-0.06..0.06)) * body.com().norm();
        let inertia = body.about_com() / body.mass;
        let inertia = inertia * (mass * size * size * rng.random_range(0.85..1.2));
        joint.link.inertia = Inertia::from_com(mass, body.com() * stretch + shift, inertia);
        // Torques grow as weight × size, forces as weight.
        let strength = weight * if slides { 1.0 } else { size };
        joint.damping *= strength * log_uniform(rng, 0.55, 1.8);
        joint.friction *= strength * log_uniform(rng, 0.55, 1.8);
        joint.limits.velocity *= rng.random_range(0.85..1.15);
        let drift = 0.1 * arm.reach[i] * rng.random_range(-1.0..1.0);
        arm.centre[i] += drift;
        joint.limits.lower += drift;
        joint.limits.upper += drift;
    }
    // Some makers count motors and gears among the links.
    let inertia = arm.inertia();
    for (j, inertia) in inertia.into_iter().flatten().enumerate() {
        if rng.random_bool(0.45) && arm.joints[j].kind.is_rotation() {
            arm.add_disc(j, inertia * rng.random_range(0.3..0.8));
        }
    }
    arm
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rand::SeedableRng;

    proptest! {
        #[test]
        fn relatives_are_possible_robots(seed in 0u64..2000) {
            let arm = relative(&mut ChaCha8Rng::seed_from_u64(seed));
            let robot = arm.robot().unwrap();
            prop_assert!(robot.findings().is_empty(), "{:?}", robot.findings());
            for joint in robot.joints() {
                prop_assert!(joint.limits.lower < joint.limits.upper);
            }
        }
    }
}
