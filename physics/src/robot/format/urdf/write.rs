//! Writing a URDF: from scratch, or new numbers into an existing text.

use super::elements::{Pose, UNLIMITED};
use super::read::{Model, Placed};
use crate::robot::format::changed::{Changed, load_name};
use crate::robot::format::share::{departs, share};
use crate::robot::{Inertia, Joint, JointKind, Masses, Robot, RobotError};
use nalgebra::Matrix3;
use roxmltree::{Document, Node};
use std::fmt::Write;
use std::ops::Range;

/// The robot as a URDF of its own, one link per joint. Read back it is the same robot, except for properties
/// that a URDF cannot hold (rotor inertia, gear ratio, torque constant, counterbalance, gravity).
pub fn to_urdf(robot: &Robot) -> String {
    let mut base = "base_link".to_owned();
    while robot.joints().iter().any(|j| j.link.name == base) {
        base.push('_');
    }
    let mut text = format!(
        "<?xml version=\"1.0\"?>\n<robot name=\"{}\">\n  <link name=\"{}\"/>\n",
        escape(robot.name()),
        escape(&base)
    );
    let mut parent = base.as_str();
    for joint in robot.joints() {
        write_joint(&mut text, joint, parent);
        let _ = writeln!(text, "  <link name=\"{}\">", escape(&joint.link.name));
        let _ = writeln!(text, "    {}", inertial(&joint.link.inertia));
        text.push_str("  </link>\n");
        parent = &joint.link.name;
    }
    text.push_str("</robot>\n");
    text
}

/// `text`, which `document` is of, with the numbers of a changed robot.
pub(super) fn changed(
    text: &str,
    document: &Document<'_>,
    model: &Model<'_>,
    changed: &Changed<'_>,
) -> Result<String, RobotError> {
    let (root, given, robot) = (document.root_element(), model.robot()?, changed.robot);
    if given.joint_names() != robot.joint_names() {
        let known = given.joint_names();
        let other = robot.joint_names().into_iter().find(|n| !known.contains(n));
        return Err(RobotError::Mismatch {
            what: "joint",
            name: other.unwrap_or_else(|| robot.name().to_owned()),
        });
    }
    let mut edits: Vec<(Range<usize>, String)> = Vec::new();
    for (j, (old, new)) in given.joints().iter().zip(robot.joints()).enumerate() {
        if given.masses() == Masses::Missing || departs(&old.link.inertia, &new.link.inertia) {
            for (link, inertia) in bodies(model, j, &new.link.inertia) {
                let node = find(root, "link", link)?;
                edit_child(&mut edits, text, node, "inertial", inertial(&inertia));
            }
        }
        let node = find(root, "joint", &new.name)?;
        if (old.damping, old.friction) != (new.damping, new.friction) {
            edit_child(&mut edits, text, node, "dynamics", dynamics(new));
        }
        if let Some(pose) = model.moved_origin(j, changed) {
            edit_child(&mut edits, text, node, "origin", origin(&pose));
        }
    }
    if let Some(load) = &changed.load {
        let carrier = &robot.joints()[load.link].link.name;
        let at = root
            .last_element_child()
            .map_or(root.range().end, |c| c.range().end);
        edits.push((at..at, load_elements(root, carrier, &load.inertia)));
    }
    // From the end, so that earlier ranges stay valid.
    edits.sort_by_key(|(range, _)| std::cmp::Reverse(range.start));
    let mut text = text.to_owned();
    for (range, replacement) in edits {
        text.replace_range(range, &replacement);
    }
    Ok(text)
}

