//! Values of a controller as the drive file writes them.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A value of the controller that has one number per joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Key {
    /// Torque per error, N·m/rad (N/m); of a cascade: velocity per error, 1/s.
    Kp,
    /// Torque per error of velocity, N·m·s/rad (N·s/m).
    Kd,
    /// Torque per integral of the error, N·m/(rad·s) (N/(m·s)).
    Ki,
    /// Torque per error of velocity of a cascade, N·m·s/rad (N·s/m).
    KpVelocity,
    /// Torque of a cascade per integral of the velocity error, N·m/rad (N/m).
    KiVelocity,
    /// Torque at standstill per error, N·m/rad (N/m).
    TorquePerError,
    /// Torque lost per velocity to back-EMF, N·m·s/rad (N·s/m).
    BackEmf,
    /// Torque at standstill under the full supply voltage, N·m (N).
    Voltage,
    /// Largest torque that the drive gives, N·m (N).
    Limit,
    /// Time by which commands reach the drive late, s.
    Delay,
}

/// One number for all joints, or one by joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "a number, or a list with one number per joint, is needed"
)]
pub enum PerJoint {
    /// One number for all joints.
    All(f64),
    /// One number per joint, base first.
    Each(Vec<f64>),
}

/// Relative tolerance of given values.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "a number, or a table of numbers by key ({ kp = 0.1, kd = 0.3 }), is needed"
)]
pub enum Tolerance {
    /// Tolerance of every value.
    All(f64),
    /// Tolerance of each key; values of other keys are exact.
    ByKey(BTreeMap<Key, f64>),
}

impl Default for Tolerance {
    fn default() -> Self {
        Self::All(0.0)
    }
}

/// Set point of a drive between two commands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Interpolation {
    /// Last command, held until the next one.
    #[default]
    Hold,
    /// Straight lines from command to command.
    Linear,
}

/// State of the drive's own gravity compensation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "gravity_compensation is true, false or \"unknown\""
)]
pub enum GravityCompensation {
    /// Known state: on or off.
    Known(bool),
    /// Gravity compensation of which nobody knows whether it is on or off: `"unknown"` in the drive file. `replay` fits the
    /// compensated part.
    Unknown(Unknown),
}

/// The word `unknown` of a drive file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Unknown {
    /// Literal word `"unknown"`.
    Unknown,
}

impl Default for GravityCompensation {
    fn default() -> Self {
        Self::Known(false)
    }
}

impl GravityCompensation {
    /// Whether the drive compensates gravity; none where it is not known.
    pub fn known(self) -> Option<bool> {
        match self {
            Self::Known(on) => Some(on),
            Self::Unknown(_) => None,
        }
    }
}

impl Key {
    /// All keys of the controller with one number per joint.
    pub const ALL: [Self; 10] = [
        Self::Kp,
        Self::Kd,
        Self::Ki,
        Self::KpVelocity,
        Self::KiVelocity,
        Self::TorquePerError,
        Self::BackEmf,
        Self::Voltage,
        Self::Limit,
        Self::Delay,
    ];

    /// Name of the key in the drive file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Kp => "kp",
            Self::Kd => "kd",
            Self::Ki => "ki",
            Self::KpVelocity => "kp_velocity",
            Self::KiVelocity => "ki_velocity",
            Self::TorquePerError => "torque_per_error",
            Self::BackEmf => "back_emf",
            Self::Voltage => "voltage",
            Self::Limit => "limit",
            Self::Delay => "delay",
        }
    }

    /// Whether values of this key must be above zero: a gain or limit of zero moves nothing.
    pub(super) fn positive(self) -> bool {
        !matches!(
            self,
            Self::Kd | Self::KiVelocity | Self::BackEmf | Self::Delay
        )
    }
}
