//! Scores of a report against a sealed answer.

use super::answer::{Answer, PARAMETERS, list, number, text, texts};
use super::drawn::Drawn;
use super::missed::{Missed, missed};
use super::named::{Named, named};
use super::sizes::{as_recorded, covered, deviations, size_error};
use serde_json::Value;

/// Scores of one case; None where a score does not apply.
#[derive(Clone, Debug, Default)]
pub struct Score {
    /// Name of the kind of the case.
    pub kind: String,
    /// Score of the first cause, parameter entries set aside: 1 if it is the truth, half if only a rival of it is, otherwise 0.
    pub top1: Option<f64>,
    /// Score of the first cause as `top1`, where an effect that no recording can tell from the truth counts as right.
    pub lenient: Option<f64>,
    /// Whether the truth is among the first three causes, 0 or 1.
    pub top3: Option<f64>,
    /// Part of the withheld effects that is named anywhere.
    pub found: Option<f64>,
    /// Whether a structural cause is named that is not there at all, 0 or 1.
    pub extra: Option<f64>,
    /// Effects of the structural causes that are not there at all.
    pub false_causes: Vec<String>,
    /// Reason why a single effect is not the first cause.
    pub missed: Option<Missed>,
    /// Whether the verdict was `no_gap` although parameters do not close the gap, 0 or 1.
    pub false_no_gap: Option<f64>,
    /// Part of the named true effects whose joints are right, 0 to 1.
    pub joint: Option<f64>,
    /// Ratio of the gap closed by the causes to that closed by the true plant.
    pub closure: Option<f64>,
    /// Whether a structural cause is reported although nothing was withheld, 0 or 1.
    pub false_alarm: Option<f64>,
    /// Whether an effect outside the catalogue was called unknown, 0 or 1.
    pub unknown_found: Option<f64>,
    /// Whether a known effect was called unknown, 0 or 1.
    pub false_unknown: Option<f64>,
    /// Relative error of the reported size, where mechanism and detector have a parameter in common.
    pub size: Option<f64>,
    /// Error of the reported size in its standard deviations.
    pub off: Option<f64>,
    /// Whether the true size lies in the reported size's 90 % interval, 0 or 1.
    pub covered: Option<f64>,
    /// Share of a single effect in its joint's torque, and whether it was named.
    pub detection: Option<(f64, bool)>,
    /// Structural causes with evidence for their names.
    pub named: Vec<Named>,
    /// Further drawn properties of a hard case.
    pub drawn: Option<Drawn>,
    /// Whether the case was already diagnosed by an earlier run into the same folder.
    pub stored: bool,
}

/// Sum of the squares of a list.
fn squares(v: &Value) -> f64 {
    v.as_array()
        .into_iter()
        .flatten()
        .map(|x| x.as_f64().unwrap_or(0.0).powi(2))
        .sum()
}

fn one(of: bool) -> f64 {
    f64::from(u8::from(of))
}