/// Links with the inertias, in their own frames, that together make that of chosen joint `j`.
fn bodies<'a>(model: &Model<'a>, j: usize, whole: &Inertia) -> Vec<(&'a str, Inertia)> {
    let placed = model.placed();
    let own: Vec<&Placed<'a>> = placed.iter().filter(|l| l.carriers == j + 1).collect();
    let heavy = own.iter().filter_map(|&link| {
        let inertia = model.inertia(link.name).filter(|i| i.mass > 0.0)?;
        Some((link, inertia.transformed(&link.pose.0, &link.pose.1)))
    });
    let mut bodies: Vec<(&Placed<'a>, Inertia)> = heavy.collect();
    // Where none has a mass the joint's own link gets it.
    if bodies.is_empty() {
        bodies.extend(own.first().map(|&link| (link, Inertia::default())));
    }
    let list: Vec<Inertia> = bodies.iter().map(|(_, i)| *i).collect();
    let shared = bodies.iter().zip(share(whole, &list));
    shared
        .map(|((link, _), inertia)| {
            let turned = link.pose.0.transpose();
            let origin = -(turned * link.pose.1);
            (link.name, inertia.transformed(&turned, &origin))
        })
        .collect()
}

/// A link with a load and the joint that fixes it to a link.
fn load_elements(root: Node<'_, '_>, carrier: &str, load: &Inertia) -> String {
    let name = load_name(|name| {
        root.children()
            .any(|n| n.attribute("name").is_some_and(|own| own.starts_with(name)))
    });
    format!(
        "\n  <link name=\"{name}\">{}</link>\n  <joint name=\"{name}_joint\" type=\"fixed\"><parent link=\"{}\"/>\
         <child link=\"{name}\"/></joint>",
        inertial(load),
        escape(carrier)
    )
}

fn origin(pose: &Pose) -> String {
    let (roll, pitch, yaw) = roll_pitch_yaw(&pose.0);
    let t = &pose.1;
    format!(
        "<origin xyz=\"{} {} {}\" rpy=\"{roll} {pitch} {yaw}\"/>",
        t.x, t.y, t.z
    )
}

/// Replaces the child element `tag` of `node`, or adds it as the first child.
fn edit_child(
    edits: &mut Vec<(Range<usize>, String)>,
    urdf: &str,
    node: Node<'_, '_>,
    tag: &str,
    element: String,
) {
    if let Some(old) = child(node, tag) {
        edits.push((old.range(), element));
        return;
    }
    let range = node.range();
    if let Some(first) = node.first_child() {
        let at = first.range().start;
        edits.push((at..at, format!("\n    {element}")));
        return;
    }
    // <link name="x"/> or <link name="x"></link>: keep the start tag, close it after the element.
    let source = &urdf[range.clone()];
    let start = source
        .strip_suffix("/>")
        .or_else(|| source.find("></").map(|at| &source[..at]))
        .unwrap_or(source);
    let name = node.tag_name().name();
    let filled = format!("{}>\n    {element}\n  </{name}>", start.trim_end());
    edits.push((range, filled));
}

fn find<'a, 'd>(
    root: Node<'a, 'd>,
    what: &'static str,
    name: &str,
) -> Result<Node<'a, 'd>, RobotError> {
    root.children()
        .find(|n| n.has_tag_name(what) && n.attribute("name") == Some(name))
        .ok_or_else(|| RobotError::Mismatch {
            what,
            name: name.to_owned(),
        })
}

fn child<'a, 'd>(node: Node<'a, 'd>, tag: &str) -> Option<Node<'a, 'd>> {
    node.children().find(|n| n.has_tag_name(tag))
}

/// `<inertial>` with the directions of the link's frame, so that no rotation is needed.
fn inertial(inertia: &Inertia) -> String {
    let (c, i) = (inertia.com(), inertia.about_com());
    format!(
        "<inertial><origin xyz=\"{} {} {}\" rpy=\"0 0 0\"/><mass value=\"{}\"/>\
         <inertia ixx=\"{}\" ixy=\"{}\" ixz=\"{}\" iyy=\"{}\" iyz=\"{}\" izz=\"{}\"/></inertial>",
        c.x,
        c.y,
        c.z,
        inertia.mass,
        i[(0, 0)],
        i[(0, 1)],
        i[(0, 2)],
        i[(1, 1)],
        i[(1, 2)],
        i[(2, 2)],
    )
}

fn dynamics(joint: &Joint) -> String {
    format!(
        "<dynamics damping=\"{}\" friction=\"{}\"/>",
        joint.damping, joint.friction
    )
}

fn write_joint(text: &mut String, joint: &Joint, parent: &str) {
    let kind = match joint.kind {
        JointKind::Revolute => "revolute",
        JointKind::Continuous => "continuous",
        JointKind::Prismatic => "prismatic",
    };
    let (roll, pitch, yaw) = roll_pitch_yaw(&joint.rotation);
    let (t, a) = (&joint.translation, &joint.axis);
    let _ = write!(
        text,
        "  <joint name=\"{}\" type=\"{kind}\">\n    \
         <parent link=\"{}\"/>\n    <child link=\"{}\"/>\n    \
         <origin xyz=\"{} {} {}\" rpy=\"{roll} {pitch} {yaw}\"/>\n    \
         <axis xyz=\"{} {} {}\"/>\n",
        escape(&joint.name),
        escape(parent),
        escape(&joint.link.name),
        t.x,
        t.y,
        t.z,
        a.x,
        a.y,
        a.z,
    );
    let limits = &joint.limits;
    let mut bounds = vec![("velocity", limits.velocity), ("effort", limits.effort)];
    if joint.kind != JointKind::Continuous {
        bounds.extend([("lower", limits.lower), ("upper", limits.upper)]);
    }
    // Where there is a limit, or must be one, the format demands every attribute, and zero would mean a joint that
    // can do nothing.
    if joint.kind != JointKind::Continuous || bounds.iter().any(|(_, v)| v.is_finite()) {
        text.push_str("    <limit");
        for (name, value) in bounds {
            let _ = write!(text, " {name}=\"{}\"", value.clamp(-UNLIMITED, UNLIMITED));
        }
        text.push_str("/>\n");
    }
    if joint.damping != 0.0 || joint.friction != 0.0 {
        let _ = writeln!(text, "    {}", dynamics(joint));
    }
    text.push_str("  </joint>\n");
}

/// Fixed-axis angles of a rotation. The roll is measured after the yaw is undone, which is exact also where the
/// pitch is a right angle and only their difference is determined.
fn roll_pitch_yaw(r: &Matrix3<f64>) -> (f64, f64, f64) {
    let yaw = r.m21.atan2(r.m11);
    let (s, c) = yaw.sin_cos();
    let roll = (s * r.m13 - c * r.m23).atan2(c * r.m22 - s * r.m12);
    let pitch = (-r.m31).atan2(c * r.m11 + s * r.m21);
    (roll, pitch, yaw)
}

/// Text of an attribute, with reserved characters escaped.
fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('"', "&quot;")
}
