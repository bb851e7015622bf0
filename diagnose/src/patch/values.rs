//! Values for simulators without a file format of their own here, and the drive file.

use super::{Patched, place};
use physics::robot::Robot;
use std::fmt::Write;

/// Tab-separated: the parameters of every cause with where they are written, then what each joint is to be set to and
/// what three simulators call it.
pub(super) fn table(patched: &Patched) -> String {
    let mut out = String::from("effect\tjoints\tparameter\tvalue\tstd\tunit\twritten to\n");
    for cause in patched.causes {
        let effect = cause.effect.name();
        let written = place(cause.effect).unwrap_or("this table");
        for p in &cause.parameters {
            let joints = p.joint.clone().unwrap_or_else(|| cause.joints.join(","));
            let _ = writeln!(
                out,
                "{effect}\t{joints}\t{}\t{}\t{}\t{}\t{written}",
                p.name, p.value, p.std, p.unit
            );
        }
        if cause.parameters.is_empty() {
            let _ = writeln!(
                out,
                "{effect}\t{}\t\t\t\t\t{written}",
                cause.joints.join(",")
            );
        }
    }
    out.push_str("\njoint\tset\tvalue\tunit\tMuJoCo\tIsaac\tGazebo (SDF)\n");
    for joint in patched.robot.joints() {
        let (name, turns) = (&joint.name, joint.kind.is_rotation());
        let unit = |rotation: &'static str, translation| if turns { rotation } else { translation };
        let rows = [
            (
                "viscous friction",
                joint.damping,
                unit("N·m·s/rad", "N·s/m"),
                "damping",
                "joint viscous friction",
                "dynamics/damping",
            ),
            (
                "Coulomb friction",
                joint.friction,
                unit("N·m", "N"),
                "frictionloss",
                "joint dynamic friction effort",
                "dynamics/friction",
            ),
            (
                "rotor inertia",
                joint.rotor_inertia,
                unit("kg·m²", "kg"),
                "armature",
                "joint armature",
                "",
            ),
        ];
        for (what, value, unit, mujoco, isaac, gazebo) in rows {
            let _ = writeln!(
                out,
                "{name}\t{what}\t{value}\t{unit}\t{mujoco}\t{isaac}\t{gazebo}"
            );
        }
    }
    out
}

/// A drive file with the rotor inertias of the patched robot.
pub(super) fn drive(robot: &Robot) -> String {
    let list: Vec<String> = robot
        .rotor_inertia()
        .iter()
        .map(|i| format!("{i:?}"))
        .collect();
    format!(
        "# Seen from the link, kg·m² (kg for a prismatic joint). Merge into the drive file where there is one.\n\
         rotor_inertia = [{}]\n",
        list.join(", ")
    )
}
