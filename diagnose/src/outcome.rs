//! Result of a diagnosis, with all intermediate results behind it.

use crate::input::frames::Frames;
use crate::measure::explain::Explanation;
use crate::measure::learned::Learned;
use crate::schema::Diagnosis;
use crate::search::find::Findings;
use crate::traces::unknown::Misfit;

/// Result of a diagnosis: the report and the intermediate results that it is made of.
pub struct Outcome {
    /// Report of the diagnosis, as it is written to JSON.
    pub diagnosis: Diagnosis,
    /// Search on which the report is based.
    pub findings: Findings,
    /// Prepared recordings, fitted and held out.
    pub frames: Frames,
    /// The measured explanation.
    pub explanation: Explanation,
    /// Compensator trained on the residual after the causes, where one was asked for.
    pub learned: Option<Learned>,
    /// Structure in the residual of each joint on the fitted recording; none where it was not judged.
    pub left: Vec<Option<Misfit>>,
    /// Findings of link encoders and thermometers beside the causes, a line each; also among the diagnosis's notes.
    pub sensors: Vec<String>,
}
