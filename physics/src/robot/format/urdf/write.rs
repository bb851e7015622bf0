//! Writing a URDF: from scratch, or new numbers into an existing text.

use super::read::UNLIMITED;
use crate::robot::{Inertia, Joint, JointKind, Robot, RobotError};
use nalgebra::Matrix3;
use roxmltree::{Document, Node};
use std::collections::HashSet;
use std::fmt::Write;
use std::ops::Range;

/// The robot as a URDF of its own, one link per joint. Read back it is the same robot, but for what a URDF cannot
/// hold (rotor inertia, gear ratio, torque constant, counterbalance, gravity).
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

/// `urdf` with the inertias, damping and friction of `robot`, everything else untouched to the byte.
///
/// A moving joint's inertia includes what is fixed to its link, so it is written to that link, and the
/// `<inertial>` elements of the links fixed to it are removed.
///
/// # Errors
/// `urdf` is no URDF, or not that of this robot's links and joints.
pub fn urdf_with(urdf: &str, robot: &Robot) -> Result<String, RobotError> {
    let document = Document::parse(urdf).map_err(|e| RobotError::Syntax {
        reason: e.to_string(),
    })?;
    let root = document.root_element();
    let mut edits: Vec<(Range<usize>, String)> = Vec::new();
    for joint in robot.joints() {
        let link = find(root, "link", &joint.link.name)?;
        edit_child(
            &mut edits,
            urdf,
            link,
            "inertial",
            inertial(&joint.link.inertia),
        );
        for merged in fixed_below(root, &joint.link.name) {
            let node = find(root, "link", merged)?;
            edits.extend(inertials(node).map(|n| (n.range(), String::new())));
        }
        let node = find(root, "joint", &joint.name)?;
        if joint.damping != 0.0 || joint.friction != 0.0 || child(node, "dynamics").is_some() {
            edit_child(&mut edits, urdf, node, "dynamics", dynamics(joint));
        }
    }
    // From the end, so that earlier ranges stay valid.
    edits.sort_by_key(|(range, _)| std::cmp::Reverse(range.start));
    let mut text = urdf.to_owned();
    for (range, replacement) in edits {
        text.replace_range(range, &replacement);
    }
    Ok(text)
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

/// Names of all links that hang on `link` by fixed joints alone.
fn fixed_below<'a>(root: Node<'a, '_>, link: &'a str) -> Vec<&'a str> {
    let mut found = Vec::new();
    let mut seen = HashSet::from([link]);
    let mut open = vec![link];
    while let Some(parent) = open.pop() {
        for joint in root.children().filter(|n| n.has_tag_name("joint")) {
            let end = |tag| child(joint, tag).and_then(|n| n.attribute("link"));
            if joint.attribute("type") != Some("fixed") || end("parent") != Some(parent) {
                continue;
            }
            if let Some(name) = end("child").filter(|name| seen.insert(name)) {
                found.push(name);
                open.push(name);
            }
        }
    }
    found
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

fn inertials<'a, 'd>(node: Node<'a, 'd>) -> impl Iterator<Item = Node<'a, 'd>> {
    node.children().filter(|n| n.has_tag_name("inertial"))
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

/// Attribute text.
fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('"', "&quot;")
}
