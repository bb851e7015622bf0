//! Properties of driven axes that a drive file refers to.

use crate::robot::Robot;

/// A joint or axis with a motor.
#[derive(Debug, Clone, PartialEq)]
pub struct DrivenAxis {
    /// Name of the axis, for messages.
    pub name: String,
    /// Whether its position is an angle.
    pub rotates: bool,
    /// Motor turns per joint turn (motor rad per m of a linear axis), where known.
    pub gear_ratio: Option<f64>,
    /// Motor torque per current, N·m/A, where known.
    pub torque_constant: Option<f64>,
}

/// Machine with driven axes: a [`Robot`], or one that is not a serial chain.
pub trait Driven {
    /// Name of the machine, for messages.
    fn name(&self) -> &str;

    /// The axes in the order of a recording's columns.
    fn axes(&self) -> Vec<DrivenAxis>;
}

impl Driven for Robot {
    fn name(&self) -> &str {
        self.name()
    }

    fn axes(&self) -> Vec<DrivenAxis> {
        let joints = self.joints().iter();
        joints
            .map(|joint| DrivenAxis {
                name: joint.name.clone(),
                rotates: joint.kind.is_rotation(),
                gear_ratio: joint.gear_ratio,
                torque_constant: joint.torque_constant,
            })
            .collect()
    }
}
