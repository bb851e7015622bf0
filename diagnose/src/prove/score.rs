//! Scores of a report against a sealed answer.

use super::sizes::size_error;
use serde_json::Value;

/// Scores of one case; None where a score does not apply.
#[derive(Clone, Debug, Default)]
pub struct Score {
    /// Kind of the case.
    pub kind: String,
    /// First cause, parameter entries set aside, is the truth (half when only ambiguous).
    pub top1: Option<f64>,
    /// The same, or what no recording can tell apart.
    pub lenient: Option<f64>,
    /// Truth among the first three.
    pub top3: Option<f64>,
    /// Right joints.
    pub joint: Option<f64>,
    /// Gap closed over what the true plant closes.
    pub closure: Option<f64>,
    /// A structural cause where there is none.
    pub false_alarm: Option<f64>,
    /// An effect outside the catalogue was called unknown.
    pub unknown_found: Option<f64>,
    /// A known effect was called unknown.
    pub false_unknown: Option<f64>,
    /// Relative error of the reported size, where mechanism and detector share a parameter.
    pub size: Option<f64>,
    /// Of a single effect: its share of its joint's torque, and whether it was named.
    pub detection: Option<(f64, bool)>,
}

const PARAMETERS: [&str; 2] = ["link_parameters", "friction_parameters"];

fn text<'a>(v: &'a Value, key: &str) -> &'a str {
    v[key].as_str().unwrap_or("")
}

fn texts(v: &Value) -> Vec<&str> {
    v.as_array()
        .into_iter()
        .flatten()
        .filter_map(Value::as_str)
        .collect()
}

fn squares(v: &Value) -> f64 {
    v.as_array()
        .into_iter()
        .flatten()
        .map(|x| x.as_f64().unwrap_or(0.0).powi(2))
        .sum()
}

fn hit(cause: Option<&Value>, names: &[&str]) -> f64 {
    let Some(cause) = cause else { return 0.0 };
    if names.contains(&text(cause, "effect")) {
        return 1.0;
    }
    if texts(&cause["ambiguous_with"])
        .iter()
        .any(|e| names.contains(e))
    {
        0.5
    } else {
        0.0
    }
}

/// Judges a report (schema `diagnosis/1`) by a truth file's content.
pub fn judge(truth: &Value, report: &Value) -> Score {
    let list = |v: &Value| v.as_array().cloned().unwrap_or_default();
    let (effects, causes) = (list(&truth["effects"]), list(&report["causes"]));
    let names: Vec<&str> = effects
        .iter()
        .map(|e| text(e, "effect"))
        .filter(|e| *e != "unknown")
        .collect();
    let by_parameters = names.iter().any(|n| PARAMETERS.contains(n));
    let rest: Vec<&Value> = causes
        .iter()
        .filter(|c| by_parameters || !PARAMETERS.contains(&text(c, "effect")))
        .collect();
    let number = |e: &Value, key: &str| e[key].as_f64().unwrap_or(0.0);
    let absorbed = !effects.is_empty()
        && effects
            .iter()
            .all(|e| number(e, "share_after_reidentification") < 0.15 * number(e, "share"));
    let kind = text(truth, "kind").to_owned();
    let unknown = f64::from(u8::from(text(report, "verdict") == "unknown_effect"));
    let mut s = Score {
        kind: kind.clone(),
        ..Score::default()
    };
    if !names.is_empty() {
        let same: Vec<&str> = names
            .iter()
            .copied()
            .chain(effects.iter().flat_map(|e| texts(&e["indistinguishable"])))
            .collect();
        let top1 = hit(rest.first().copied(), &names);
        s.top1 = Some(top1);
        let first_same = rest
            .first()
            .is_some_and(|c| same.contains(&text(c, "effect")));
        let parameters_do =
            rest.is_empty() && (absorbed || same.iter().any(|n| PARAMETERS.contains(n)));
        s.lenient = Some(if first_same || parameters_do {
            1.0
        } else {
            top1
        });
        s.top3 = Some(f64::from(u8::from(
            rest.iter()
                .take(3)
                .any(|c| names.contains(&text(c, "effect"))),
        )));
        let joints: Vec<f64> = effects
            .iter()
            .filter(|e| text(e, "scope") == "joint")
            .filter_map(|e| {
                let c = causes
                    .iter()
                    .find(|c| text(c, "effect") == text(e, "effect"))?;
                let (a, b) = (texts(&e["joints"]), texts(&c["joints"]));
                Some(f64::from(u8::from(
                    a.iter().all(|j| b.contains(j)) && b.len() <= a.len() + 1,
                )))
            })
            .collect();
        s.joint = (!joints.is_empty()).then(|| joints.iter().sum::<f64>() / joints.len() as f64);
    }
    if kind == "none" {
        s.false_alarm = Some(f64::from(u8::from(!rest.is_empty())));
    }
    if kind == "outside" {
        s.unknown_found = Some(unknown);
    } else {
        s.false_unknown = Some(unknown);
    }
    let cause_of = |e: &Value| {
        causes
            .iter()
            .find(|c| text(c, "effect") == text(e, "effect"))
    };
    let sizes: Vec<f64> = effects
        .iter()
        .filter_map(|e| size_error(e, cause_of(e)?))
        .collect();
    s.size = (!sizes.is_empty()).then(|| sizes.iter().sum::<f64>() / sizes.len() as f64);
    if let [one] = &effects[..]
        && !names.is_empty()
    {
        s.detection = Some((number(one, "share"), cause_of(one).is_some()));
    }
    let ladder = list(&report["ladder"]);
    let last = ladder
        .iter()
        .rfind(|x| !["learned", "repeatability"].contains(&text(x, "step")));
    let oracle = &truth["oracle"]["nrmse"];
    let (given, best) = (
        squares(&oracle["as_given"]),
        squares(&oracle["with_effect"]),
    );
    if let Some(last) = last.filter(|_| given > 1.2 * best) {
        s.closure = Some((given - squares(&last["nrmse"])) / (given - best));
    }
    s
}

/// Mean of a score over the cases where it applies.
pub fn mean(scores: &[&Score], of: impl Fn(&Score) -> Option<f64>) -> Option<f64> {
    let values: Vec<f64> = scores.iter().filter_map(|s| of(s)).collect();
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn an_absorbed_effect_may_be_answered_by_parameters() {
        let truth = json!({"kind": "torque_gain", "effects": [{"effect": "torque_gain", "scope": "joint", "joints": ["a"],
            "share": 0.2, "share_after_reidentification": 0.01, "indistinguishable": []}],
            "oracle": {"nrmse": {"as_given": [0.2], "with_effect": [0.1]}}});
        let report = json!({"verdict": "explained", "causes": [{"effect": "friction_parameters", "joints": ["a"]}],
            "ladder": [{"step": "as_given", "nrmse": [0.2]}, {"step": "reidentified", "nrmse": [0.1]}]});
        let s = judge(&truth, &report);
        assert_eq!(
            (s.top1, s.lenient, s.top3),
            (Some(0.0), Some(1.0), Some(0.0))
        );
        assert!((s.closure.unwrap() - 1.0).abs() < 1e-12);
        assert_eq!(s.false_unknown, Some(0.0));
    }
}
