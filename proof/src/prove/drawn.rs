//! Properties of a hard case that were drawn beside its effect.

use serde_json::Value;

/// Drawn properties of a hard case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drawn {
    /// Largest relative error of most described inertials.
    pub inertial_width: f64,
    /// Largest factor between described and real friction.
    pub friction_width: f64,
    /// Whether the torque of all joints passes the same filter.
    pub one_filter: bool,
}

impl Drawn {
    /// Properties of a hard case, from the content of a truth file; none where the case is not a hard one.
    pub fn of(truth: &Value) -> Option<Self> {
        let hard = &truth["hard"];
        Some(Self {
            inertial_width: hard["inertial_width"].as_f64()?,
            friction_width: hard["friction_width"].as_f64()?,
            one_filter: hard["lowpass"]["same"].as_bool()?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn only_hard_cases_have_drawn_anything_beside() {
        assert_eq!(Drawn::of(&json!({"hard": null})), None);
        let hard =
            json!({"inertial_width": 0.1, "friction_width": 2.0, "lowpass": {"same": false}});
        let drawn = Drawn::of(&json!({"hard": hard})).unwrap();
        assert!(!drawn.one_filter && drawn.inertial_width == 0.1);
    }
}
