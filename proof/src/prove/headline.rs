//! What a report says first and foremost: the verdict, and each cause with its joints.

use super::answer::{list, text, texts};
use super::{ProveError, report_of};
use diagnose::Options;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use trials::cases::{CaseSpec, generate};

/// Verdict and causes of a report.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Headline {
    /// The verdict.
    pub verdict: String,
    /// Effects in the order of the report, each with the joints that it is reported for: `effect: joint, joint`.
    pub causes: Vec<String>,
}

impl Headline {
    /// Of a report (schema `diagnosis/1`).
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

    /// Of the diagnosis of a sealed case.
    ///
    /// # Errors
    /// The case cannot be made or diagnosed.
    pub fn of_case(spec: &CaseSpec, seed: u64, options: &Options) -> Result<Self, ProveError> {
        let case = generate(spec, seed)?;
        Ok(Self::of(&report_of(&case, options)?))
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
