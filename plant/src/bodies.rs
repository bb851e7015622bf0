//! Moving bodies: their mass matrix, and the torque of a state without acceleration.

use physics::dynamics::{Workspace, inverse_dynamics, mass_matrix};
use physics::robot::Robot;

/// Bodies of N joints, M(q) a + b(q, v) = τ, without friction; N values each, SI.
pub trait Bodies: Send {
    /// Number of joints N of the robot.
    fn dof(&self) -> usize;

    /// Fills M(q), N × N, row-major.
    fn mass(&mut self, q: &[f64], mass: &mut [f64]);

    /// Fills b(q, v): centrifugal, Coriolis and gravity torques.
    fn bias(&mut self, q: &[f64], v: &[f64], bias: &mut [f64]);
}

/// A serial arm of rigid bodies.
pub struct Chain {
    robot: Robot,
    workspace: Workspace,
    zero: Vec<f64>,
}

impl Chain {
    /// Bodies of a serial robot.
    pub fn new(robot: Robot) -> Self {
        Self {
            workspace: Workspace::new(&robot),
            zero: vec![0.0; robot.dof()],
            robot,
        }
    }
}

impl Bodies for Chain {
    fn dof(&self) -> usize {
        self.robot.dof()
    }

    fn mass(&mut self, q: &[f64], mass: &mut [f64]) {
        mass_matrix(&self.robot, &mut self.workspace, q, mass);
    }

    fn bias(&mut self, q: &[f64], v: &[f64], bias: &mut [f64]) {
        let Self {
            robot,
            workspace,
            zero,
        } = self;
        inverse_dynamics(robot, workspace, q, v, zero, bias);
    }
}
