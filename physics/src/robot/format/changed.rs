//! New numbers for a description.

use crate::robot::{Inertia, Robot};
use nalgebra::Vector3;

/// A load that a description gets as a body of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load {
    /// Index of the joint whose link carries the load.
    pub link: usize,
    /// Inertia in that link's frame.
    pub inertia: Inertia,
}

/// A robot's new numbers for its description.
#[derive(Clone, Debug)]
pub struct Changed<'a> {
    /// The robot without its load.
    pub robot: &'a Robot,
    /// Correction of each joint's zero, rad or m: q_true = q + zero. Empty for none.
    pub zeros: &'a [f64],
    /// Rotation vector by which the base is tilted, rad. An MJCF has it in its gravity instead.
    pub tilt: Vector3<f64>,
    /// Load at the robot; none without one.
    pub load: Option<Load>,
}

impl<'a> Changed<'a> {
    /// Numbers of `robot` alone, without new zeros, tilt or load.
    pub fn of(robot: &'a Robot) -> Self {
        Self {
            robot,
            zeros: &[],
            tilt: Vector3::zeros(),
            load: None,
        }
    }

    /// Correction of joint `j`'s zero, rad or m.
    pub(super) fn zero(&self, j: usize) -> f64 {
        self.zeros.get(j).copied().unwrap_or(0.0)
    }
}

/// A name for the load's body that a description does not have yet.
pub(super) fn load_name(taken: impl Fn(&str) -> bool) -> String {
    let mut name = "payload".to_owned();
    while taken(&name) {
        name.push('_');
    }
    name
}
