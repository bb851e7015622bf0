//! Faults of a torque channel.

use serde::Serialize;

/// What is wrong with a recorded torque.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Fault {
    /// Nothing: torque of the motors, seen from the link.
    None,
    /// Without its sign.
    Absolute,
    /// The sign of some joints is turned.
    Sign,
    /// Motor current, A.
    Current,
    /// Per cent of the rated torque.
    Percent,
    /// Torque at the motor, before the gear.
    Motor,
    /// Less what gravity takes, by the maker's model.
    GravityRemoved,
    /// By sensors behind the gears.
    JointSensor,
    /// What the controller asks for, not what a sensor sees.
    Commanded,
    /// In coarse steps.
    Quantised,
    /// Low-passed forwards and backwards before it was stored.
    Filtered,
    /// A channel without signal.
    Dead,
    /// Cut at a limit.
    Saturated,
}

impl Fault {
    /// All of them.
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

    /// Name, as in JSON.
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

    /// Whether it can be that of some joints alone.
    pub fn by_joint(self) -> bool {
        matches!(self, Self::Sign | Self::Dead | Self::Saturated)
    }
}
