//! The patched joints as a layer over a robot's USD stage, by the attributes of Newton's schemas (`newton-usd-schemas`,
//! `NewtonJointAPI`), which Newton and, through Omniverse's resolver, PhysX read.

use super::patched::Patched;
use physics::robot::{Joint, JointKind};
use std::f64::consts::PI;
use std::fmt::Write;

/// A layer with `newton:armature`, `newton:damping` and `newton:friction` of every joint.
///
/// Prims lie where `urdf-usd-converter` puts them: `/ROBOT/Physics/JOINT`. That converter takes neither damping
/// nor friction from a URDF, and a URDF has no rotor inertia. It does take masses and poses, so they come with
/// the converted, corrected URDF and not with this layer.
pub(super) fn layer(patched: &Patched) -> String {
    let robot = &patched.robot;
    let mut out = String::from(
        "#usda 1.0\n(\n    doc = \"\"\"Stronger layer over the robot's stage, subLayers = [@THIS@, @robot.usda@], whose joints lie in /ROBOT/Physics as\n\
         urdf-usd-converter puts them; masses, inertias, joint zeros and base come with the corrected URDF, converted. Not held: what the\n\
         values beside this file say is written elsewhere.\"\"\"\n)\n\n",
    );
    let _ = writeln!(
        out,
        "over \"{}\"\n{{\n    over \"Physics\"\n    {{",
        prim(robot.name())
    );
    for joint in robot.joints() {
        let _ = writeln!(
            out,
            "        over \"{}\" (\n            prepend apiSchemas = [\"NewtonJointAPI\"]\n        )\n        {{\n            \
             float newton:armature = {}\n            float newton:damping = {}\n            float newton:friction = {}\n        }}",
            prim(&joint.name),
            joint.rotor_inertia,
            damping(joint),
            joint.friction
        );
    }
    out.push_str("    }\n}\n");
    out
}

/// Damping in the schema's unit: N·m·s per degree, N·s/m for a joint that slides.
fn damping(joint: &Joint) -> f64 {
    match joint.kind {
        JointKind::Prismatic => joint.damping,
        _ => joint.damping * PI / 180.0,
    }
}

/// A name with the characters that a prim may have. Converters treat other names in their own ways: those are to be set by hand.
fn prim(name: &str) -> String {
    let mut out: String = name
        .chars()
        .map(|c| if c.is_ascii_alphanumeric() { c } else { '_' })
        .collect();
    if !out.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_') {
        out.insert(0, '_');
    }
    out
}
