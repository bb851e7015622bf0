//! Six rotating joints by recursive Newton–Euler, with rotors; friction of the robot's own description.

use super::mechanics::{Friction, Plant};
use crate::MachineError;
use crate::description::Description;
use physics::dynamics::{Workspace, inverse_dynamics};
use physics::robot::Robot;

/// A serial chain.
pub(super) struct Puma {
    robot: Robot,
}

impl Puma {
    /// The description's robot.
    pub fn new(description: &Description) -> Result<Self, MachineError> {
        let name = description.geometry.robot.as_deref().unwrap_or_default();
        let robot = Robot::load(name, &[])?.0;
        if robot.dof() != description.axis.len() {
            return Err(description.wrong(format!("{} is no robot of six joints", robot.name())));
        }
        Ok(Self { robot })
    }
}

impl Plant for Puma {
    fn torque(&self, q: &[f64], qd: &[f64], qdd: &[f64]) -> Vec<f64> {
        let mut torque = vec![0.0; self.robot.dof()];
        let mut workspace = Workspace::new(&self.robot);
        inverse_dynamics(&self.robot, &mut workspace, q, qd, qdd, &mut torque);
        let rotors = self.robot.rotor_inertia();
        for (t, (rotor, a)) in torque.iter_mut().zip(rotors.iter().zip(qdd)) {
            *t += rotor * a;
        }
        torque
    }

    fn friction(&self) -> Vec<Friction> {
        let joints = self.robot.joints().iter();
        joints
            .map(|joint| Friction {
                viscous: joint.damping,
                coulomb: joint.friction,
                soft: 0.001,
            })
            .collect()
    }
}
