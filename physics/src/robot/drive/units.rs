//! Units of a recording.

use serde::{Deserialize, Serialize};

/// Units of a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Units {
    /// Of `time`.
    pub time: TimeUnit,
    /// Of positions, velocities and accelerations of rotating joints.
    pub angle: AngleUnit,
    /// What the torque columns hold.
    pub torque: TorqueUnit,
}

/// Unit of time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum TimeUnit {
    /// Seconds.
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
    /// Radians.
    #[default]
    Rad,
    /// Degrees.
    Deg,
}

/// What a torque column holds.
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
    /// The same in per cent.
    Percent,
}

impl TorqueUnit {
    /// One step of it as a part of the rated current; 1 where it is no such part.
    pub(super) fn part_of_rated(self) -> f64 {
        match self {
            Self::Rated => 1e-3,
            Self::Percent => 1e-2,
            Self::Link | Self::Motor | Self::Current => 1.0,
        }
    }

    /// As the file names it.
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
