//! Six rotating joints by recursive Newton–Euler, with rotors; friction of the robot's own description.

use super::carried::Carried;
use super::mechanics::{Friction, Plant};
use crate::MachineError;
use crate::description::Description;
use nalgebra::{Matrix3, Vector3};
use physics::dynamics::{Workspace, inverse_dynamics};
use physics::robot::{Inertia, Robot};

/// Where a body is held in the last joint's frame, m.
const CENTRE: Vector3<f64> = Vector3::new(0.03, 0.0, 0.1);

/// A serial chain.
pub(super) struct Puma {
    robot: Robot,
}

impl Puma {
    /// The description's robot.
    pub fn new(description: &Description, carried: &Carried) -> Result<Self, MachineError> {
        let name = description.geometry.robot.as_deref().unwrap_or_default();
        let robot = Robot::load(name, &[])?.0;
        if robot.dof() != description.axis.len() {
            return Err(description.wrong(format!("{} is no robot of six joints", robot.name())));
        }
        let mut joints = robot.joints().to_vec();
        if let Some(hand) = joints.last_mut() {
            let inertia = Matrix3::identity() * carried.inertia;
            let body = Inertia::from_com(carried.mass, CENTRE, inertia);
            hand.link.inertia = hand.link.inertia.plus(&body);
        }
        let gravity = robot.gravity();
        let robot = Robot::new(robot.name(), joints)?.with_gravity(gravity);
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