/// Judges a report (schema `diagnosis/1`) by a truth file's content.
///
/// Of a hard case (`hard` in the truth) naming the background, the bias or the current filter's lag is right, never a false
/// cause; the lag is set aside as parameters are; the withheld effect must come before the background.
pub fn judge(truth: &Value, report: &Value) -> Score {
    let answer = Answer::of(truth);
    let causes = list(&report["causes"]);
    let verdict = text(report, "verdict");
    let told = !["missing", "cannot_tell"].contains(&verdict);
    let rest: Vec<&Value> = causes
        .iter()
        .filter(|c| !answer.is_aside(text(c, "effect")))
        .collect();
    let absorbed = answer.is_absorbed();
    let same = answer.same();
    let kind = text(truth, "kind").to_owned();
    let unknown = one(verdict == "unknown_effect");
    let false_causes = causes.iter().filter(|c| answer.is_false(c));
    let false_causes = false_causes
        .map(|c| text(c, "effect").to_owned())
        .collect::<Vec<_>>();
    let mut s = Score {
        kind: kind.clone(),
        extra: Some(one(!false_causes.is_empty())),
        false_causes,
        named: named(truth, report, |c| answer.is_beside(c)),
        drawn: Drawn::of(truth),
        ..Score::default()
    };
    if !answer.names.is_empty() {
        let top1 = answer.hit(rest.first().copied());
        s.top1 = Some(top1);
        let left = rest
            .iter()
            .copied()
            .find(|c| answer.is_true(c) || !answer.is_beside(c));
        let lenient = match left {
            Some(c) if same.contains(&text(c, "effect")) => 1.0,
            Some(c) => answer.hit(Some(c)),
            None => one(told && (absorbed || same.iter().any(|n| PARAMETERS.contains(n)))),
        };
        // Pushed at rest in one file only: to name nothing false is right, of the held-out file where the verdict sees them.
        let pushed = answer.hard.and_then(|h| h["contact"].as_str());
        let careful = pushed.is_some_and(|file| file == "train" || unknown == 1.0) && told;
        let careful = if careful {
            1.0 - s.extra.unwrap_or(0.0)
        } else {
            0.0
        };
        s.lenient = Some(lenient.max(top1).max(careful));
        s.top3 = Some(one(rest.iter().take(3).any(|c| answer.is_true(c))));
        let mut named: Vec<&str> = causes
            .iter()
            .filter(|c| answer.is_true(c))
            .map(|c| text(c, "effect"))
            .collect();
        named.sort_unstable();
        named.dedup();
        s.found = Some(named.len() as f64 / answer.names.len() as f64);
        let joints: Vec<f64> = answer
            .effects
            .iter()
            .filter(|e| text(e, "scope") == "joint")
            .filter_map(|e| {
                let c = causes
                    .iter()
                    .find(|c| text(c, "effect") == text(e, "effect"))?;
                let (a, b) = (texts(&e["joints"]), texts(&c["joints"]));
                Some(one(
                    a.iter().all(|j| b.contains(j)) && b.len() <= a.len() + 1
                ))
            })
            .collect();
        s.joint = (!joints.is_empty()).then(|| joints.iter().sum::<f64>() / joints.len() as f64);
    }
    if kind == "none" {
        let alarms = rest.iter().any(|c| !answer.is_beside(c));
        s.false_alarm = (verdict != "cannot_tell").then(|| one(alarms));
    } else if !absorbed {
        s.false_no_gap = Some(one(verdict == "no_gap"));
    }
    if kind == "outside" {
        s.unknown_found = Some(unknown);
    } else {
        s.false_unknown = Some(unknown);
    }
    let effects = answer.effects;
    let cause_of = |e: &Value| {
        causes
            .iter()
            .find(|c| text(c, "effect") == text(e, "effect") && answer.is_true(c))
    };
    let sizes: Vec<f64> = effects
        .iter()
        .filter_map(|e| size_error(&as_recorded(e, truth), cause_of(e)?))
        .collect();
    s.size = (!sizes.is_empty()).then(|| sizes.iter().sum::<f64>() / sizes.len() as f64);
    if let [only] = effects
        && !answer.names.is_empty()
    {
        s.off = cause_of(only).and_then(|c| deviations(&as_recorded(only, truth), c));
        s.covered = s.off.map(covered).map(one);
        if foreign(only) {
            s.kind = format!("{kind}, foreign gear");
        }
        s.detection = Some((number(only, "share"), cause_of(only).is_some()));
        s.missed = missed(&answer, &rest);
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

/// Whether an effect is a gear of other laws than the detector's.
fn foreign(effect: &Value) -> bool {
    let mechanism = text(effect, "mechanism");
    mechanism.starts_with("wind_up") || mechanism.starts_with("play_with")
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

    /// A hard case: ripple withheld on `a`, Stribeck friction on both joints and a bias besides.
    fn hard(effect: &str, joint: &str) -> Value {
        json!({"kind": effect, "effects": [{"effect": effect, "scope": "joint", "joints": [joint], "reference_joint": joint,
            "share": 0.2, "share_after_reidentification": 0.2, "indistinguishable": []}],
            "hard": {"background": [{"effect": "stribeck_friction", "joint": "a", "share": 0.02},
                {"effect": "stribeck_friction", "joint": "b", "share": 0.03}],
                "bias": {"joint": "b", "share": 0.02}, "contact": null},
            "oracle": {"nrmse": {"as_given": [0.2], "with_effect": [0.1]}}})
    }

    fn report(causes: &[(&str, &str)]) -> Value {
        let causes: Vec<Value> = causes
            .iter()
            .map(|(effect, joint)| json!({"effect": effect, "joints": [joint]}))
            .collect();
        json!({"verdict": "explained", "causes": causes, "ladder": []})
    }

    #[test]
    fn what_a_hard_case_has_besides_is_no_false_cause() {
        let truth = hard("torque_ripple", "a");
        let lag_first = judge(
            &truth,
            &report(&[("time_delay", "a"), ("torque_ripple", "a")]),
        );
        assert_eq!((lag_first.top1, lag_first.extra), (Some(1.0), Some(0.0)));
        let behind = judge(
            &truth,
            &report(&[("stribeck_friction", "b"), ("torque_ripple", "a")]),
        );
        assert_eq!((behind.top1, behind.lenient), (Some(0.0), Some(1.0)));
        assert_eq!((behind.found, behind.extra), (Some(1.0), Some(0.0)));
        let biased = judge(&truth, &report(&[("torque_offset", "b")]));
        assert_eq!((biased.extra, biased.lenient), (Some(0.0), Some(0.0)));
        let elsewhere = judge(&truth, &report(&[("torque_offset", "a")]));
        assert_eq!(elsewhere.extra, Some(1.0));
    }

    #[test]
    fn a_name_of_the_background_counts_on_its_own_joint() {
        let truth = hard("stribeck_friction", "a");
        let other = judge(&truth, &report(&[("stribeck_friction", "b")]));
        assert_eq!((other.top1, other.found), (Some(0.0), Some(0.0)));
        assert_eq!(other.detection.map(|d| d.1), Some(false));
        let own = judge(&truth, &report(&[("stribeck_friction", "a")]));
        assert_eq!((own.top1, own.found), (Some(1.0), Some(1.0)));
    }

    #[test]
    fn of_pushes_in_the_training_file_it_is_right_to_say_nothing_false() {
        let mut truth = hard("external_contact", "a");
        truth["hard"]["contact"] = json!("train");
        assert_eq!(judge(&truth, &report(&[])).lenient, Some(1.0));
        assert_eq!(
            judge(&truth, &report(&[("payload", "a")])).lenient,
            Some(0.0)
        );
        truth["hard"]["contact"] = json!("heldout");
        assert_eq!(judge(&truth, &report(&[])).lenient, Some(0.0));
    }
}
