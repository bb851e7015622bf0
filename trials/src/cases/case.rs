//! A case as it is handed on.

use super::truth::Truth;
use datasets::Recording;

/// A finished case.
#[derive(Debug, Clone)]
pub struct Case {
    /// Name: ten hexadecimal digits that say nothing about it.
    pub id: String,
    /// The simulator's model.
    pub urdf: String,
    /// Recording to fit on: 8 trajectories of 15 s at 250 Hz, of a hard case as its answer says.
    pub train: Recording,
    /// Recording to be judged on: 4 trajectories in between, of a hard case as its answer says.
    pub test: Recording,
    /// The answer.
    pub truth: Truth,
}
