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
    /// Mean inertia that the joint turns in the recording, kg·m².
    pub inertia: f64,
}

/// Derivatives by each joint's motion, and the mean inertia that it turns, computed on first use: few columns need any.
pub(super) struct Tangents(Vec<(OnceLock<Tangent>, OnceLock<f64>)>);

impl Tangents {
    pub(super) fn new(dof: usize) -> Self {
        Self((0..dof).map(|_| Default::default()).collect())
    }

    /// Derivatives by one joint's motion. `rigid` is the robot's torque on the motion, shape (samples, joints).
    pub(super) fn by(
        &self,
        joint: usize,
        robot: &Robot,
        motion: &Motion,
        rigid: &Array2<f64>,
    ) -> &Tangent {
        let tangent = || Tangent::new(robot, motion, rigid, joint);
        self.0[joint].0.get_or_init(tangent)
    }

    /// Mean inertia that one joint turns, kg·m², with the arguments of [`Self::by`].
    pub(super) fn inertia(
        &self,
        joint: usize,
        robot: &Robot,
        motion: &Motion,
        rigid: &Array2<f64>,
    ) -> f64 {
        let mean = || {
            let mut sum = 0.0;
            differences(robot, motion, rigid, [joint, 2], 1.0, |_, change| {
                sum += change.nth(joint).unwrap_or(0.0);
            });
            sum / motion.len().max(1) as f64
        };
        *self.0[joint].1.get_or_init(mean)
    }
}

impl Tangent {
    // On one thread: a worker that waited for others here could be given a column that waits for this one.
    fn new(robot: &Robot, m: &Motion, rigid: &Array2<f64>, joint: usize) -> Self {
        let by = |which: usize, step: f64| {
            let mut out = Array2::zeros(rigid.dim());
            differences(robot, m, rigid, [joint, which], step, |i, change| {
                out.row_mut(i)
                    .iter_mut()
                    .zip(change)
                    .for_each(|(o, c)| *o = c);
            });
            out
        };
        Self {
            q: by(0, STEP),
            qd: by(1, STEP),
            qdd: by(2, 1.0),
        }
    }
}

/// Calls `take` at each sample with the change of all joints' torque per unit of a joint's position (0), velocity (1) or
/// acceleration (2), by a step of it.
fn differences(
    robot: &Robot,
    m: &Motion,
    rigid: &Array2<f64>,
    [joint, which]: [usize; 2],
    step: f64,
    mut take: impl FnMut(usize, &mut dyn Iterator<Item = f64>),
) {
    let mut workspace = Workspace::new(robot);
    let mut moved = vec![0.0; robot.dof()];
    let mut tau = vec![0.0; robot.dof()];
    for (i, rigid) in rigid.rows().into_iter().enumerate() {
        let mut at = [&m.q, &m.qd, &m.qdd].map(|t| {
            let all = t.as_slice().expect("tables are in standard layout");
            &all[i * t.ncols()..(i + 1) * t.ncols()]
        });
        moved.copy_from_slice(at[which]);
        moved[joint] += step;
        at[which] = &moved;
        inverse_dynamics(robot, &mut workspace, at[0], at[1], at[2], &mut tau);
        take(i, &mut tau.iter().zip(rigid).map(|(t, r)| (t - r) / step));
    }
}
