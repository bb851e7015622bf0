//! What a diagnosis comes to, with everything behind it.

use crate::input::frames::Frames;
use crate::measure::explain::Explanation;
use crate::measure::learned::Learned;
use crate::schema::Diagnosis;
use crate::search::find::Findings;
use crate::traces::unknown::Misfit;

/// Everything a report is made of.
pub struct Outcome {
    /// The report.
    pub diagnosis: Diagnosis,
    /// The search behind it.
    pub findings: Findings,
    /// Prepared recordings.
    pub frames: Frames,
    /// The measured explanation.
    pub explanation: Explanation,
    /// The compensator on what the causes leave, where one was asked for.
    pub learned: Option<Learned>,
    /// What has structure of what is left, per joint, on the fitted recording.
    pub left: Vec<Option<Misfit>>,
    /// What link encoders and thermometers show beside the causes, a line each; among the diagnosis's notes, too.
    pub sensors: Vec<String>,
}
