//! Outcome for a withheld effect that is not named first.

use super::answer::Answer;
use serde_json::Value;

/// Reason why a single effect is not the first cause.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Missed {
    /// Rival: the first cause's line gives the withheld effect as a rival.
    SharesItsLine,
    /// Later: only causes that a hard case really has besides come before it.
    BehindWhatIsThere,
    /// Later: a cause that is not in the robot comes before it.
    BehindFalse,
    /// Alike: an effect that no recording can tell from it is named.
    Alike,
    /// Absent: no cause's line names the effect. Parameters absorb it: what they leave is smaller than the joint's
    /// background, or next to nothing.
    Absorbed,
    /// Absent: no cause's line names the effect, although parameters do not absorb it.
    InNoLine,
}

impl Missed {
    /// All reasons with their names.
    pub(super) const ALL: [(Self, &str); 6] = [
        (Self::InNoLine, "in no line, though parameters leave it"),
        (Self::BehindWhatIsThere, "behind causes that are there, too"),
        (Self::SharesItsLine, "the first line's rival"),
        (Self::BehindFalse, "behind a cause that is not there"),
        (Self::Alike, "by a name that no recording can tell apart"),
        (
            Self::Absorbed,
            "in no line, absorbed by parameters or below the background",
        ),
    ];
}

/// Reason why the withheld effect is not the first of a report's causes, without those that the case has
/// besides. None where it is the first.
pub(super) fn missed(answer: &Answer, causes: &[&Value]) -> Option<Missed> {
    let hit = answer.hit(causes.first().copied());
    let mut left = causes
        .iter()
        .filter(|c| answer.is_true(c) || !answer.is_beside(c));
    let alike = |c: &Value| {
        c["effect"]
            .as_str()
            .is_some_and(|e| answer.same().contains(&e))
    };
    Some(match left.next() {
        _ if hit == 1.0 => return None,
        _ if hit > 0.0 => Missed::SharesItsLine,
        Some(c) if answer.is_true(c) => Missed::BehindWhatIsThere,
        Some(c) if alike(c) => Missed::Alike,
        Some(_) if left.any(|c| answer.is_true(c)) => Missed::BehindFalse,
        _ if answer.is_absorbed() => Missed::Absorbed,
        _ => Missed::InNoLine,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prove::score::judge;
    use serde_json::json;

    /// A hard case of play on `a` with Stribeck friction on `b` besides.
    fn truth(left: f64) -> Value {
        json!({"kind": "backlash", "effects": [{"effect": "backlash", "scope": "joint", "joints": ["a"], "reference_joint": "a",
            "share": 0.2, "share_after_reidentification": left, "indistinguishable": ["joint_elasticity"]}],
            "hard": {"background": [{"effect": "stribeck_friction", "joint": "b", "share": 0.02}],
                "bias": {"joint": "b", "share": 0.02}, "contact": null, "inertial_width": 0.25, "friction_width": 2.0,
                "lowpass": {"same": true}},
            "oracle": {"nrmse": {"as_given": [0.2], "with_effect": [0.1]}}})
    }

    /// Why the play is missed of which parameters leave a share, by a report with these causes.
    fn why(left: f64, causes: &[(&str, &str)]) -> Option<Missed> {
        let causes = causes.iter().map(|(effect, joint)| {
            let rivals: &[&str] = if *effect == "payload" {
                &["backlash"]
            } else {
                &[]
            };
            json!({"effect": effect, "joints": [joint], "ambiguous_with": rivals})
        });
        let causes: Vec<Value> = causes.collect();
        let report = json!({"verdict": "explained", "causes": causes, "ladder": []});
        judge(&truth(left), &report).missed
    }

    #[test]
    fn a_miss_is_told_by_what_stands_in_its_place() {
        assert_eq!(
            why(0.2, &[("friction_parameters", "a"), ("backlash", "a")]),
            None
        );
        assert_eq!(why(0.2, &[]), Some(Missed::InNoLine));
        assert_eq!(why(0.01, &[]), Some(Missed::Absorbed));
        assert_eq!(
            why(0.2, &[("stribeck_friction", "b")]),
            Some(Missed::InNoLine)
        );
        let behind = [("stribeck_friction", "b"), ("backlash", "a")];
        assert_eq!(why(0.2, &behind), Some(Missed::BehindWhatIsThere));
        let behind = [("torque_gain", "b"), ("backlash", "a")];
        assert_eq!(why(0.2, &behind), Some(Missed::BehindFalse));
        assert_eq!(why(0.2, &[("torque_gain", "b")]), Some(Missed::InNoLine));
        assert_eq!(why(0.2, &[("payload", "b")]), Some(Missed::SharesItsLine));
        assert_eq!(why(0.2, &[("joint_elasticity", "a")]), Some(Missed::Alike));
    }
}
