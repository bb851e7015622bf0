//! A robot as its description has it.

use super::Model;
use physics::dynamics::{Workspace, inverse_dynamics};
use physics::robot::Robot;
use plant::reference::Command;

/// Bodies, rotors, counterbalance and springs, viscous and Coulomb friction of a description.
pub struct Nominal {
    robot: Robot,
    workspace: Workspace,
}

/// Speed below which the sign of Coulomb friction is softened, rad/s or m/s.
const SOFT: f64 = 0.002;

impl Nominal {
    /// Of a robot.
    pub fn new(robot: &Robot) -> Self {
        Self {
            workspace: Workspace::new(robot),
            robot: robot.clone(),
        }
    }
}

impl Model for Nominal {
    fn dof(&self) -> usize {
        self.robot.dof()
    }

    fn rigid(&mut self, q: &[f64], qd: &[f64], qdd: &[f64], tau: &mut [f64]) {
        inverse_dynamics(&self.robot, &mut self.workspace, q, qd, qdd, tau);
        for (j, joint) in self.robot.joints().iter().enumerate() {
            tau[j] += joint.rotor_inertia * qdd[j];
        }
        for passive in self.robot.passive() {
            let j = passive.joint();
            tau[j] += passive.torque(q[j]);
        }
    }

    fn physics(&mut self, motion: &Command, tau: &mut [f64]) {
        self.rigid(&motion.q, &motion.qd, &motion.qdd, tau);
        for (j, joint) in self.robot.joints().iter().enumerate() {
            let v = motion.qd[j];
            tau[j] += joint.damping * v + joint.friction * v / v.hypot(SOFT);
        }
    }

    fn compensated(&mut self, motion: &Command, tau: &mut [f64]) {
        self.physics(motion, tau);
    }

    fn has_compensator(&self) -> bool {
        false
    }

    fn reset(&mut self) {}
}
