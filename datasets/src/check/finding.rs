//! What a check is told, and what it finds.

use crate::channel::Estimate95;
use serde::Serialize;

/// Facts about the robot by which a recording is judged. All are optional.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CheckOptions {
    /// Names of the joints, base first. Missing names are replaced by `joint 1` ….
    pub joints: Vec<String>,
    /// Lower and upper joint limits in rad (m), base first; infinite where a joint has no limit.
    pub position_limits: Vec<[f64; 2]>,
    /// Joints that slide, base first: their way is in m, their torque a force in N. Joints beyond its end turn.
    pub slides: Vec<bool>,
}

/// Severity of a finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Severity {
    /// Fact that is worth knowing.
    Note,
    /// Some results will be poor.
    Warning,
    /// Results for this joint, or all, cannot be trusted.
    Severe,
}

/// Kind of what a check found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// Joint that never moves.
    NeverMoves,
    /// The joint moves too slowly to tell viscous from Coulomb friction.
    TooSlow,
    /// The torque is cut at a plateau: the motion asks for more than the drive gives.
    TorquePlateau,
    /// Fewer than three cycles of the joint.
    TooShort,
    /// The joint covers too little of its range.
    RegionTooSmall,
    /// The torque is not of the size that the robot's model expects.
    TorqueScale,
    /// A channel is constant, or stands still while the joint moves.
    DeadChannel,
    /// Positions leave the joint limits as if their unit or zero were wrong.
    PositionScale,
    /// The recorded velocity is not the derivative of the position.
    VelocityMismatch,
    /// A value jumps away and back within one sample.
    CorruptRow,
    /// Time jumps inside a trajectory.
    ClockJump,
    /// Jitter of the time stamps.
    Jitter,
    /// Torque and motion are shifted in time.
    TorqueShift,
    /// The motion does not tell some parameters from others.
    PoorConditioning,
    /// The commanded motion is in another unit or of another time.
    Command,
    /// The reader had to choose.
    Reading,
}

/// Finding of a check on a recording.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// Kind of the finding.
    pub kind: Kind,
    /// Severity of the finding.
    pub severity: Severity,
    /// Index of the joint; `None` for the whole recording.
    pub joint: Option<usize>,
    /// Number of the data row, from 1, where the finding is about one.
    pub row: Option<usize>,
    /// Value behind the finding, in the unit that `message` names.
    pub value: f64,
    /// Names of the parameters that suffer; empty where the finding is about something else.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub parameters: Vec<String>,
    /// Message on what is wrong and what to do, as a sentence.
    pub message: String,
}

/// Figures of one joint in a recording.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct JointFigures {
    /// Name of the joint.
    pub name: String,
    /// Smallest and largest position in rad (m).
    pub range: [f64; 2],
    /// Largest speed in rad/s (m/s).
    pub top_speed: f64,
    /// Cycles: half the number of reversals.
    pub cycles: f64,
    /// Part of the samples with |q̇| > 0.01.
    pub share_moving: f64,
    /// Root mean square torque, N·m (N).
    pub torque_rms: Option<f64>,
    /// Largest torque in N·m (N).
    pub torque_max: Option<f64>,
    /// Recorded velocity behind the derivative of the position, s, where velocity was recorded.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub velocity_delay: Option<Estimate95>,
}

impl Finding {
    /// Finding for a note of the reader.
    pub(super) fn reading(note: &str) -> Self {
        Self {
            kind: Kind::Reading,
            severity: Severity::Note,
            joint: None,
            row: None,
            value: 0.0,
            parameters: Vec::new(),
            message: format!("{note}."),
        }
    }
}
