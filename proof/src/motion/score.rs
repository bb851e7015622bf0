//! Score of a report of `replay` against the sealed answer of its case.

use super::case::Sealed;
use super::effects::{Truth, Withheld};
use super::shown::{Information, Shown};
use model::spread::NINETY;
use replay::decide::tempered;
use replay::schema::REPEATABILITY;
use serde_json::Value;

/// Verdict of a case whose recording `replay` refuses: no answer is right then.
pub const REFUSED: &str = "refused";

/// Score of the report on one case.
#[derive(Debug, Clone)]
pub struct Score {
    /// Name of the case.
    pub id: String,
    /// Copy of the sealed answer that the report was scored against: withheld effects, true gains and delays of the drives.
    pub sealed: Sealed,
    /// Effect and joints of the report's first cause; empty where there is none.
    pub first: String,
    /// Whether the report is right. With one or two withheld effects its first cause must be one of them, or be
    /// ambiguous with it. With none, no cause may be listed. With one outside the catalogue, something unknown must be
    /// reported.
    pub right: bool,
    /// Listed causes that were not withheld: effect and joints.
    pub extra: Vec<String>,
    /// Withheld effects that are not listed: effect and joint.
    pub missed: Vec<String>,
    /// Confidence of each listed cause, 0 to 1, and whether it was withheld.
    pub said: Vec<(f64, bool)>,
    /// True values for which the report has a standard deviation: name of the parameter, and whether the 90 % interval
    /// holds the value.
    pub covered: Vec<(String, bool)>,
    /// Largest absolute error of a drive's delay, s; not a number where there is none.
    pub delay_error: f64,
    /// Largest relative error of a drive's proportional gain; none where the report or the answer has no gains.
    pub gain_error: Option<f64>,
    /// Of each gain that the motion itself shows within 2 %: whether it is found within 5 %.
    pub shown_gains: Vec<bool>,
    /// Of each statement that two values cannot be told apart (`inseparable`), or that a value is hardly shown (`little`): which of
    /// the two it is, and whether that is so by the simulator that made the motion. Statements about values that it did not vary are
    /// left out.
    pub doubts: Vec<(&'static str, bool)>,
    /// Of each pair of values that cannot be told apart by the simulator that made the motion: whether the report says so.
    pub pairs: Vec<bool>,
    /// Mean ratio of simulation error to tracking error on the held-out recording: at the first and the last step of
    /// the ladder.
    pub unexplained: [f64; 2],
    /// Verdict of the report.
    pub verdict: String,
    /// Wall time of the diagnosis, s; not a number where the report was there already.
    pub seconds: f64,
}

/// Score of a report (JSON) against the sealed answer of its case. `seconds` is the wall time of the diagnosis.
pub fn judge(id: &str, sealed: &Sealed, report: &Value, seconds: f64) -> Score {
    let none = Vec::new();
    let causes = report["causes"].as_array().unwrap_or(&none);
    let text = |v: &Value| v.as_str().unwrap_or("").to_owned();
    let ambiguous = |cause: &Value, name: &str| {
        let mut names = cause["ambiguous_with"].as_array().into_iter().flatten();
        names.any(|a| a == name)
    };
    let on = |cause: &Value, joint: &Option<String>| match joint {
        Some(joint) => cause["joints"]
            .as_array()
            .is_some_and(|all| all.iter().any(|j| j == joint.as_str())),
        None => true,
    };
    let by = |cause: &Value, w: &Withheld| cause["driver"].as_str() == w.driver.as_deref();
    let was = |cause: &Value| {
        sealed
            .withheld
            .iter()
            .any(|w| cause["effect"] == w.effect.as_str() && on(cause, &w.joint) && by(cause, w))
    };
    // Ambiguous effects: the first cause is right where the report names the withheld effect as ambiguous with it.
    let first_right = causes.first().is_some_and(|c| {
        was(c)
            || sealed
                .withheld
                .iter()
                .any(|w| ambiguous(c, &w.effect) && on(c, &w.joint))
    });
    let unknown = report["unknown"].as_array().is_some_and(|u| !u.is_empty());
    let refused = report["verdict"] == REFUSED;
    let right = !refused
        && match sealed.kind.as_str() {
            "none" => causes.is_empty(),
            "outside" => report["verdict"] == "unknown_effect" || unknown,
            _ => first_right,
        };
    let name = |c: &Value| {
        let joints: Vec<String> = c["joints"]
            .as_array()
            .into_iter()
            .flatten()
            .map(text)
            .collect();
        format!("{} {}", text(&c["effect"]), joints.join("+"))
    };
    let missed = sealed
        .withheld
        .iter()
        .filter(|w| {
            !causes
                .iter()
                .any(|c| c["effect"] == w.effect.as_str() && on(c, &w.joint))
        })
        .map(|w| format!("{} {}", w.effect, w.joint.as_deref().unwrap_or("arm")))
        .collect();
    let covered = covered(sealed, causes, report, &was);
    let gaps = report["ladder"].as_array().into_iter().flatten();
    let mean: Vec<f64> = gaps
        .filter(|s| s["step"] != REPEATABILITY)
        .filter_map(|s| s["mean_unexplained"].as_f64())
        .collect();
    Score {
        id: id.to_owned(),
        first: causes.first().map_or_else(String::new, name),
        right,
        extra: causes.iter().filter(|c| !was(c)).map(name).collect(),
        missed,
        said: causes
            .iter()
            .map(|c| (c["confidence"].as_f64().unwrap_or(0.0), was(c)))
            .collect(),
        covered,
        delay_error: drive_error(sealed, report, "delay").map_or(f64::NAN, |e| e.0),
        gain_error: drive_error(sealed, report, "kp").map(|e| e.1),
        shown_gains: shown_gains(sealed, report),
        doubts: doubts(sealed, report),
        pairs: pairs(sealed, report),
        unexplained: [mean.first(), mean.last()].map(|v| v.copied().unwrap_or(f64::NAN)),
        verdict: text(&report["verdict"]),
        sealed: sealed.clone(),
        seconds,
    }
}

/// Whether the true value is inside the 90 % interval of a value; none where value or standard deviation is null.
fn inside(value: &Value, std: &Value, truth: f64) -> Option<bool> {
    let (value, std) = (value.as_f64()?, std.as_f64()?);
    Some((value - truth).abs() <= NINETY * std)
}

/// Index of a joint in the report, by its name.
fn joint_index(report: &Value, joint: &str) -> Option<usize> {
    report["joints"].as_array()?.iter().position(|j| j == joint)
}

/// Coverage of 90 % intervals: the parameters of causes that were withheld, and every gain that has a standard
/// deviation.
fn covered(
    sealed: &Sealed,
    causes: &[Value],
    report: &Value,
    was: &dyn Fn(&Value) -> bool,
) -> Vec<(String, bool)> {
    let mut out = Vec::new();
    for cause in causes.iter().filter(|c| was(c)) {
        let own = sealed
            .withheld
            .iter()
            .filter(|w| cause["effect"] == w.effect.as_str());
        for truth in own.flat_map(|w| &w.parameters) {
            let found = cause["parameters"]
                .as_array()
                .into_iter()
                .flatten()
                .find(|p| {
                    p["name"] == truth.name.as_str()
                        && p["joint"].as_str() == truth.joint.as_deref()
                });
            let within = found.and_then(|p| inside(&p["value"], &p["std"], truth.value));
            out.extend(within.map(|w| (truth.name.clone(), w)));
        }
    }
    let drive = |truth: &Truth, value: &str, std: &str| -> Option<bool> {
        let j = joint_index(report, truth.joint.as_deref()?)?;
        let controller = &report["controller"];
        inside(&controller[value][j], &controller[std][j], truth.value)
    };
    for truth in sealed.drives.iter().filter(|t| t.name == "kp") {
        out.extend(drive(truth, "kp", "kp_std").map(|w| ("controller kp".to_owned(), w)));
    }
    out
}

/// Largest absolute and largest relative error, over the joints, of the drives' value `name`; none where no joint has
/// one.
fn drive_error(sealed: &Sealed, report: &Value, name: &str) -> Option<(f64, f64)> {
    let each = sealed
        .drives
        .iter()
        .filter(|t| t.name == name)
        .filter_map(|t| {
            let j = joint_index(report, t.joint.as_deref()?)?;
            let error = (report["controller"][name][j].as_f64()? - t.value).abs();
            Some((error, error / t.value.abs().max(1e-9)))
        });
    each.reduce(|a, b| (a.0.max(b.0), a.1.max(b.1)))
}

/// Largest part of a gain that its deviation by the motion itself may be, so that the gain must be found.
const SHOWN: f64 = 0.02;

/// Largest relative error of a gain that is found.
const FOUND: f64 = 0.05;

/// Of each gain that the motion itself shows well: whether the report has it.
fn shown_gains(sealed: &Sealed, report: &Value) -> Vec<bool> {
    let Some(information) = &sealed.information else {
        return Vec::new();
    };
    let shown = information.values.iter();
    let shown = shown.filter(|v| v.name == "kp" && v.deviation <= SHOWN * v.value);
    let error = |v: &Shown| {
        let j = joint_index(report, v.joint.as_deref()?)?;
        Some((report["controller"]["kp"][j].as_f64()? / v.value - 1.0).abs())
    };
    shown
        .map(|v| error(v).is_some_and(|e| e <= FOUND))
        .collect()
}

/// Values that a statement of the report is about, by index. Those that were not varied are left out.
fn about(information: &Information, statement: &Value) -> Vec<usize> {
    let values = statement["values"].as_array().into_iter().flatten();
    let of = |v: &Value| information.index(v["name"].as_str()?, v["joint"].as_str());
    values.filter_map(of).collect()
}

/// Of each statement of the report about values that are not determined: whether it is right.
fn doubts(sealed: &Sealed, report: &Value) -> Vec<(&'static str, bool)> {
    let Some(information) = &sealed.information else {
        return Vec::new();
    };
    let mut out = Vec::new();
    for statement in report["not_identifiable"].as_array().into_iter().flatten() {
        let values = about(information, statement);
        match (statement["finding"].as_str(), &values[..]) {
            (Some("inseparable"), [a, b]) => {
                out.push(("inseparable", information.is_inseparable(*a, *b)));
            }
            (Some("little"), all) => {
                let right = |&i: &usize| ("little", !information.values[i].is_halved());
                out.extend(all.iter().map(right));
            }
            _ => {}
        }
    }
    out
}

/// Of each pair that cannot be told apart: whether the report says so, or says that it knows little of one of the two.
fn pairs(sealed: &Sealed, report: &Value) -> Vec<bool> {
    let Some(information) = &sealed.information else {
        return Vec::new();
    };
    let statements = report["not_identifiable"].as_array().into_iter().flatten();
    let said: Vec<(bool, Vec<usize>)> = statements
        .map(|s| (s["finding"] == "inseparable", about(information, s)))
        .collect();
    let says = |[a, b]: &[usize; 2]| {
        said.iter().any(|(pair, values)| {
            let (first, second) = (values.contains(a), values.contains(b));
            if *pair {
                first && second
            } else {
                first || second
            }
        })
    };
    information.inseparable.iter().map(says).collect()
}

/// Exponent for the odds of the causes' confidences that maximises their log score; below 1, the confidences were too
/// high. `said` holds the confidence of each cause and whether it is right. None where all of them or none are right.
pub fn tempering(said: &[(f64, bool)]) -> Option<f64> {
    let right = said.iter().filter(|s| s.1).count();
    if right == 0 || right == said.len() {
        return None;
    }
    let score = |power: f64| -> f64 {
        let each = said.iter().map(|&(p, was)| likelihood(p, power, was).ln());
        each.sum()
    };
    let grid = (1..=100).map(|k| 0.01 * f64::from(k));
    grid.max_by(|a, b| score(*a).total_cmp(&score(*b)))
}

/// Probability of the outcome `was` where the odds of probability `p` are raised to `power`.
fn likelihood(p: f64, power: f64, was: bool) -> f64 {
    let p = tempered(p, power);
    if was { p } else { 1.0 - p }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_refused_recording_is_no_right_answer() {
        let sealed = |kind: &str| Sealed {
            kind: kind.to_owned(),
            simulator: "plant".to_owned(),
            withheld: Vec::new(),
            drives: Vec::new(),
            tolerance: 0.0,
            period: 0.01,
            information: None,
        };
        for (verdict, right) in [("no_gap", true), (REFUSED, false)] {
            let report = serde_json::json!({"verdict": verdict, "causes": []});
            assert_eq!(judge("a", &sealed("none"), &report, 1.0).right, right);
        }
        let report = serde_json::json!({"verdict": REFUSED, "causes": []});
        assert!(!judge("a", &sealed("outside"), &report, 1.0).right);
    }

    #[test]
    fn what_is_said_too_surely_is_tempered() {
        // Said at odds of 99 to 1, right at 3 to 1.
        let said: Vec<(f64, bool)> = (0..40).map(|k| (0.99, k % 4 != 0)).collect();
        let power = tempering(&said).expect("right and wrong ones");
        assert!((99.0f64.powf(power) - 3.0).abs() < 0.2, "{power}");
        assert!(tempering(&[(0.9, true)]).is_none());
    }
}
