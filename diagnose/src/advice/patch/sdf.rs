//! The patched robot in Gazebo's SDF: links and joints by name, to be merged into a model.

use super::patched::Patched;
use report::xml::attribute;
use std::fmt::Write;

/// Document with the inertial of every link that a joint moves and each joint's `<dynamics>`. The inertial
/// includes bodies fixed to the link, as Gazebo lumps them when it reads a URDF. A comment at its head lists
/// what SDF cannot hold.
pub(super) fn document(patched: &Patched) -> String {
    let robot = &patched.robot;
    let mut out = String::from(
        "<?xml version=\"1.0\"?>\n<!-- Merge by name into the robot's model; `gz sdf -p` makes a whole one of the corrected URDF, joint zeros and base \
         included. -->\n",
    );
    for joint in robot.joints().iter().filter(|j| j.rotor_inertia != 0.0) {
        let said = format!(
            "{}: SDF has no rotor inertia, which is {}",
            joint.name, joint.rotor_inertia
        );
        let _ = writeln!(out, "<!-- {} -->", said.replace("--", "- -"));
    }
    let _ = writeln!(
        out,
        "<sdf version=\"1.9\">\n  <model name=\"{}\">",
        attribute(robot.name())
    );
    for joint in robot.joints() {
        let inertia = &joint.link.inertia;
        let (c, i) = (inertia.com(), inertia.about_com());
        let _ = writeln!(
            out,
            "    <link name=\"{}\">\n      <inertial>\n        <pose>{} {} {} 0 0 0</pose>\n        <mass>{}</mass>\n        <inertia>",
            attribute(&joint.link.name),
            c.x,
            c.y,
            c.z,
            inertia.mass
        );
        for (name, at) in [
            ("ixx", (0, 0)),
            ("ixy", (0, 1)),
            ("ixz", (0, 2)),
            ("iyy", (1, 1)),
            ("iyz", (1, 2)),
            ("izz", (2, 2)),
        ] {
            let _ = writeln!(out, "          <{name}>{}</{name}>", i[at]);
        }
        out.push_str("        </inertia>\n      </inertial>\n    </link>\n");
    }
    for joint in robot.joints() {
        let _ = writeln!(
            out,
            "    <joint name=\"{}\">\n      <axis>\n        <dynamics>\n          <damping>{}</damping>\n          <friction>{}</friction>\n        \
             </dynamics>\n      </axis>\n    </joint>",
            attribute(&joint.name),
            joint.damping,
            joint.friction
        );
    }
    out.push_str("  </model>\n</sdf>\n");
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::advice::patch::usd;
    use nalgebra::Vector3;
    use physics::robot::Robot;
    use roxmltree::{Document, Node};

    const ARM: &str = r#"<robot name="my arm"><link name="base"/>
<link name="l1"><inertial><origin xyz="0.1 0 0.05"/><mass value="2"/><inertia ixx="0.02" ixy="0.001" ixz="0.002" iyy="0.03" iyz="0.003" izz="0.04"/></inertial></link>
<joint name="j1" type="revolute"><parent link="base"/><child link="l1"/><axis xyz="0 1 0"/><dynamics damping="1.8" friction="0.7"/>
<limit lower="-1" upper="1" velocity="1" effort="9"/></joint>
<link name="l2"><inertial><mass value="1"/><inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>
<joint name="slide" type="prismatic"><parent link="l1"/><child link="l2"/><axis xyz="0 0 1"/><dynamics damping="5" friction="3"/>
<limit lower="-1" upper="1" velocity="1" effort="9"/></joint></robot>"#;

    fn patched() -> Patched<'static> {
        let robot = Robot::from_urdf_str(ARM).unwrap();
        let robot = robot.with_rotor_inertia(&[0.25, 0.0]).unwrap();
        Patched {
            unloaded: robot.clone(),
            robot,
            load: None,
            tilt: Vector3::zeros(),
            causes: &[],
        }
    }

    fn number(node: Node, name: &str) -> f64 {
        let found = node.descendants().find(|n| n.has_tag_name(name)).unwrap();
        found.text().unwrap().parse().unwrap()
    }

    #[test]
    fn sdf_has_what_the_urdf_has_and_says_what_it_cannot() {
        let text = document(&patched());
        let parsed = Document::parse(&text).unwrap();
        let named = |tag: &str, name: &str| {
            let all = parsed.descendants();
            let mut own = all.filter(|n| n.has_tag_name(tag) && n.attribute("name") == Some(name));
            own.next().unwrap()
        };
        let link = named("link", "l1");
        for (name, value) in [
            ("mass", 2.0),
            ("ixx", 0.02),
            ("ixy", 0.001),
            ("ixz", 0.002),
            ("iyy", 0.03),
            ("iyz", 0.003),
            ("izz", 0.04),
        ] {
            assert!((number(link, name) - value).abs() < 1e-12, "{name}");
        }
        let joint = named("joint", "j1");
        assert_eq!(
            [number(joint, "damping"), number(joint, "friction")],
            [1.8, 0.7]
        );
        assert!(text.contains("SDF has no rotor inertia, which is 0.25"));
    }

    /// A degree is π/180 rad, so that 1.8 N·m·s/rad are 0.0314… N·m·s for each degree; what slides keeps its unit.
    #[test]
    fn usd_counts_angles_in_degrees() {
        let text = usd::layer(&patched());
        for line in [
            "over \"my_arm\"",
            "over \"j1\" (",
            "newton:armature = 0.25",
            "newton:damping = 0.031415926535897",
            "newton:friction = 0.7",
            "newton:damping = 5",
            "newton:friction = 3",
        ] {
            assert!(text.contains(line), "{line}: {text}");
        }
    }
}
