//! Units of a recording.

use serde::{Deserialize, Serialize};

/// Units of a recording's columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Units {
    /// Unit of the `time` column.
    pub time: TimeUnit,
    /// Unit of positions, velocities and accelerations of rotating joints.
    pub angle: AngleUnit,
    /// Unit of the torque columns.
    pub torque: TorqueUnit,
}

/// Unit of a time column.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum TimeUnit {
    /// Seconds, the default unit of time.
    #[default]
    S,
    /// Milliseconds as unit of time.
    Ms,
    /// Microseconds as unit of time.
    Us,
    /// Nanoseconds as unit of time.
    Ns,
}

/// Unit of position, velocity and acceleration columns of joints that turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum AngleUnit {
    /// Radians, the default unit of angles.
    #[default]
    Rad,
    /// Degrees as unit of angles.
    Deg,
}

/// Quantity and unit of a torque column.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum TorqueUnit {
    /// Torque on the link side of the gear, N·m or N.
    #[default]
    Link,
    /// Torque of the motor, N·m.
    Motor,
    /// Current of the motor, A.
    Current,
    /// Current of the motor, per mille of its rated current (CiA 402, object 6078h).
    Rated,
    /// Current of the motor, per cent of its rated current.
    Percent,
}

impl TorqueUnit {
    /// Fraction of the rated current per unit of the column; 1 where the unit does not refer to a rated current.
    pub(super) fn part_of_rated(self) -> f64 {
        match self {
            Self::Rated => 1e-3,
            Self::Percent => 1e-2,
            Self::Link | Self::Motor | Self::Current => 1.0,
        }
    }

    /// Name of the unit in the drive file.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Link => "link",
            Self::Motor => "motor",
            Self::Current => "current",
            Self::Rated => "rated",
            Self::Percent => "percent",
        }
    }
}
