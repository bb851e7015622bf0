//! Derivatives of the rigid torque by one joint's motion, and the drive of that joint's transmission.

use ndarray::{Array2, ArrayView1};
use physics::dynamics::{Workspace, inverse_dynamics};
use physics::robot::Robot;
use signal::Motion;
use std::sync::OnceLock;

/// Step of the finite differences of the rigid torque: position (rad) or velocity (rad/s).
const STEP: f64 = 1e-4;

/// Partial derivatives of all joints' rigid torque by the position, velocity and acceleration of one joint.
/// Tables of shape (samples, joints).
pub struct Tangent {
    /// Derivative of all joints' torque by the joint's position, N·m/rad.
    pub q: Array2<f64>,
    /// Derivative of all joints' torque by the joint's velocity, N·m·s/rad.
    pub qd: Array2<f64>,
    /// Derivative of all joints' torque by the joint's acceleration, kg·m².
    pub qdd: Array2<f64>,
}

/// Motion in the band of the rows with its rigid torque, N·m (N), and derivatives.
pub(super) struct Wide<'a> {
    pub motion: &'a Motion,
    pub rigid: Array2<f64>,
    pub tangents: Tangents,
}

/// Band of the motion that drives a transmission.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Band {
    /// Band of the motion as prepared, whose cut-off suits the torque.
    Motion,
    /// Whole band of the fitted rows.
    Rows,
}

/// Motion and torques that drive the transmission of one joint.
pub struct Motor<'s> {
    /// Index of the joint whose transmission is driven.
    pub joint: usize,
    /// Acceleration of the joint's motor, rad/s² (m/s²).
    pub qdd: ArrayView1<'s, f64>,
    /// Torque that the rigid body needs to follow the motor, N·m (N).
    pub rigid: ArrayView1<'s, f64>,
    /// Derivatives of the rigid torque by the joint's motion.
    pub tangent: &'s Tangent,
}

/// Derivatives by each joint's motion, computed on first use: few columns need any.
pub(super) struct Tangents(Vec<OnceLock<Tangent>>);

impl Tangents {
    pub(super) fn new(dof: usize) -> Self {
        Self((0..dof).map(|_| OnceLock::new()).collect())
    }

    /// Derivatives by one joint's motion. `rigid` is the robot's torque on the motion, shape (samples, joints).
    pub(super) fn by(
        &self,
        joint: usize,
        robot: &Robot,
        motion: &Motion,
        rigid: &Array2<f64>,
    ) -> &Tangent {
        self.0[joint].get_or_init(|| Tangent::new(robot, motion, rigid, joint))
    }
}

impl Tangent {
    // On one thread: a worker that waited for others here could be given a column that waits for this one.
    fn new(robot: &Robot, m: &Motion, rigid: &Array2<f64>, joint: usize) -> Self {
        let mut workspace = Workspace::new(robot);
        let [mut by_q, mut by_qd, mut by_qdd] = [(); 3].map(|()| Array2::zeros(rigid.dim()));
        let mut moved = vec![0.0; robot.dof()];
        let mut tau = vec![0.0; robot.dof()];
        for (i, rigid) in rigid.rows().into_iter().enumerate() {
            let [q, qd, qdd] = [&m.q, &m.qd, &m.qdd].map(|t| {
                let all = t.as_slice().expect("tables are in standard layout");
                &all[i * t.ncols()..(i + 1) * t.ncols()]
            });
            let mut difference = |which: usize, step: f64, out: &mut Array2<f64>| {
                let mut at = [q, qd, qdd];
                moved.copy_from_slice(at[which]);
                moved[joint] += step;
                at[which] = &moved;
                inverse_dynamics(robot, &mut workspace, at[0], at[1], at[2], &mut tau);
                let change = tau.iter().zip(rigid).map(|(t, r)| (t - r) / step);
                out.row_mut(i)
                    .iter_mut()
                    .zip(change)
                    .for_each(|(o, c)| *o = c);
            };
            difference(0, STEP, &mut by_q);
            difference(1, STEP, &mut by_qd);
            difference(2, 1.0, &mut by_qdd);
        }
        Self {
            q: by_q,
            qd: by_qd,
            qdd: by_qdd,
        }
    }
}
