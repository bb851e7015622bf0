//! Units of a recording.

use serde::{Deserialize, Serialize};

/// Units of a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Units {
    /// Unit of `time`.
    pub time: TimeUnit,
    /// Unit of positions, velocities and accelerations of rotating joints.
    pub angle: AngleUnit,
    /// Unit of the torque columns.
    pub torque: TorqueUnit,
}

/// Unit of time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum TimeUnit {
    /// Seconds, the default.
    #[default]
    S,
    /// Milliseconds.
    Ms,
    /// Microseconds.
    Us,
    /// Nanoseconds.
    Ns,
}

/// Unit of angles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum AngleUnit {
    /// Radians, the default.
    #[default]
    Rad,
    /// Degrees.
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
    /// Fraction of the rated current per unit of the column; 1 where the column is no such fraction.
    pub(super) fn part_of_rated(self) -> f64 {
        match self {
            Self::Rated => 1e-3,
            Self::Percent => 1e-2,
            Self::Link | Self::Motor | Self::Current => 1.0,
        }
    }

    /// Name in the drive file.
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
