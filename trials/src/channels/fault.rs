//! Faults of a torque channel.

use serde::Serialize;

/// Fault of a recorded torque.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Fault {
    /// Healthy channel: motor torque, seen from the link.
    None,
    /// Torque without its sign, as an absolute value.
    Absolute,
    /// Torque whose sign is turned on some joints.
    Sign,
    /// Motor current in place of a torque, A.
    Current,
    /// Torque in per cent of the rated torque.
    Percent,
    /// Torque at the motor, before the gear.
    Motor,
    /// Torque less that of gravity by the maker's model.
    GravityRemoved,
    /// Torque of sensors behind the gears.
    JointSensor,
    /// Torque command of the controller, not a sensor's value.
    Commanded,
    /// Torque rounded to coarse steps.
    Quantised,
    /// Torque that was low-passed forwards and backwards before it was stored.
    Filtered,
    /// A channel without signal.
    Dead,
    /// Torque cut at a limit.
    Saturated,
}

impl Fault {
    /// All faults, the healthy channel first.
    pub const ALL: [Self; 13] = [
        Self::None,
        Self::Absolute,
        Self::Sign,
        Self::Current,
        Self::Percent,
        Self::Motor,
        Self::GravityRemoved,
        Self::JointSensor,
        Self::Commanded,
        Self::Quantised,
        Self::Filtered,
        Self::Dead,
        Self::Saturated,
    ];

    /// Name of the fault, as in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Absolute => "absolute",
            Self::Sign => "sign",
            Self::Current => "current",
            Self::Percent => "percent",
            Self::Motor => "motor",
            Self::GravityRemoved => "gravity_removed",
            Self::JointSensor => "joint_sensor",
            Self::Commanded => "commanded",
            Self::Quantised => "quantised",
            Self::Filtered => "filtered",
            Self::Dead => "dead",
            Self::Saturated => "saturated",
        }
    }

    /// Whether the fault can be that of some joints alone.
    pub fn by_joint(self) -> bool {
        matches!(self, Self::Sign | Self::Dead | Self::Saturated)
    }
}
