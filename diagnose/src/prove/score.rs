//! Scores of a report against a sealed answer.

use super::drawn::Drawn;
use super::named::{Named, named};
use super::sizes::{as_recorded, covered, deviations, size_error};
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
    /// Part of the withheld effects that is named anywhere.
    pub found: Option<f64>,
    /// Some structural cause is named that is not there at all.
    pub extra: Option<f64>,
    /// A gap that parameters do not close was called none.
    pub false_no_gap: Option<f64>,
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
    /// Deviations by which the reported size is off.
    pub off: Option<f64>,
    /// The true size lies in the reported one's 90 % interval.
    pub covered: Option<f64>,
    /// Of a single effect: its share of its joint's torque, and whether it was named.
    pub detection: Option<(f64, bool)>,
    /// Its structural causes for whose names something speaks.
    pub named: Vec<Named>,
    /// What else was drawn of a hard case.
    pub drawn: Option<Drawn>,
    /// Whether an earlier run into the same folder had diagnosed it.
    pub stored: bool,
}

const PARAMETERS: [&str; 2] = ["link_parameters", "friction_parameters"];
/// Small effects that every joint of a hard case may have.
const BACKGROUND: [&str; 3] = [
    "stribeck_friction",
    "presliding_hysteresis",
    "torque_ripple",
];

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

/// What is true of a case, as the scores ask for it.
struct Answer<'a> {
    /// Names of the withheld effects; none of one outside the catalogue.
    names: Vec<&'a str>,
    /// The withheld effects.
    effects: &'a [Value],
    /// What else a hard case has.
    hard: Option<&'a Value>,
}

impl<'a> Answer<'a> {
    fn of(truth: &'a Value) -> Self {
        let effects = list(&truth["effects"]);
        let names = effects.iter().map(|e| text(e, "effect"));
        Self {
            names: names.filter(|e| *e != "unknown").collect(),
            effects,
            hard: Some(&truth["hard"]).filter(|h| h.is_object()),
        }
    }

    /// Whether a cause is among what a hard case really has besides the withheld effect: background, bias, the filter's lag.
    fn is_beside(&self, cause: &Value) -> bool {
        let (Some(hard), name) = (self.hard, text(cause, "effect")) else {
            return false;
        };
        let on = |joint: &str| texts(&cause["joints"]).contains(&joint);
        let mut background = list(&hard["background"]).iter();
        name == "time_delay"
            || background.any(|b| text(b, "effect") == name && on(text(b, "joint")))
            || (name == "torque_offset" && on(text(&hard["bias"], "joint")))
    }

    /// Whether a cause is a withheld effect; where the background has the same name on other joints, on one of its own.
    fn is_true(&self, cause: &Value) -> bool {
        let name = text(cause, "effect");
        let joints = texts(&cause["joints"]);
        let own = |e: &Value| {
            text(e, "effect") == name && texts(&e["joints"]).iter().any(|j| joints.contains(j))
        };
        self.names.contains(&name)
            && (self.hard.is_none() || !BACKGROUND.contains(&name) || self.effects.iter().any(own))
    }

    /// 1 for a true cause, half where the truth is only said to be possible instead of it.
    fn hit(&self, cause: Option<&Value>) -> f64 {
        let Some(cause) = cause else { return 0.0 };
        let rivals = texts(&cause["ambiguous_with"]);
        if self.is_true(cause) {
            1.0
        } else if rivals.iter().any(|e| self.names.contains(e)) {
            0.5
        } else {
            0.0
        }
    }

    /// Whether parameters leave little of every withheld effect, in a hard case no more than the background on its joint.
    fn is_absorbed(&self) -> bool {
        let background = |joint: &str| {
            let all = self.hard.map_or(&[][..], |h| list(&h["background"]));
            all.iter()
                .filter(|b| text(b, "joint") == joint)
                .map(|b| number(b, "share"))
                .fold(0.0, f64::max)
        };
        let little = |e: &Value| {
            let below = background(text(e, "reference_joint"));
            number(e, "share_after_reidentification") < (0.15 * number(e, "share")).max(below)
        };
        !self.effects.is_empty() && self.effects.iter().all(little)
    }
}

fn list(v: &Value) -> &[Value] {
    v.as_array().map_or(&[], Vec::as_slice)
}

fn number(v: &Value, key: &str) -> f64 {
    v[key].as_f64().unwrap_or(0.0)
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
    let by_parameters = answer.names.iter().any(|n| PARAMETERS.contains(n));
    let aside = |name: &str| match answer.hard {
        Some(_) => {
            (PARAMETERS.contains(&name) || name == "time_delay") && !answer.names.contains(&name)
        }
        None => PARAMETERS.contains(&name) && !by_parameters,
    };
    let rest: Vec<&Value> = causes
        .iter()
        .filter(|c| !aside(text(c, "effect")))
        .collect();
    let absorbed = answer.is_absorbed();
    let same: Vec<&str> = answer
        .names
        .iter()
        .copied()
        .chain(
            answer
                .effects
                .iter()
                .flat_map(|e| texts(&e["indistinguishable"])),
        )
        .collect();
    let is_false = |c: &Value| {
        let name = text(c, "effect");
        !PARAMETERS.contains(&name) && !same.contains(&name) && !answer.is_beside(c)
    };
    let kind = text(truth, "kind").to_owned();
    let unknown = one(verdict == "unknown_effect");
    let mut s = Score {
        kind: kind.clone(),
        extra: Some(one(causes.iter().any(is_false))),
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
