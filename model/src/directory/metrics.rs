//! `metrics.json`: scores of a model.

use super::base_parameter::BaseParameter;
use crate::identify::diagnostics::Diagnostics;
use datasets::metrics::Row;
use serde::Serialize;

/// Version of `metrics.json`.
pub const SCHEMA: &str = "metrics/1";

/// Contents of `metrics.json`.
#[derive(Serialize)]
pub struct Metrics {
    /// Name and version of the format: [`SCHEMA`].
    pub schema: &'static str,
    /// Names of the robot's joints, base first.
    pub joints: Vec<String>,
    /// Scores of the training recordings.
    pub train: Vec<Row>,
    /// Scores of the held-out recording.
    pub heldout: Option<Vec<Row>>,
    /// Identified base parameters with their deviations.
    pub base_parameters: Vec<BaseParameter>,
    /// Quality of the identification.
    pub diagnostics: Option<Diagnostics>,
    /// Scores of each member of the ensembles alone, on the held-out recording.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub members: Vec<Member>,
}

/// Mean NRMSE of one member of the ensembles (one seed).
#[derive(Serialize)]
pub struct Member {
    /// Index of the member in each ensemble.
    pub member: usize,
    /// Mean NRMSE over all samples.
    pub mean_nrmse: Option<f64>,
    /// Mean over joints of the NRMSE in motion.
    pub mean_nrmse_moving: Option<f64>,
}
