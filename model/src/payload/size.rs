//! Prior on the body from what the robot could carry, for parameters that no row determines.

use physics::robot::Robot;

/// Size of the largest body that the robot could carry. It is the prior deviation of the body's parameters.
pub(super) struct Size {
    /// Mass of the largest body, kg.
    pub(super) mass: f64,
    /// Distance of the body's centre of mass from the last joint, m.
    pub(super) length: f64,
}

impl Size {
    /// Size of a body as heavy as the whole robot, as far from its last joint as the arm is long.
    pub(super) fn of(robot: &Robot) -> Self {
        let links = robot.joints().iter();
        let mass: f64 = links.clone().map(|j| j.link.inertia.mass.abs()).sum();
        let length: f64 = links.map(|j| j.translation.norm()).sum();
        Self {
            mass: mass.max(10.0),
            length: length.max(0.5),
        }
    }
}
