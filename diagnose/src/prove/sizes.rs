//! How far reported sizes are from true ones.

use serde_json::Value;

/// Parameters that a mechanism and the detector's form have in common: effect, name in the answer with its factor, name
/// in the report, value that means no effect.
const COMMON: [(&str, &str, f64, &str, f64); 11] = [
    ("payload", "mass", 1.0, "mass", 0.0),
    ("rotor_inertia", "inertia", 1.0, "inertia", 0.0),
    ("base_tilt", "tilt_x", 1.0, "tilt_x", 0.0),
    ("base_tilt", "tilt_y", 1.0, "tilt_y", 0.0),
    ("joint_elasticity", "stiffness", 1.0, "stiffness", 0.0),
    ("backlash", "play", 0.5, "half_play", 0.0),
    ("torque_gain", "gain", 1.0, "gain", 1.0),
    ("torque_offset", "offset", 1.0, "offset", 0.0),
    ("time_delay", "delay", 1.0, "delay", 0.0),
    ("saturation", "limit", 1.0, "limit", 0.0),
    // The answer has what the encoder adds, the report what has to be added to it.
    ("encoder_offset", "zero", -1.0, "zero", 0.0),
];

/// Deviations on either side that hold 90 % of a normal distribution.
const TWO_SIDED: f64 = 1.645;

/// Relative error of the size of a true effect as a reported cause has it; of several components, of the vector. None
/// where mechanism and detector share no parameter.
pub fn size_error(effect: &Value, cause: &Value) -> Option<f64> {
    let name = effect["effect"].as_str()?;
    let (mut off, mut size) = (0.0, 0.0);
    for (_, truth, factor, reported, nothing) in COMMON.iter().filter(|c| c.0 == name) {
        let wanted = effect["parameters"][*truth].as_f64()? * factor - nothing;
        let list = cause["parameters"].as_array()?;
        let found = list.iter().find(|p| p["name"] == *reported)?["value"].as_f64()? - nothing;
        off += (found - wanted).powi(2);
        size += wanted * wanted;
    }
    (size > 0.0).then(|| (off / size).sqrt())
}

/// Whether the 90 % interval of a true effect's size holds it; none where mechanism and detector share no one number, or no deviation
/// is reported.
pub fn covered(effect: &Value, cause: &Value) -> Option<bool> {
    let name = effect["effect"].as_str()?;
    let mut own = COMMON.iter().filter(|c| c.0 == name);
    let (Some((_, truth, factor, reported, _)), None) = (own.next(), own.next()) else {
        return None;
    };
    let wanted = effect["parameters"][*truth].as_f64()? * factor;
    let list = cause["parameters"].as_array()?;
    let found = list.iter().find(|p| p["name"] == *reported)?;
    let (value, std) = (found["value"].as_f64()?, found["std"].as_f64()?);
    Some((value - wanted).abs() <= TWO_SIDED * std)
}

/// Smallest share of a joint's torque from which on every case is found: cases as (share, found).
pub fn detected_from(mut cases: Vec<(f64, bool)>) -> Option<f64> {
    cases.sort_by(|a, b| b.0.total_cmp(&a.0));
    let found = cases.iter().take_while(|c| c.1);
    found.last().map(|c| c.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn errors_are_relative_to_the_effect() {
        let truth = json!({"effect": "torque_gain", "parameters": {"gain": 1.2}});
        let cause = json!({"parameters": [{"name": "gain", "value": 1.25}]});
        assert!((size_error(&truth, &cause).unwrap() - 0.25).abs() < 1e-12);
        let truth = json!({"effect": "base_tilt", "parameters": {"tilt_x": 0.03, "tilt_y": 0.04}});
        let cause = json!({"parameters": [{"name": "tilt_x", "value": 0.03}, {"name": "tilt_y", "value": 0.035}]});
        assert!((size_error(&truth, &cause).unwrap() - 0.1).abs() < 1e-12);
        assert_eq!(
            size_error(&json!({"effect": "stribeck_friction"}), &cause),
            None
        );
    }

    #[test]
    fn an_interval_holds_the_true_size_or_not() {
        let truth = json!({"effect": "backlash", "parameters": {"play": 0.02}});
        let cause = |value: f64| json!({"parameters": [{"name": "half_play", "value": value, "std": 1e-3}]});
        assert_eq!(covered(&truth, &cause(0.0115)), Some(true));
        assert_eq!(covered(&truth, &cause(0.012)), Some(false));
        assert_eq!(covered(&truth, &json!({"parameters": []})), None);
        let tilt = json!({"effect": "base_tilt", "parameters": {"tilt_x": 0.1, "tilt_y": 0.1}});
        assert_eq!(covered(&tilt, &cause(0.1)), None);
    }

    #[test]
    fn one_miss_hides_what_is_smaller() {
        let cases = vec![(0.3, true), (0.05, true), (0.1, false), (0.2, true)];
        assert_eq!(detected_from(cases), Some(0.2));
        assert_eq!(detected_from(vec![(0.3, false)]), None);
    }
}
