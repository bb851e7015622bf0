//! The patched robot in MuJoCo's XML: elements to be merged into a model by name.

use super::patched::Patched;
use report::xml::attribute;
use std::fmt::Write;

/// A well-formed document with `<option>`, every joint and body of the robot, and all else that MJCF can hold.
pub(super) fn snippet(patched: &Patched, zeros: &[f64]) -> String {
    let robot = &patched.robot;
    let mut out = String::from("<mujoco>\n  <!-- Merge by name into the robot's model. -->\n");
    let g = patched.gravity();
    let _ = writeln!(out, "  <option gravity=\"{} {} {}\"/>", g.x, g.y, g.z);
    out.push_str("  <worldbody>\n");
    for (joint, zero) in robot.joints().iter().zip(zeros) {
        let (body, name) = (attribute(&joint.link.name), attribute(&joint.name));
        let inertia = &joint.link.inertia;
        let (c, i) = (inertia.com(), inertia.about_com());
        let _ = writeln!(out, "    <body name=\"{body}\">");
        let _ = writeln!(
            out,
            "      <inertial pos=\"{} {} {}\" mass=\"{}\" fullinertia=\"{} {} {} {} {} {}\"/>",
            c.x,
            c.y,
            c.z,
            inertia.mass,
            i[(0, 0)],
            i[(1, 1)],
            i[(2, 2)],
            i[(0, 1)],
            i[(0, 2)],
            i[(1, 2)],
        );
        // MuJoCo's `ref` is the position that the joint has where the model is drawn.
        let zero = if *zero == 0.0 {
            String::new()
        } else {
            format!(" ref=\"{}\"", -zero)
        };
        let _ = writeln!(
            out,
            "      <joint name=\"{name}\" damping=\"{}\" frictionloss=\"{}\" armature=\"{}\"{zero}/>",
            joint.damping, joint.friction, joint.rotor_inertia
        );
        out.push_str("    </body>\n");
    }
    out.push_str("  </worldbody>\n");
    for cause in patched.causes {
        let by_hand = cause.effect.info().by_hand;
        let Some(said) = by_hand(&cause.joints, &cause.parameters) else {
            continue;
        };
        let _ = writeln!(out, "  <!-- {} -->", said.replace("--", "- -"));
    }
    out.push_str("</mujoco>\n");
    out
}
