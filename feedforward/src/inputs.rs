//! Inputs of a compensator's units.

use physics::effects::Term;
use serde::{Deserialize, Serialize};

/// One input column, in physical units.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Input {
    /// Index of the joint to which the column belongs, base first.
    pub joint: usize,
    /// Signal of the joint in the column.
    pub signal: Signal,
}

/// Signal of one joint that a unit may see.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Signal {
    /// Position q, rad or m.
    Position,
    /// Velocity q̇, rad/s or m/s.
    Velocity,
    /// Acceleration q̈, rad/s² or m/s².
    Acceleration,
    /// Size of the rigid-body torque, N·m or N.
    Load,
    /// Column of a physical term with its memory.
    Term(Term),
}

impl Input {
    /// Readable name, such as `dahl(1.000e4) of joint 2`.
    pub fn name(&self) -> String {
        let what = match &self.signal {
            Signal::Position => "q".to_owned(),
            Signal::Velocity => "qd".to_owned(),
            Signal::Acceleration => "qdd".to_owned(),
            Signal::Load => "load".to_owned(),
            Signal::Term(term) => term.label(),
        };
        format!("{what} of joint {}", self.joint + 1)
    }
}

/// Record of the compensator in `model.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CompensatorRecord {
    /// Input columns, in the order in which the units index them.
    pub inputs: Vec<Input>,
    /// Time between the samples of a window, s.
    pub period: f64,
    /// SHA-256 of `compensator.safetensors`.
    pub sha256: String,
    /// Validation errors of each unit on the trajectories held back, N·m.
    pub validation: Vec<UnitValidation>,
}

/// Errors of one unit on the validation trajectories.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct UnitValidation {
    /// Name of the unit's joint.
    pub joint: String,
    /// Whether the unit is on in the loop.
    pub enabled: bool,
    /// RMS error of the physics alone on the validation trajectories, N·m.
    pub physics: Option<f64>,
    /// RMS error with the unit on the validation trajectories, N·m.
    pub with_unit: Option<f64>,
    /// RMS error on the validation trajectories with a ridge regression on the same inputs in place of the unit, N·m.
    pub with_ridge: Option<f64>,
    /// Motion of other joints that the unit also sees, because the residual follows it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub companions: Vec<Input>,
}

impl UnitValidation {
    /// Motion of other joints that the unit also sees, in words; none where it sees its own joint's motion alone.
    pub fn sees(&self) -> Option<String> {
        let others: Vec<String> = self.companions.iter().map(Input::name).collect();
        (!others.is_empty()).then(|| others.join(" and "))
    }
}
