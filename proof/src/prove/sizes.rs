//! Errors of reported sizes against the true ones.

use model::spread::NINETY;
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

/// An effect as the recording of a case shows it. Where filters delay the torque, their lag is added to the
/// withheld delay: nothing separates the two.
pub fn as_recorded(effect: &Value, truth: &Value) -> Value {
    let mut shown = effect.clone();
    let lags = truth["hard"]["lowpass"]["lag_ms"].as_array();
    let lags: Vec<f64> = lags
        .into_iter()
        .flatten()
        .filter_map(Value::as_f64)
        .collect();
    let delay = effect["parameters"]["delay"].as_f64();
    if let ("time_delay", Some(delay), false) = (
        effect["effect"].as_str().unwrap_or_default(),
        delay,
        lags.is_empty(),
    ) {
        let lag = 1e-3 * lags.iter().sum::<f64>() / lags.len() as f64;
        shown["parameters"]["delay"] = (delay + lag).into();
    }
    shown
}

/// Relative error of a true effect's size in a reported cause. A size of several components counts as a vector. None
/// where mechanism and detector have no parameter in common.
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

/// Error of the reported size of a true effect, in its standard deviations; positive where too large. None
/// where mechanism and detector have no parameter in common, or no deviation is reported.
pub fn deviations(effect: &Value, cause: &Value) -> Option<f64> {
    let name = effect["effect"].as_str()?;
    let mut own = COMMON.iter().filter(|c| c.0 == name);
    let (Some((_, truth, factor, reported, _)), None) = (own.next(), own.next()) else {
        return None;
    };
    let wanted = effect["parameters"][*truth].as_f64()? * factor;
    let list = cause["parameters"].as_array()?;
    let found = list.iter().find(|p| p["name"] == *reported)?;
    let (value, std) = (found["value"].as_f64()?, found["std"].as_f64()?);
    (std > 0.0).then(|| (value - wanted) / std)
}

/// Whether the 90 % interval of a size holds the true one, which is so many deviations away.
pub fn covered(deviations: f64) -> bool {
    deviations.abs() <= NINETY
}

/// Part of the cases that must be found for a share to count as detected.
const FOUND: f64 = 0.8;

/// Smallest share of a joint's torque from which on `FOUND` of the cases are found. `cases` holds (share, found).
pub fn detected_from(mut cases: Vec<(f64, bool)>) -> Option<f64> {
    cases.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut found = 0.0;
    let mut from = None;
    for (i, (share, own)) in cases.into_iter().enumerate() {
        found += f64::from(u8::from(own));
        if found >= FOUND * (i + 1) as f64 {
            from = Some(share);
        }
    }
    from
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
    fn what_was_withheld_and_a_filter_are_late_together() {
        let delay = json!({"effect": "time_delay", "parameters": {"delay": 0.03}});
        let truth = json!({"hard": {"lowpass": {"lag_ms": [10.0, 20.0]}}});
        let late = |effect: &Value, truth: &Value| as_recorded(effect, truth)["parameters"].clone();
        let shown = late(&delay, &truth)["delay"].as_f64().unwrap();
        assert!((shown - 0.045).abs() < 1e-12);
        assert_eq!(late(&delay, &json!({})), delay["parameters"]);
        let gain = json!({"effect": "torque_gain", "parameters": {"gain": 1.2}});
        assert_eq!(late(&gain, &truth), gain["parameters"]);
    }

    #[test]
    fn an_interval_holds_the_true_size_or_not() {
        let truth = json!({"effect": "backlash", "parameters": {"play": 0.02}});
        let cause = |value: f64| json!({"parameters": [{"name": "half_play", "value": value, "std": 1e-3}]});
        let off = |value| deviations(&truth, &cause(value));
        assert!((off(0.0115).unwrap() - 1.5).abs() < 1e-9);
        assert_eq!(off(0.0115).map(covered), Some(true));
        assert_eq!(off(0.008).map(covered), Some(false));
        assert_eq!(deviations(&truth, &json!({"parameters": []})), None);
        let tilt = json!({"effect": "base_tilt", "parameters": {"tilt_x": 0.1, "tilt_y": 0.1}});
        assert_eq!(deviations(&tilt, &cause(0.1)), None);
    }

    #[test]
    fn four_of_five_are_found_from_some_share_on() {
        let shares = [0.4, 0.3, 0.25, 0.2, 0.15, 0.1, 0.05];
        let found = [true, false, true, true, true, false, false];
        let cases = shares.into_iter().zip(found).collect();
        // Two of three are too few, four of five are enough, and of smaller ones not enough are found.
        assert_eq!(detected_from(cases), Some(0.15));
        assert_eq!(detected_from(vec![(0.3, false)]), None);
    }
}
