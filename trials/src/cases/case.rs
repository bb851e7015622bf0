//! A sealed case with its answer.

use super::truth::Truth;
use datasets::Recording;

/// A finished case.
#[derive(Debug, Clone)]
pub struct Case {
    /// Name: ten hexadecimal digits without meaning.
    pub id: String,
    /// The simulator's model.
    pub urdf: String,
    /// Training recording: 8 trajectories of 15 s at 250 Hz; for a hard case as given in its answer.
    pub train: Recording,
    /// Test recording: 4 trajectories recorded between those of training; for a hard case as given in its answer.
    pub test: Recording,
    /// Answer.
    pub truth: Truth,
}
