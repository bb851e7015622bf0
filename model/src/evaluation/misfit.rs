//! Warning where a model does not fit the recording that it is scored on.

use super::Evaluation;
use crate::directory::ModelFile;
use datasets::metrics::Scope;

/// Error over the stated standard deviation from which a model does not fit: where it does, errors beyond three
/// deviations are rare, and their root mean square is near one.
const BEYOND: f64 = 3.0;

impl Evaluation {
    /// Warning that names the joints where the model predicts worse than the torque's own mean, or where its error is
    /// far beyond what its training let expect, with the likely reasons. None where there is no such joint.
    pub(super) fn misfit(&self, file: &ModelFile) -> Option<String> {
        let own = if file.compensator.is_some() {
            "physics+compensator"
        } else {
            "physics"
        };
        let rows = &self.report.rows;
        let scores = &rows
            .iter()
            .find(|r| r.name == own && r.scope == Scope::All)?
            .scores;
        let [mut useless, mut beyond] = [Vec::new(), Vec::new()];
        for (j, joint) in file.joints.iter().enumerate() {
            let (Some(rmse), Some(nrmse)) = (scores.rmse[j], scores.nrmse[j]) else {
                continue;
            };
            let stated = self.deviation.column(j).mapv(|s| s * s).mean();
            let times = rmse / stated.map_or(f64::NAN, f64::sqrt);
            if nrmse > 1.0 {
                useless.push(format!("{joint} (NRMSE {nrmse:.2})"));
            } else if times > BEYOND {
                beyond.push(format!("{joint} ({times:.1} times)"));
            }
        }
        let mut seen = Vec::new();
        if !useless.is_empty() {
            seen.push(format!(
                "it predicts worse than the torque's own mean on {}",
                useless.join(", ")
            ));
        }
        if !beyond.is_empty() {
            seen.push(format!(
                "its error is over {BEYOND} times what it states, by its training, on {}",
                beyond.join(", ")
            ));
        }
        if seen.is_empty() {
            return None;
        }
        Some(format!(
            "Warning: the model does not fit this recording: {}. Likely reasons: another robot or another tool; other units or signs; joints \
             in another order; motion outside what it was trained on.",
            seen.join("; ")
        ))
    }
}
