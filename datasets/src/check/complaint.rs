//! What is wrong with a torque channel, and what mends it.

use super::finding::Severity;
use serde::Serialize;

/// Kind of fault of a recorded torque: a reason why it is not the torque of the drives seen from the link.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Ailment {
    /// No signal in the torque, for some time or throughout.
    Dead,
    /// Torque without its sign.
    Absolute,
    /// Torque less what gravity takes.
    GravityRemoved,
    /// Motor current instead of a torque, A.
    Current,
    /// Per cent of a rated current or torque.
    Percent,
    /// Per mille of a rated current or torque.
    PerMille,
    /// Torque of the motor, before the gear.
    Motor,
    /// Torque times some other factor.
    Scale,
    /// The opposite sign of the motion's.
    Sign,
    /// Torque from a sensor behind the gear, which does not see the friction of motor and gear.
    JointSensor,
    /// Asked for or computed: no sensor's noise.
    Commanded,
    /// Torque in coarse steps.
    Quantised,
    /// Torque that was low-passed before it was stored.
    Filtered,
    /// Torque cut at a limit.
    Saturated,
    /// Torque in order: the description's masses are wrong.
    Description,
    /// Torque in order: columns of joints are exchanged.
    Columns,
    /// Torque in order: the position of a joint counts backwards.
    Turned,
}

impl Ailment {
    /// Subject of the complaint, in words: the torque, or what else explains it.
    pub fn title(self) -> String {
        match self {
            Self::Description => "the description".to_owned(),
            Self::Columns | Self::Turned => "the columns".to_owned(),
            _ => format!("torque, {}", self.name().replace('_', " ")),
        }
    }

    /// Name of the fault, as in JSON.
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
    /// Indices of the joints that the complaint concerns, from 0.
    pub joints: Vec<usize>,
    /// Observation behind the complaint, with its numbers.
    pub seen: String,
    /// Meaning of what was seen, as a sentence.
    pub means: String,
    /// Lines of the drive file that mend the fault; null where none can.
    pub drive: Option<String>,
    /// Advice on what to do besides, or instead.
    pub advice: String,
}
