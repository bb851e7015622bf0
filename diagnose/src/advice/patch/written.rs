//! Changes of a patch in the description as text, and a check of the written files.

use super::patched::Patched;
use crate::error::DiagnoseError;
use physics::dynamics::{Workspace, inverse_dynamics};
use physics::robot::Robot;

/// Relative difference between a written number and the intended one that counts as rounding.
const ROUNDING: f64 = 1e-6;

/// Relative change below which it is not printed.
const UNSEEN: f64 = 1e-4;

/// Changes from the given robot, a line each: from → to. Centres of mass are in the frame of their link.
pub(super) fn changes(given: &Robot, patched: &Patched<'_>) -> Vec<String> {
    let mut lines = Vec::new();
    for (old, new) in given.joints().iter().zip(patched.unloaded.joints()) {
        let (was, is) = (&old.link.inertia, &new.link.inertia);
        let mut parts = Vec::new();
        let mut say = |what: &str, was: f64, is: f64, unit: &str| {
            if (was - is).abs() > UNSEEN * was.abs().max(is.abs()) {
                parts.push(format!("{what} {} → {} {unit}", short(was), short(is)));
            }
        };
        say("mass", was.mass, is.mass, "kg");
        for (axis, name) in ["x", "y", "z"].iter().enumerate() {
            let what = format!("centre of mass {name}");
            say(&what, was.com()[axis], is.com()[axis], "m");
        }
        let of_both = was
            .principal_moments()
            .into_iter()
            .zip(is.principal_moments());
        for ((was, is), name) in of_both.zip(["least", "middle", "largest"]) {
            say(&format!("{name} principal moment"), was, is, "kg·m²");
        }
        if !parts.is_empty() {
            lines.push(format!("link {}: {}", new.link.name, parts.join(", ")));
        }
        let rotates = new.kind.is_rotation();
        let unit =
            |turning: &'static str, sliding: &'static str| if rotates { turning } else { sliding };
        let mut parts = Vec::new();
        for (what, was, is, unit) in [
            (
                "damping",
                old.damping,
                new.damping,
                unit("N·m·s/rad", "N·s/m"),
            ),
            ("friction", old.friction, new.friction, unit("N·m", "N")),
            (
                "rotor inertia",
                old.rotor_inertia,
                new.rotor_inertia,
                unit("kg·m²", "kg"),
            ),
        ] {
            if (was - is).abs() > UNSEEN * was.abs().max(is.abs()) {
                parts.push(format!("{what} {} → {} {unit}", short(was), short(is)));
            }
        }
        if !parts.is_empty() {
            lines.push(format!("joint {}: {}", new.name, parts.join(", ")));
        }
    }
    if let Some(load) = &patched.load {
        let com = load.inertia.com();
        let carrier = &patched.robot.joints()[load.link].link.name;
        lines.push(format!(
            "payload, a body of its own on {carrier}: {} kg at ({}, {}, {}) m in the frame of {carrier}",
            short(load.inertia.mass),
            short(com.x),
            short(com.y),
            short(com.z)
        ));
    }
    lines
}

/// A number with four significant digits.
fn short(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let digits = 3 - value.abs().log10().floor() as i32;
    match usize::try_from(digits) {
        Ok(digits) if digits <= 8 => format!("{value:.digits$}"),
        Ok(_) => format!("{value:.3e}"),
        Err(_) => format!("{value:.0}"),
    }
}

/// Compares a robot that was read back with the intended one: torque at a pose in motion, and friction.
///
/// # Errors
/// They differ.
pub(super) fn compare(
    what: &str,
    wanted: &Robot,
    zeros: &[f64],
    read: &Robot,
    rotors: bool,
) -> Result<(), DiagnoseError> {
    let n = wanted.dof();
    let refuse = |reason: String| DiagnoseError::Patch(format!("{what}: {reason}"));
    if read.joint_names() != wanted.joint_names() {
        return Err(refuse(format!(
            "read back it is the chain {}",
            read.joint_names().join(", ")
        )));
    }
    let state = |k: usize, f: f64| f * (1.3 * (k as f64 + 1.0)).sin();
    let q: Vec<f64> = (0..n).map(|k| state(k, 0.7)).collect();
    let moved: Vec<f64> = (0..n)
        .map(|k| q[k] + zeros.get(k).unwrap_or(&0.0))
        .collect();
    let (qd, qdd): (Vec<f64>, Vec<f64>) = (0..n)
        .map(|k| (state(k + 5, 1.0), state(k + 9, 2.0)))
        .unzip();
    let torque = |robot: &Robot, q: &[f64]| {
        let mut tau = vec![0.0; n];
        inverse_dynamics(robot, &mut Workspace::new(robot), q, &qd, &qdd, &mut tau);
        tau
    };
    let (a, b) = (torque(wanted, &moved), torque(read, &q));
    let size = a.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    for ((joint, a), b) in wanted.joints().iter().zip(a).zip(b) {
        if (a - b).abs() > ROUNDING * size {
            return Err(refuse(format!(
                "read back joint {} needs {b} instead of {a} N·m or N",
                joint.name
            )));
        }
    }
    for (a, b) in wanted.joints().iter().zip(read.joints()) {
        let mut pairs = vec![
            ("damping", a.damping, b.damping),
            ("friction", a.friction, b.friction),
        ];
        if rotors {
            pairs.push(("rotor inertia", a.rotor_inertia, b.rotor_inertia));
        }
        if let Some((name, a_, b_)) = pairs
            .into_iter()
            .find(|(_, a, b)| (a - b).abs() > ROUNDING * a.abs().max(b.abs()))
        {
            return Err(refuse(format!(
                "read back {name} of joint {} is {b_} instead of {a_}",
                a.name
            )));
        }
    }
    Ok(())
}
