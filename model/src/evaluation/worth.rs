//! Summary of a model's scores as text.

use super::EvalReport;

impl EvalReport {
    /// Lines on the coverage of the stated 90 % intervals, and on the share of the error above the
    /// repeatability that the compensator removes.
    pub fn worth(&self) -> Vec<String> {
        let percent = |share: f64| format!("{:.1} %", 100.0 * share);
        let by_joint = |figures: Vec<String>| {
            let named = std::iter::zip(&self.joints, figures).map(|(j, f)| format!("{j} {f}"));
            named.collect::<Vec<_>>().join(", ")
        };
        let mut lines = Vec::new();
        if let Some(c) = &self.coverage {
            let regimes = [("in motion", c.moving), ("at standstill", c.standstill)];
            let regimes = regimes
                .into_iter()
                .filter_map(|(name, share)| Some(format!("{} {name}", percent(share?))))
                .collect::<Vec<_>>();
            lines.push(format!(
            "Stated 90 % intervals (± 1.645 of --predict's deviation) hold {} of the samples ({}): {}.",
            percent(c.all),
            regimes.join(", "),
            by_joint(c.joints.iter().copied().map(percent).collect())
        ));
        }
        if let Some(share) = &self.share_of_repeatable {
            let one = |share: &Option<f64>| share.map_or_else(|| "–".to_owned(), percent);
            lines.push(format!(
                "Of physics² − repeatability² in squared NRMSE the compensator removes {}: {}.",
                one(&share.all),
                by_joint(share.joints.iter().map(one).collect())
            ));
        }
        lines
    }
}
