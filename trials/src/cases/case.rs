//! A sealed case with its answer.

use super::truth::Truth;
use datasets::Recording;

/// Finished case: description, recordings and answer.
#[derive(Debug, Clone)]
pub struct Case {
    /// Name: ten hexadecimal digits without meaning.
    pub id: String,
    /// Description of the robot, the simulator's model.
    pub urdf: String,
    /// Training recording: 8 trajectories of 15 s at 250 Hz; for a hard case as given in its answer.
    pub train: Recording,
    /// Test recording: 4 trajectories recorded between those of training; for a hard case as given in its answer.
    pub test: Recording,
    /// Sealed answer of the case.
    pub truth: Truth,
}
