//! Where the plate is, how fast and how accelerated: closed form from the arms' angles.

use nalgebra::{Matrix3, Vector3};
use std::f64::consts::TAU;

/// Lengths of a Delta, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shape {
    /// From the middle to the arms' axes, less from the plate's middle to its joints. With it every forearm ends in one point.
    pub offset: f64,
    /// Length of the arms.
    pub arm: f64,
    /// Length of the forearms.
    pub forearm: f64,
}

/// The machine at one set of angles.
#[derive(Debug, Clone, PartialEq)]
pub struct Pose {
    /// Position of the plate in the base frame (z upwards), m.
    pub plate: Vector3<f64>,
    /// ∂x/∂q: velocity of the plate per velocity of the arms, m/rad.
    pub jacobian: Matrix3<f64>,
    /// ∂e_i/∂q_i of each elbow, m/rad.
    pub elbow_slope: [Vector3<f64>; 3],
    /// ∂²e_i/∂q_i² of each elbow, m/rad².
    elbow_bend: [Vector3<f64>; 3],
    /// From each elbow to the plate's joint, m.
    forearms: [Vector3<f64>; 3],
    /// Inverse of the matrix whose rows are the forearms.
    inverse: Matrix3<f64>,
}

/// Accelerations in a motion through a pose.
#[derive(Debug, Clone, PartialEq)]
pub struct Moving {
    /// Velocity of the plate, m/s.
    pub velocity: Vector3<f64>,
    /// Acceleration of the plate, m/s².
    pub acceleration: Vector3<f64>,
    /// Acceleration of each elbow, m/s².
    pub elbow_acceleration: [Vector3<f64>; 3],
}

/// Direction outwards in the plane of each arm.
fn outwards(arm: usize) -> Vector3<f64> {
    let angle = TAU * arm as f64 / 3.0;
    Vector3::new(angle.cos(), angle.sin(), 0.0)
}

impl Shape {
    /// Where the forearms of an arm at angle `q` start, with `offset` in place of the base's radius.
    pub(super) fn elbow(&self, arm: usize, q: f64) -> Vector3<f64> {
        outwards(arm) * (self.offset + self.arm * q.cos()) - Vector3::z() * (self.arm * q.sin())
    }

    /// The pose below the base at these angles (rad, positive downwards); none where the forearms do not reach each other, or
    /// only with all of them in one plane.
    ///
    /// The plate's joint lies where three spheres about the elbows meet: on the line through the centre of their circle,
    /// upright to their plane.
    pub fn pose(&self, q: [f64; 3]) -> Option<Pose> {
        let e: [Vector3<f64>; 3] = std::array::from_fn(|i| self.elbow(i, q[i]));
        let (a, b) = (e[1] - e[0], e[2] - e[0]);
        let normal = a.cross(&b);
        let area = normal.norm_squared();
        if area <= 1e-12 {
            return None;
        }
        // Centre of the circle through the elbows, seen from the first.
        let centre = (b.cross(&normal) * a.norm_squared() + normal.cross(&a) * b.norm_squared())
            / (2.0 * area);
        let height = self.forearm * self.forearm - centre.norm_squared();
        if height <= 0.0 {
            return None;
        }
        let up = normal / area.sqrt() * normal.z.signum();
        let plate = e[0] + centre - up * height.sqrt();
        let forearms = e.map(|elbow| plate - elbow);
        let rows = Matrix3::from_rows(&forearms.map(|s| s.transpose()));
        let inverse = rows.try_inverse()?;
        let elbow_slope: [Vector3<f64>; 3] = std::array::from_fn(|i| {
            (-outwards(i) * q[i].sin() - Vector3::z() * q[i].cos()) * self.arm
        });
        let elbow_bend: [Vector3<f64>; 3] = std::array::from_fn(|i| {
            (-outwards(i) * q[i].cos() + Vector3::z() * q[i].sin()) * self.arm
        });
        // s_i·(ẋ − ė_i) = 0.
        let along = std::array::from_fn::<f64, 3, _>(|i| forearms[i].dot(&elbow_slope[i]));
        Some(Pose {
            plate,
            jacobian: inverse * Matrix3::from_diagonal(&Vector3::from(along)),
            elbow_slope,
            elbow_bend,
            forearms,
            inverse,
        })
    }

    /// Angles of the arms (rad) with the plate at `x` (m) in the base frame; none where an arm does not reach. Elbows point
    /// outwards.
    ///
    /// In the plane of an arm its elbow lies at distance `forearm` from x: A cos q + B sin q = C.
    pub fn angles(&self, x: Vector3<f64>) -> Option<[f64; 3]> {
        let mut q = [0.0; 3];
        for (i, angle) in q.iter_mut().enumerate() {
            let to = x - outwards(i) * self.offset;
            let (along, down) = (to.dot(&outwards(i)), -to.z);
            // |to − arm (cos q, −sin q)|² = forearm².
            let c = (to.norm_squared() + self.arm * self.arm - self.forearm * self.forearm)
                / (2.0 * self.arm);
            let reach = along.hypot(down);
            if c.abs() > reach {
                return None;
            }
            // The elbow that points outwards has the smaller angle downwards.
            *angle = down.atan2(along) - (c / reach).acos();
        }
        Some(q)
    }
}

impl Pose {
    /// Velocities and accelerations at arm velocities `qd` (rad/s) and accelerations `qdd` (rad/s²).
    pub fn moving(&self, qd: [f64; 3], qdd: [f64; 3]) -> Moving {
        let velocity = self.jacobian * Vector3::from(qd);
        let elbow_acceleration: [Vector3<f64>; 3] = std::array::from_fn(|i| {
            self.elbow_slope[i] * qdd[i] + self.elbow_bend[i] * (qd[i] * qd[i])
        });
        // Derivative of s_i·(ẋ − ė_i) = 0: s_i·(ẍ − ë_i) + |ẋ − ė_i|² = 0.
        let right = std::array::from_fn::<f64, 3, _>(|i| {
            let stretch = velocity - self.elbow_slope[i] * qd[i];
            self.forearms[i].dot(&elbow_acceleration[i]) - stretch.norm_squared()
        });
        Moving {
            velocity,
            acceleration: self.inverse * Vector3::from(right),
            elbow_acceleration,
        }
    }
}
