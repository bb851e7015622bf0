//! Answer of a sealed case in the form that the scores need.

use serde_json::Value;

/// Causes that change numbers of the given model, without another mechanism.
pub(super) const PARAMETERS: [&str; 2] = ["link_parameters", "friction_parameters"];
/// Names of small effects that every joint of a hard case may have.
const BACKGROUND: [&str; 3] = [
    "stribeck_friction",
    "presliding_hysteresis",
    "torque_ripple",
];

/// Text in a field of a JSON object; empty where the field is missing.
pub(super) fn text<'a>(v: &'a Value, key: &str) -> &'a str {
    v[key].as_str().unwrap_or("")
}

/// Texts in a JSON list.
pub(super) fn texts(v: &Value) -> Vec<&str> {
    v.as_array()
        .into_iter()
        .flatten()
        .filter_map(Value::as_str)
        .collect()
}

/// Answer of a case in the form that the scores need.
pub(super) struct Answer<'a> {
    /// Names of the withheld effects, without those outside the catalogue.
    pub(super) names: Vec<&'a str>,
    /// Withheld effects as the truth file has them.
    pub(super) effects: &'a [Value],
    /// Further properties of a hard case.
    pub(super) hard: Option<&'a Value>,
}

impl<'a> Answer<'a> {
    /// Answer from the content of a truth file.
    pub(super) fn of(truth: &'a Value) -> Self {
        let effects = list(&truth["effects"]);
        let names = effects.iter().map(|e| text(e, "effect"));
        Self {
            names: names.filter(|e| *e != "unknown").collect(),
            effects,
            hard: Some(&truth["hard"]).filter(|h| h.is_object()),
        }
    }

    /// Whether a cause is among those that a hard case has besides the withheld effect: background, bias, the filter's lag.
    pub(super) fn is_beside(&self, cause: &Value) -> bool {
        let (Some(hard), name) = (self.hard, text(cause, "effect")) else {
            return false;
        };
        let on = |joint: &str| texts(&cause["joints"]).contains(&joint);
        let mut background = list(&hard["background"]).iter();
        name == "time_delay"
            || background.any(|b| text(b, "effect") == name && on(text(b, "joint")))
            || (name == "torque_offset" && on(text(&hard["bias"], "joint")))
    }

    /// Whether a cause is a withheld effect; where the background has the same name on other joints, only if it
    /// is on a joint of the effect.
    pub(super) fn is_true(&self, cause: &Value) -> bool {
        let name = text(cause, "effect");
        let joints = texts(&cause["joints"]);
        let own = |e: &Value| {
            text(e, "effect") == name && texts(&e["joints"]).iter().any(|j| joints.contains(j))
        };
        self.names.contains(&name)
            && (self.hard.is_none() || !BACKGROUND.contains(&name) || self.effects.iter().any(own))
    }

    /// Whether causes of a name are set aside before the first is looked for: every plant has small errors of its parameters, and
    /// a hard case's current filter is late.
    pub(super) fn is_aside(&self, name: &str) -> bool {
        let any = self.names.iter().any(|n| PARAMETERS.contains(n));
        match self.hard {
            Some(_) => {
                (PARAMETERS.contains(&name) || name == "time_delay") && !self.names.contains(&name)
            }
            None => PARAMETERS.contains(&name) && !any,
        }
    }

    /// Names of the withheld effects, and of effects that no recording can tell from them.
    pub(super) fn same(&self) -> Vec<&'a str> {
        let alike = self
            .effects
            .iter()
            .flat_map(|e| texts(&e["indistinguishable"]));
        self.names.iter().copied().chain(alike).collect()
    }

    /// Whether a cause names a structure that is not there at all.
    pub(super) fn is_false(&self, cause: &Value) -> bool {
        let name = text(cause, "effect");
        !PARAMETERS.contains(&name) && !self.same().contains(&name) && !self.is_beside(cause)
    }

    /// Score of a cause: 1 if it is true, half if the truth is only stated as its rival, 0 otherwise.
    pub(super) fn hit(&self, cause: Option<&Value>) -> f64 {
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
    pub(super) fn is_absorbed(&self) -> bool {
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

/// Entries of a JSON list; empty for any other value.
pub(super) fn list(v: &Value) -> &[Value] {
    v.as_array().map_or(&[], Vec::as_slice)
}

/// Number in a field of a JSON object; 0 where the field is missing.
pub(super) fn number(v: &Value, key: &str) -> f64 {
    v[key].as_f64().unwrap_or(0.0)
}
