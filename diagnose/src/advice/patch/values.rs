//! Table of values for simulators without a file format here, and the drive file.

use super::patched::{Patched, place_of};
use physics::robot::{JointKind, Robot};
use std::fmt::Write;
use std::path::Path;

/// First line of a patch's drive file.
const DRIVE: &str = "# Seen from the link, kg·m² (kg for a prismatic joint). Merge into the drive file where there is one.";

/// One number to be set, with its name in three simulators.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// Name of the joint to which the value belongs.
    pub joint: String,
    /// Name of the quantity that is set, such as a friction coefficient.
    pub what: &'static str,
    /// Value in the model as given, in `unit`.
    pub given: f64,
    /// Value to be set in the simulator, in `unit`.
    pub value: f64,
    /// Unit of `given` and `value`.
    pub unit: &'static str,
    /// Attribute of MuJoCo's `<joint>`.
    pub mujoco: &'static str,
    /// Property of Isaac's joint.
    pub isaac: &'static str,
    /// Element of Gazebo's `<joint>`; empty where Gazebo has none.
    pub gazebo: &'static str,
}

/// Numbers to be set, joint by joint.
pub(super) fn settings(given: &Robot, patched: &Robot) -> Vec<Setting> {
    let mut out = Vec::new();
    for (old, new) in given.joints().iter().zip(patched.joints()) {
        let turns = new.kind != JointKind::Prismatic;
        let unit = |rotation, translation| if turns { rotation } else { translation };
        let setting = |what, given, value, unit, mujoco, isaac, gazebo| Setting {
            joint: new.name.clone(),
            what,
            given,
            value,
            unit,
            mujoco,
            isaac,
            gazebo,
        };
        out.push(setting(
            "viscous friction",
            old.damping,
            new.damping,
            unit("N·m·s/rad", "N·s/m"),
            "damping",
            "joint viscous friction",
            "dynamics/damping",
        ));
        out.push(setting(
            "Coulomb friction",
            old.friction,
            new.friction,
            unit("N·m", "N"),
            "frictionloss",
            "joint dynamic friction effort",
            "dynamics/friction",
        ));
        out.push(setting(
            "rotor inertia",
            old.rotor_inertia,
            new.rotor_inertia,
            unit("kg·m²", "kg"),
            "armature",
            "joint armature",
            "",
        ));
    }
    out
}

/// Tab-separated table: parameters of every cause with the place where they are written, then the numbers to be
/// set on each joint.
///
/// `mjcf`: whether the model is an MJCF.
pub(super) fn table(patched: &Patched, settings: &[Setting], mjcf: bool) -> String {
    let mut out =
        String::from("effect\tjoints\tparameter\tvalue\tstd\tunit\twritten to\tconfirmed\n");
    for cause in patched.causes {
        let effect = cause.effect.name();
        let written = place_of(cause, mjcf).unwrap_or("this table");
        let confirmed = if cause.confirmed { "yes" } else { "no" };
        for p in &cause.parameters {
            let joints = p.joint.clone().unwrap_or_else(|| cause.joints.join(","));
            let joints = cell(&joints);
            let std = p.std.map_or(String::new(), |s| s.to_string());
            let _ = writeln!(
                out,
                "{effect}\t{joints}\t{}\t{}\t{}\t{}\t{written}\t{confirmed}",
                p.name, p.value, std, p.unit
            );
        }
        if cause.parameters.is_empty() {
            let joints = cell(&cause.joints.join(","));
            let _ = writeln!(out, "{effect}\t{joints}\t\t\t\t\t{written}\t{confirmed}");
        }
    }
    out.push_str("\njoint\tset\tgiven\tvalue\tunit\tMuJoCo\tIsaac\tGazebo (SDF)\n");
    for s in settings {
        let _ = writeln!(
            out,
            "{}\t{}\t{}\t{}\t{}\t{}\t{}\t{}",
            cell(&s.joint),
            s.what,
            s.given,
            s.value,
            s.unit,
            s.mujoco,
            s.isaac,
            s.gazebo
        );
    }
    out
}

/// A name without control characters, for one cell of the table.
fn cell(name: &str) -> String {
    let plain = |c: char| if c.is_control() { ' ' } else { c };
    name.chars().map(plain).collect()
}

/// A drive file with the rotor inertias of the patched robot.
pub(super) fn drive(robot: &Robot) -> String {
    let list: Vec<String> = robot
        .rotor_inertia()
        .iter()
        .map(|i| format!("{i:?}"))
        .collect();
    format!("{DRIVE}\nrotor_inertia = [{}]\n", list.join(", "))
}

/// Whether a file is a drive file of a patch.
pub(super) fn is_drive(path: &Path) -> bool {
    std::fs::read_to_string(path).is_ok_and(|text| text.starts_with(DRIVE))
}
