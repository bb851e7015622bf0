//! Headline of a report: the verdict, and each cause with its joints.

use super::answer::{list, text, texts};
use super::{ProveError, report_of};
use diagnose::Options;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::path::Path;
use trials::cases::{Case, CaseSpec, draw, draw_hard, generate};

/// Verdict and causes of a report.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Headline {
    /// Verdict of the report, by name.
    pub verdict: String,
    /// Effects in the order of the report, each with the joints that it is reported for: `effect: joint, joint`.
    pub causes: Vec<String>,
}

impl Headline {
    /// Headline of a report (schema `diagnosis/1`).
    pub fn of(report: &Value) -> Self {
        let cause =
            |c: &Value| format!("{}: {}", text(c, "effect"), texts(&c["joints"]).join(", "));
        Self {
            verdict: text(report, "verdict").to_owned(),
            causes: list(&report["causes"]).iter().map(cause).collect(),
        }
    }

    /// The cause that is named first, with its joints.
    pub fn first(&self) -> Option<&str> {
        self.causes.first().map(String::as_str)
    }
}

/// Sealed cases and their reviewed headlines.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Stored {
    /// Seed from which the cases are drawn.
    pub seed: u64,
    /// Version of the generator.
    pub generator: u8,
    /// The cases with their headlines.
    pub cases: Vec<StoredCase>,
}

/// Case with its reviewed headline.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct StoredCase {
    /// Index of the case in the run.
    pub index: u64,
    /// Whether the case is a hard one.
    pub hard: bool,
    /// Name of the withheld effect, for readers of the file.
    pub kind: String,
    /// Headline of the case's report.
    #[serde(flatten)]
    pub headline: Headline,
}

impl Stored {
    /// Reads a file of them.
    ///
    /// # Errors
    /// [`ProveError::Stored`] where it cannot be read.
    pub fn read(path: &Path) -> Result<Self, ProveError> {
        let fail = |error: std::io::Error| ProveError::Stored {
            path: path.display().to_string(),
            error,
        };
        let text = std::fs::read_to_string(path).map_err(fail)?;
        serde_json::from_str(&text).map_err(|e| fail(e.into()))
    }

    /// The cases, made one by one.
    pub fn made(&self) -> impl Iterator<Item = Result<(CaseSpec, Case), ProveError>> {
        let one = |case: &StoredCase| {
            let spec = self.spec(case);
            Ok((spec, generate(&spec, self.seed)?))
        };
        self.cases.iter().map(one)
    }

    /// Headlines of the same cases, diagnosed with `options`.
    ///
    /// # Errors
    /// The first case that cannot be made or diagnosed.
    pub fn diagnosed(&self, options: &Options) -> Result<Self, ProveError> {
        let one = |known: &StoredCase| {
            let spec = self.spec(known);
            let report = report_of(&generate(&spec, self.seed)?, options)?;
            Ok(StoredCase {
                kind: spec.kind.name().to_owned(),
                headline: Headline::of(&report),
                ..*known
            })
        };
        let cases: Result<Vec<StoredCase>, ProveError> = self.cases.par_iter().map(one).collect();
        Ok(Self {
            cases: cases?,
            ..*self
        })
    }

    fn spec(&self, case: &StoredCase) -> CaseSpec {
        let draw = if case.hard { draw_hard } else { draw };
        draw(case.index, self.seed).by(self.generator)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_headline_holds_verdict_names_and_joints() {
        let report = json!({"verdict": "explained", "causes": [
            {"effect": "payload", "joints": ["a", "b"], "gap_closed": 0.5},
            {"effect": "friction_parameters", "joints": ["a"]}]});
        let headline = Headline::of(&report);
        assert_eq!(headline.verdict, "explained");
        assert_eq!(headline.causes, ["payload: a, b", "friction_parameters: a"]);
        assert_eq!(headline.first(), Some("payload: a, b"));
        assert_eq!(
            Headline::of(&json!({"verdict": "no_gap", "causes": []})).first(),
            None
        );
    }
}
