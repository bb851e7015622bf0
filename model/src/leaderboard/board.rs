//! Results of a comparison of models.

use super::bootstrap::{Intervals, Stretches};
use super::entry::Entry;
use crate::baseline::published::{Part, Published, beside};
use crate::directory::ModelFile;
use crate::evaluation::Evaluation;
use serde::Serialize;

/// Contents of `eval --leaderboard --json`.
#[derive(Clone, Debug, Serialize)]
pub struct Leaderboard {
    /// Name and version of the format: `leaderboard/1`.
    pub schema: &'static str,
    /// Name of the recording on which all models are scored.
    pub recording: String,
    /// Name of the robot of the models.
    pub robot: String,
    /// Names of the robot's joints, base first.
    pub joints: Vec<String>,
    /// Number of samples of the recording.
    pub samples: usize,
    /// Number of trajectories of the recording.
    pub trajectories: usize,
    /// Method of the intervals of the scores.
    pub intervals: Intervals,
    /// Rows of torque from motion: every model, lowest mean NRMSE over all samples first.
    pub rows: Vec<Entry>,
    /// Rows of positions simulated from torque, in the same order; empty where no model does that.
    pub forward: Vec<Entry>,
    /// Models that were compared, with the conditions of their figures.
    pub models: Vec<Given>,
    /// Names of figures that another run does not repeat, since they are measured when the page is made.
    pub measured_when_made: [&'static str; 1],
    /// Published results among the rows.
    #[serde(skip)]
    pub published: Vec<&'static Published>,
}

/// Model directory to be compared, as given.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Given {
    /// Path of the model's directory.
    pub directory: String,
    /// Notes on the conditions of its figures, as text of `eval`.
    pub notes: Vec<String>,
}

impl Leaderboard {
    /// Leaderboard without rows, for the recording of `scored`.
    pub(super) fn empty(file: &ModelFile, scored: &Evaluation) -> Self {
        let parts = [Part::Test, Part::Train];
        Self {
            schema: "leaderboard/1",
            recording: scored.recording.source.clone(),
            robot: file.physics.robot.clone(),
            joints: file.joints.clone(),
            samples: scored.recording.len(),
            trajectories: scored.recording.trajectories.len(),
            intervals: Stretches::of(&scored.recording.segments()).intervals(),
            rows: Vec::new(),
            forward: Vec::new(),
            models: Vec::new(),
            measured_when_made: ["inference_us"],
            published: beside(file.physics.builtin, &parts),
        }
    }
}
