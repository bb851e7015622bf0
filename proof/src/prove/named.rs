//! Structural causes of reports with known truth: the evidence for each, and whether its name is right.

use diagnose::schema::Support;
use serde_json::Value;

/// A structural cause of a report.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Named {
    /// Evidence for the name of the cause.
    pub support: Support,
    /// Whether effect and joint of the cause are right.
    pub right: bool,
}

/// Causes of a report with evidence for their names. `beside` tells whether the case has a cause besides the withheld effects.
pub(super) fn named(truth: &Value, report: &Value, beside: impl Fn(&Value) -> bool) -> Vec<Named> {
    let of = |cause: &Value| {
        let support = serde_json::from_value(cause["support"].clone()).ok()?;
        let right = right(truth, cause) || beside(cause);
        Some(Named { support, right })
    };
    let causes = report["causes"].as_array().into_iter().flatten();
    causes.filter_map(of).collect()
}

/// Whether a cause of a report names an effect of the answer, and one of its joints where it belongs to joints.
fn right(truth: &Value, cause: &Value) -> bool {
    let joints = |of: &Value| of["joints"].as_array().cloned().unwrap_or_default();
    let own = joints(cause);
    let mut effects = truth["effects"].as_array().into_iter().flatten();
    effects.any(|e| {
        e["effect"] == cause["effect"]
            && (e["scope"] != "joint" || joints(e).iter().any(|j| own.contains(j)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_name_on_another_joint_is_wrong() {
        let truth = json!({"effects": [{"effect": "backlash", "scope": "joint", "joints": ["a"]},
            {"effect": "payload", "scope": "global", "joints": ["f"]}]});
        let cause = |effect: &str, joint: &str, lead: f64| {
            json!({"effect": effect, "joints": [joint],
                "support": {"lead": lead, "left": 0.0}})
        };
        let report = json!({"causes": [cause("backlash", "a", 9.0), cause("backlash", "b", 4.0), cause("payload", "c", 7.0),
            {"effect": "friction_parameters", "joints": ["a"], "support": null}]});
        let found: Vec<(f64, bool)> = named(&truth, &report, |_| false)
            .iter()
            .map(|n| (n.support.lead, n.right))
            .collect();
        assert_eq!(found, [(9.0, true), (4.0, false), (7.0, true)]);
        // An effect that no catalogue has: every name is wrong.
        let outside =
            json!({"effects": [{"effect": "unknown", "scope": "joint", "joints": ["a"]}]});
        assert!(named(&outside, &report, |_| false).iter().all(|n| !n.right));
        // What a hard case has besides is right.
        assert!(named(&outside, &report, |_| true).iter().all(|n| n.right));
    }
}
