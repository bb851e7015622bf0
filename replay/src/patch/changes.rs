//! What a corrected model's files change, in words.

use crate::arm::Arm;
use crate::given::Given;
use crate::words::number;

/// Lines of what the files of `arm` change of the simulator as given: one for each joint, and one for each value of the whole
/// arm.
pub(super) fn changes(given: &Given, arm: &Arm) -> Vec<String> {
    let old = &given.arm;
    let mut out = Vec::new();
    for (j, name) in arm.robot.joint_names().into_iter().enumerate() {
        let (s, t) = (&old.servos[j], &arm.servos[j]);
        let (a, b) = (&old.joints[j], &arm.joints[j]);
        let limit = |s: &crate::arm::Servo| s.limit.min(s.drive_limit);
        let values = [
            ("kp", s.kp, t.kp),
            ("kd", s.kd, t.kd),
            ("ki", s.ki, t.ki),
            ("limit", limit(s), limit(t)),
            ("delay", old.late(j), arm.late(j)),
            ("damping", a.damping, b.damping),
            ("frictionloss", a.coulomb, b.coulomb),
            ("armature", a.armature, b.armature),
            (
                "mass and inertia by the factor",
                old.link_scale[j],
                arm.link_scale[j],
            ),
            ("zero", old.zero[j], arm.zero[j]),
        ];
        let said: Vec<String> = values.into_iter().filter_map(change).collect();
        if !said.is_empty() {
            out.push(format!("{name}: {}", said.join(", ")));
        }
    }
    let load = change(("payload", old.payload[0], arm.payload[0]));
    out.extend(load.map(|c| format!("{c} kg")));
    for (name, k) in [("tilt_x", 0), ("tilt_y", 1)] {
        out.extend(change((name, old.tilt[k], arm.tilt[k])).map(|c| format!("{c} rad")));
    }
    out
}

/// Value that differs in three digits: "kp 150 → 120".
fn change((name, from, to): (&str, f64, f64)) -> Option<String> {
    let said = |v: f64| {
        if v.is_infinite() {
            "none".to_owned()
        } else {
            number(v)
        }
    };
    let rounded = |v: f64| format!("{v:.2e}");
    (rounded(from) != rounded(to)).then(|| format!("{name} {} → {}", said(from), said(to)))
}

/// Line on the friction that an MJCF is given with its values: as stiff at rest as the replay's.
pub(super) fn held_at_rest(arm: &Arm) -> Option<String> {
    arm.joints.iter().any(|j| j.coulomb > 0.0).then(|| {
        "joints with frictionloss: solreffriction 0.001 1, solimpfriction 0.9999 0.9999, so that dry friction holds a joint at rest \
         (MuJoCo's own gives way over 10 ms)"
            .to_owned()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_the_same_in_three_digits_is_not_said() {
        assert_eq!(change(("armature", 0.01, 0.0099996)), None);
        assert_eq!(change(("limit", f64::INFINITY, f64::INFINITY)), None);
        let limit = change(("limit", f64::INFINITY, 3.112));
        assert_eq!(limit.as_deref(), Some("limit none → 3.11"));
        assert_eq!(
            change(("kp", 150.0, 120.0)).as_deref(),
            Some("kp 150 → 120")
        );
    }
}
