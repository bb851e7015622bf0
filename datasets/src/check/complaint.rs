//! What is wrong with a torque channel, and what mends it.

use super::finding::Severity;
use serde::Serialize;

/// What a recorded torque is, where it is not the torque of the drives seen from the link.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Ailment {
    /// No signal, for some time or throughout.
    Dead,
    /// Without sign.
    Absolute,
    /// What gravity takes is taken off.
    GravityRemoved,
    /// Motor current, A.
    Current,
    /// Per cent of a rated current or torque.
    Percent,
    /// Per mille of it.
    PerMille,
    /// Torque of the motor, before the gear.
    Motor,
    /// Some other factor.
    Scale,
    /// The opposite sign of the motion's.
    Sign,
    /// By a sensor behind the gear, which sees no friction of motor and gear.
    JointSensor,
    /// Asked for or computed: no sensor's noise.
    Commanded,
    /// In coarse steps.
    Quantised,
    /// Low-passed before it was stored.
    Filtered,
    /// Cut at a limit.
    Saturated,
    /// Not the torque: the description's masses.
    Description,
    /// Not the torque: columns of joints are exchanged.
    Columns,
    /// Not the torque: the position of a joint counts backwards.
    Turned,
}

impl Ailment {
    /// What it is about, in words: the torque, or what else explains it.
    pub fn title(self) -> String {
        match self {
            Self::Description => "the description".to_owned(),
            Self::Columns | Self::Turned => "the columns".to_owned(),
            _ => format!("torque, {}", self.name().replace('_', " ")),
        }
    }

    /// Name, as in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Self::Dead => "dead",
            Self::Absolute => "absolute",
            Self::GravityRemoved => "gravity_removed",
            Self::Current => "current",
            Self::Percent => "percent",
            Self::PerMille => "per_mille",
            Self::Motor => "motor",
            Self::Scale => "scale",
            Self::Sign => "sign",
            Self::JointSensor => "joint_sensor",
            Self::Commanded => "commanded",
            Self::Quantised => "quantised",
            Self::Filtered => "filtered",
            Self::Saturated => "saturated",
            Self::Description => "description",
            Self::Columns => "columns",
            Self::Turned => "turned",
        }
    }
}

/// One complaint of the torque channel's doctor.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Complaint {
    /// Fault of the torque channel.
    pub ailment: Ailment,
    /// Severity of the complaint.
    pub severity: Severity,
    /// The joints that it concerns, from 0.
    pub joints: Vec<usize>,
    /// What was seen, with its numbers.
    pub seen: String,
    /// Meaning of what was seen, as a sentence.
    pub means: String,
    /// Lines of the drive file that mend it; null where none can.
    pub drive: Option<String>,
    /// What else to do, or to do instead.
    pub advice: String,
}
