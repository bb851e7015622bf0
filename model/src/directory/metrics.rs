//! Scores beside a model: `metrics.json`.

use super::base_parameter::BaseParameter;
use crate::identify::diagnostics::Diagnostics;
use datasets::metrics::Row;
use serde::Serialize;

/// Version of `metrics.json`.
pub const SCHEMA: &str = "metrics/1";

/// Contents of `metrics.json`.
#[derive(Serialize)]
pub struct Metrics {
    /// [`SCHEMA`].
    pub schema: &'static str,
    /// Joint names.
    pub joints: Vec<String>,
    /// Scores of the training recordings.
    pub train: Vec<Row>,
    /// Scores of the held-out one.
    pub heldout: Option<Vec<Row>>,
    /// Identified parameters.
    pub base_parameters: Vec<BaseParameter>,
    /// How well they stand.
    pub diagnostics: Option<Diagnostics>,
    /// Each member of the ensembles alone on the held-out recording.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub members: Vec<Member>,
}

/// Mean NRMSE of one seed.
#[derive(Serialize)]
pub struct Member {
    /// Index.
    pub member: usize,
    /// Over all samples.
    pub mean_nrmse: Option<f64>,
    /// In motion.
    pub mean_nrmse_moving: Option<f64>,
}
