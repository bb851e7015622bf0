//! Checks that links and joints make one tree.

use super::elements::{JointElement, tagged};
use crate::robot::RobotError;
use crate::robot::format::xml::wrong;
use roxmltree::Node;
use std::collections::HashMap;

/// Refuses a file whose macros are not expanded.
pub(super) fn unexpanded(root: Node<'_, '_>) -> Result<(), RobotError> {
    let xacro = |n: &Node<'_, '_>| {
        let space = n.tag_name().namespace().unwrap_or_default();
        // Names of files may hold what a launch file fills in.
        let values = || {
            let mut own = n.attributes().filter(|a| a.name() != "filename");
            own.any(|a| a.value().contains("${") || a.value().contains("$("))
        };
        space.contains("xacro") || (n.is_element() && values())
    };
    // Plug-ins for simulators inside of <gazebo> have a language of their own.
    let own = root.descendants().filter(|n| {
        !n.ancestors()
            .any(|a| ["gazebo", "ros2_control", "transmission"].contains(&a.tag_name().name()))
    });
    match own.into_iter().find(xacro) {
        Some(_) => Err(RobotError::Xacro { file: None }),
        None => Ok(()),
    }
}

/// The only link that no joint carries.
pub(super) fn one_root<'a>(
    root: Node<'a, '_>,
    joints: &[JointElement<'a>],
) -> Result<&'a str, RobotError> {
    let mut parents: HashMap<&str, &str> = HashMap::new();
    for joint in joints {
        if let Some(other) = parents.insert(joint.child, joint.name) {
            return Err(RobotError::TwoParents {
                link: joint.child.to_owned(),
                first: other.to_owned(),
                second: joint.name.to_owned(),
            });
        }
    }
    let names = tagged(root, "link").filter_map(|l| l.attribute("name").map(str::trim));
    let roots: Vec<&str> = names.filter(|name| !parents.contains_key(name)).collect();
    match roots[..] {
        [one] => Ok(one),
        [] => Err(wrong(
            root,
            "has no link that others hang on".to_owned(),
            "add the base's <link>, and see that no joints form a circle (a closed loop)",
        )),
        _ => Err(RobotError::Roots {
            count: roots.len(),
            names: roots.join(", "),
        }),
    }
}

/// Joints in the order from the root outwards, and for each the index of the joint that carries its parent link.
pub(super) fn outwards<'a>(
    root: &'a str,
    joints: Vec<JointElement<'a>>,
) -> Result<(Vec<JointElement<'a>>, Vec<Option<usize>>), RobotError> {
    let mut below: HashMap<&str, Vec<JointElement<'a>>> = HashMap::new();
    for joint in joints.into_iter().rev() {
        below.entry(joint.parent).or_default().push(joint);
    }
    let (mut ordered, mut above) = (Vec::new(), Vec::new());
    let mut open: Vec<(Option<usize>, JointElement<'a>)> = Vec::new();
    let mut grow = |open: &mut Vec<_>, link: &str, by: Option<usize>| {
        let next = below.remove(link).into_iter().flatten();
        open.extend(next.map(|joint| (by, joint)));
    };
    grow(&mut open, root, None);
    while let Some((by, joint)) = open.pop() {
        let link = joint.child;
        ordered.push(joint);
        above.push(by);
        grow(&mut open, link, Some(ordered.len() - 1));
    }
    Ok((ordered, above))
}
