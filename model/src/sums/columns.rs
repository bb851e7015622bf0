//! Columns of each joint's factors.

use crate::identify::basic;
use ::identify::base::BaseParameters;
use physics::effects::Term;
use physics::robot::{PARAMETERS_PER_LINK, Robot};

/// Columns of all joints of a robot, whatever its recordings: base parameters that act on the joint, then its terms.
#[derive(Clone, Debug)]
pub(super) struct Columns {
    /// Robot whose columns they are.
    pub robot: Robot,
    /// Base parameters of the robot.
    pub base: BaseParameters,
    /// Terms of each joint.
    pub terms: Vec<Vec<Term>>,
}

impl Columns {
    /// Columns of a robot with the basic terms.
    pub fn of(robot: Robot) -> Self {
        Self {
            base: BaseParameters::of_robot(&robot, &[]),
            terms: basic::terms(&robot),
            robot,
        }
    }

    /// Indices of the base parameters that act on a joint: those of its own link and of the links behind it.
    pub fn acting(&self, joint: usize) -> Vec<usize> {
        let links = self.base.independent().iter().enumerate();
        links
            .filter(|(_, column)| *column / PARAMETERS_PER_LINK >= joint)
            .map(|(k, _)| k)
            .collect()
    }

    /// Number of columns of a joint's factors.
    pub fn width(&self, joint: usize) -> usize {
        self.acting(joint).len() + self.terms[joint].len()
    }
}
