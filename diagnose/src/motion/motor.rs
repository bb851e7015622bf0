//! How the rigid torque changes with one joint's motion, and what drives that joint's transmission.

use super::rigid::rigid_torque;
use ndarray::{Array2, ArrayView1};
use physics::robot::Robot;
use signal::Motion;

/// Change of a position (rad) or velocity (rad/s) over which the rigid torque is differenced.
const STEP: f64 = 1e-4;

/// Partial derivatives of the rigid torque of all joints by the position, velocity and acceleration of
/// one; tables of shape (samples, joints).
pub struct Tangent {
    /// By position, N·m/rad.
    pub q: Array2<f64>,
    /// By velocity, N·m·s/rad.
    pub qd: Array2<f64>,
    /// By acceleration, kg·m².
    pub qdd: Array2<f64>,
}

/// The rigid body on the motion that drives a transmission.
pub(super) struct Wide<'a> {
    pub motion: &'a Motion,
    pub rigid: Array2<f64>,
    pub tangents: Vec<Tangent>,
}

/// Band of the motion that drives a transmission.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Band {
    /// That of the motion: its cut-off suits the torque.
    Motion,
    /// The whole band of the fitted rows.
    Rows,
}

/// What drives the transmission of one joint.
pub struct Motor<'s> {
    /// The joint.
    pub joint: usize,
    /// Acceleration.
    pub qdd: ArrayView1<'s, f64>,
    /// Torque that the rigid body needs to follow the motor.
    pub rigid: ArrayView1<'s, f64>,
    /// Derivatives of the rigid torque by the joint's motion.
    pub tangent: &'s Tangent,
}

/// Derivatives by each joint's motion.
pub(super) fn tangents(robot: &Robot, m: &Motion, rigid: &Array2<f64>) -> Vec<Tangent> {
    let shifted = |table: &Array2<f64>, joint: usize, step: f64| {
        let mut t = table.clone();
        t.column_mut(joint).mapv_inplace(|x| x + step);
        t
    };
    (0..robot.dof())
        .map(|j| Tangent {
            q: (rigid_torque(robot, &shifted(&m.q, j, STEP), &m.qd, &m.qdd) - rigid) / STEP,
            qd: (rigid_torque(robot, &m.q, &shifted(&m.qd, j, STEP), &m.qdd) - rigid) / STEP,
            qdd: rigid_torque(robot, &m.q, &m.qd, &shifted(&m.qdd, j, 1.0)) - rigid,
        })
        .collect()
}
