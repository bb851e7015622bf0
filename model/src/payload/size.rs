//! What no row tells is held within what a robot could carry.

use physics::robot::Robot;

/// How large a body the robot could carry: what a figure that no row tells is held within.
pub(super) struct Size {
    /// kg.
    pub(super) mass: f64,
    /// m.
    pub(super) length: f64,
}

impl Size {
    /// A body as heavy as the whole robot, as far from its last joint as the arm is long.
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
