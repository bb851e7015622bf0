//! Construction of the robot of the chosen joints from the links and joints of a URDF.

use super::elements::{JointElement, LinkElement, Motion, Pose, tagged};
use super::tree::{one_root, outwards, unexpanded};
use crate::robot::format::changed::Changed;
use crate::robot::format::choice::{Candidate, Tree, Wanted};
use crate::robot::format::xml::{line, wrong};
use crate::robot::judgement::Body;
use crate::robot::{Inertia, Joint, JointKind, Link, Robot, RobotError};
use nalgebra::{Matrix3, Rotation3, Unit, Vector3};
use roxmltree::{Document, Node};
use std::collections::HashMap;

/// The links and joints of a URDF as a tree.
pub(super) struct Model<'a> {
    name: &'a str,
    links: HashMap<&'a str, LinkElement<'a>>,
    /// Joints of the tree, every one after those that carry it.
    joints: Vec<JointElement<'a>>,
    /// Index of the joint that carries the parent link, for each joint.
    above: Vec<Option<usize>>,
    root: &'a str,
    wanted: Wanted,
    /// The chosen joints, base first.
    pub chosen: Vec<usize>,
}

/// Pose of a link in the chain, with all joints but the chosen ones at rest.
#[derive(Clone, Copy)]
pub(super) struct Placed<'a> {
    pub name: &'a str,
    /// Number of chosen joints that carry the link.
    pub carriers: usize,
    /// Pose of the link in the frame of the last chosen joint that carries it; in the base frame where none does.
    pub pose: Pose,
}

impl<'a> Model<'a> {
    /// Reads the tree and chooses the joints.
    pub fn read(document: &'a Document<'_>, wanted: &Wanted) -> Result<Self, RobotError> {
        let mut model = Self::tree(document)?;
        let chosen = model.candidates().choose(wanted)?;
        model.wanted = wanted.clone();
        if chosen.is_empty() {
            return Err(RobotError::NoJoints {
                name: model.name.to_owned(),
            });
        }
        model.chosen = chosen;
        Ok(model)
    }

    /// Reads the tree of links and joints.
    pub fn tree(document: &'a Document<'_>) -> Result<Self, RobotError> {
        let root = document.root_element();
        unexpanded(root)?;
        if root.tag_name().name() != "robot" {
            return Err(wrong(
                root,
                "is the outermost element".to_owned(),
                "a URDF's is <robot>, an MJCF's <mujoco>",
            ));
        }
        let mut links = HashMap::new();
        let mut seen: HashMap<(&str, &str), u32> = HashMap::new();
        let mut unique = |what: &'static str, name: &'a str, node: Node<'_, '_>| match seen
            .insert((what, name), line(node))
        {
            None => Ok(()),
            Some(first) => Err(RobotError::Duplicate {
                what,
                name: name.to_owned(),
                lines: [first, line(node)],
            }),
        };
        for node in tagged(root, "link") {
            let link = LinkElement::read(node)?;
            unique("link", link.name, node)?;
            links.insert(link.name, link);
        }
        let mut joints = Vec::new();
        for node in tagged(root, "joint") {
            let joint = JointElement::read(node)?;
            unique("joint", joint.name, node)?;
            for link in [joint.parent, joint.child] {
                if !links.contains_key(link) {
                    return Err(RobotError::UnknownLink {
                        line: line(node),
                        joint: joint.name.to_owned(),
                        link: link.to_owned(),
                    });
                }
            }
            joints.push(joint);
        }
        let base = one_root(root, &joints)?;
        let (joints, above) = outwards(base, joints)?;
        if joints.len() + 1 != links.len() {
            // Every link has a parent but some are not below the root: a cycle beside the chain.
            return Err(RobotError::Roots {
                count: 1,
                names: format!("{base}, with a closed loop apart from it"),
            });
        }
        Ok(Self {
            name: root.attribute("name").unwrap_or("robot"),
            links,
            joints,
            above,
            root: base,
            wanted: Wanted::default(),
            chosen: Vec::new(),
        })
    }

    /// Joints with the properties that the choice depends on; fixed ones are never chosen.
    pub fn candidates(&self) -> Tree<'a> {
        let leads = |name: &str| {
            let mut followers = self.joints.iter().filter_map(|o| o.mimic.as_ref());
            followers.any(|m| m.of == name)
        };
        let joints = self.joints.iter().zip(&self.above);
        let joints = joints.map(|(joint, &above)| Candidate {
            name: joint.name,
            above,
            scalar: matches!(joint.motion, Motion::Axis(_)),
            driven: joint.mimic.is_none(),
            coupled: leads(joint.name),
        });
        let frames = self.joints.iter().enumerate();
        let frames = frames.map(|(j, joint)| (joint.child, Some(j)));
        Tree {
            joints: joints.collect(),
            frames: std::iter::once((self.root, None)).chain(frames).collect(),
        }
    }

    /// Every link with its place, the base first.
    pub fn placed(&self) -> Vec<Placed<'a>> {
        let mut placed = vec![Placed {
            name: self.root,
            carriers: 0,
            pose: (Matrix3::identity(), Vector3::zeros()),
        }];
        for (j, joint) in self.joints.iter().enumerate() {
            // Joint j brings the link at place j + 1.
            let parent = placed[self.above[j].map_or(0, |k| k + 1)];
            placed.push(match self.chosen.iter().position(|&c| c == j) {
                Some(k) => Placed {
                    name: joint.child,
                    carriers: k + 1,
                    pose: (Matrix3::identity(), Vector3::zeros()),
                },
                None => Placed {
                    name: joint.child,
                    carriers: parent.carriers,
                    pose: compose(&parent.pose, &self.at_rest(j)),
                },
            });
        }
        placed
    }

    /// Inertia of a link in its own frame.
    pub fn inertia(&self, link: &str) -> Option<Inertia> {
        self.links.get(link).and_then(|l| l.inertia)
    }

    /// Pose of a joint that stands still: at the position asked for, at that which follows from the joint it mimics, or at zero.
    fn at_rest(&self, joint: usize) -> Pose {
        let own = &self.joints[joint];
        let Motion::Axis(kind) = own.motion else {
            return own.origin;
        };
        let position = self.position(own, self.joints.len());
        let mut pose = own.origin;
        if kind.is_rotation() {
            let axis = Unit::new_unchecked(own.axis);
            pose.0 *= Rotation3::from_axis_angle(&axis, position).into_inner();
        } else {
            pose.1 += pose.0 * own.axis * position;
        }
        pose
    }

    /// `depth` bounds a circle of joints that follow each other.
    fn position(&self, joint: &JointElement<'_>, depth: usize) -> f64 {
        let held = self.wanted.held.iter().find(|(name, _)| name == joint.name);
        match (held, &joint.mimic) {
            (Some((_, position)), _) => *position,
            (None, Some(mimic)) if depth > 0 => {
                let leader = self.joints.iter().find(|j| j.name == mimic.of);
                let led = leader.map_or(0.0, |leader| self.position(leader, depth - 1));
                mimic.multiplier * led + mimic.offset
            }
            _ => 0.0,
        }
    }

    /// The robot of the chosen joints.
    pub fn robot(&self) -> Result<Robot, RobotError> {
        self.supported()?;
        let placed = self.placed();
        let mut inertias = vec![Inertia::default(); self.chosen.len()];
        let mut bodies = Vec::new();
        for link in placed.iter().filter(|l| l.carriers > 0) {
            let Some(own) = self.inertia(link.name) else {
                continue;
            };
            let whole = &mut inertias[link.carriers - 1];
            *whole = whole.plus(&own.transformed(&link.pose.0, &link.pose.1));
            bodies.push(Body {
                name: link.name.to_owned(),
                joint: self.joints[self.chosen[link.carriers - 1]].name.to_owned(),
                inertia: own,
            });
        }
        let mut joints = Vec::new();
        let mut findings = Vec::new();
        for (&j, inertia) in self.chosen.iter().zip(inertias) {
            let joint = &self.joints[j];
            let parent = &placed[self.above[j].map_or(0, |k| k + 1)];
            let (rotation, translation) = compose(&parent.pose, &joint.origin);
            let Motion::Axis(kind) = joint.motion else {
                continue;
            };
            joints.push(Joint {
                name: joint.name.to_owned(),
                kind,
                axis: joint.axis,
                rotation,
                translation,
                limits: joint.limits,
                damping: joint.damping,
                friction: joint.friction,
                rotor_inertia: 0.0,
                gear_ratio: None,
                torque_constant: None,
                link: Link {
                    name: joint.child.to_owned(),
                    inertia,
                },
            });
            findings.extend(joint.findings.iter().cloned());
        }
        let robot = Robot::described(self.name, joints, &bodies, findings)?;
        Ok(robot.with_notes(self.notes()))
    }

    /// New origin of a chosen joint's frame when its zero moves and, for the first joint, the base is tilted;
    /// none where it stays.
    ///
    /// The base frame stays the world's: a base that is tilted by R is represented by the first joint's origin turned by R.
    pub fn moved_origin(&self, chosen: usize, changed: &Changed<'_>) -> Option<Pose> {
        let zero = changed.zero(chosen);
        let turns = chosen == 0 && changed.tilt != Vector3::zeros();
        if zero == 0.0 && !turns {
            return None;
        }
        let joint = &self.joints[self.chosen[chosen]];
        let mut pose = joint.origin;
        if matches!(joint.motion, Motion::Axis(kind) if kind.is_rotation()) {
            let axis = Unit::new_unchecked(joint.axis);
            pose.0 *= Rotation3::from_axis_angle(&axis, zero).into_inner();
        } else {
            pose.1 += pose.0 * joint.axis * zero;
        }
        if turns {
            let above = self.above[self.chosen[chosen]];
            let before = self.placed()[above.map_or(0, |k| k + 1)].pose;
            let turned = before.0.transpose();
            let back = (turned, -(turned * before.1));
            let tilt = (Rotation3::new(changed.tilt).into_inner(), Vector3::zeros());
            pose = compose(&back, &compose(&tilt, &compose(&before, &pose)));
        }
        Some(pose)
    }

    /// Refuses joints that a serial chain of free joints does not hold.
    fn supported(&self) -> Result<(), RobotError> {
        let names = |j: usize| self.joints[j].name.to_owned();
        for &j in &self.chosen {
            if let Some(mimic) = &self.joints[j].mimic {
                return Err(RobotError::Follows {
                    joint: names(j),
                    of: mimic.of.to_owned(),
                });
            }
        }
        let placed = self.placed();
        let other =
            |j: &usize| self.joints[*j].motion == Motion::Other && placed[j + 1].carriers > 0;
        if let Some(j) = (0..self.joints.len()).find(other) {
            return Err(RobotError::UnsupportedJoint {
                joint: names(j),
                kind: self.joints[j].kind.to_owned(),
            });
        }
        // What follows a joint of the chain and carries more of it couples the two.
        for &j in &self.chosen {
            let mut at = self.above[j];
            while let Some(k) = at {
                let joint = &self.joints[k];
                let leads = |m: &&super::elements::Mimic<'_>| {
                    self.chosen.iter().any(|&c| self.joints[c].name == m.of)
                };
                if let Some(mimic) = joint.mimic.as_ref().filter(leads) {
                    return Err(RobotError::Follows {
                        joint: names(k),
                        of: mimic.of.to_owned(),
                    });
                }
                if joint.motion == Motion::Other {
                    return Err(RobotError::UnsupportedJoint {
                        joint: names(k),
                        kind: joint.kind.to_owned(),
                    });
                }
                at = self.above[k];
            }
        }
        Ok(())
    }

    /// Notes for the user on the joints that were not chosen.
    fn notes(&self) -> Vec<String> {
        let placed = self.placed();
        let last = self.chosen.last().copied();
        let mut on_the_way = Vec::new();
        let mut at = last.and_then(|j| self.above[j]);
        while let Some(j) = at {
            on_the_way.push(j);
            at = self.above[j];
        }
        let (mut fixed, mut apart) = (Vec::new(), Vec::new());
        for (j, joint) in self.joints.iter().enumerate() {
            if joint.motion == Motion::Fixed || self.chosen.contains(&j) {
                continue;
            }
            if placed[j + 1].carriers == 0 && !on_the_way.contains(&j) {
                apart.push(joint.name.to_owned());
                continue;
            }
            let position = match joint.motion {
                Motion::Axis(kind) => match self.position(joint, self.joints.len()) {
                    0.0 => String::new(),
                    v if kind == JointKind::Prismatic => format!(" (at {v} m)"),
                    v => format!(" (at {v} rad)"),
                },
                _ => String::new(),
            };
            let follows = joint
                .mimic
                .as_ref()
                .map_or(String::new(), |m| format!(" (which follows {})", m.of));
            fixed.push(format!("{}{follows}{position}", joint.name));
        }
        let mut notes = Vec::new();
        if !fixed.is_empty() {
            notes.push(format!(
                "fixed at their reference position: {} (--joints NAME=POSITION sets another)",
                fixed.join(", ")
            ));
        }
        if !apart.is_empty() {
            notes.push(format!("no part of the chosen chain: {}", apart.join(", ")));
        }
        if !notes.is_empty() {
            let chain: Vec<&str> = self.chosen.iter().map(|&j| self.joints[j].name).collect();
            notes[0] = format!("the robot is the chain {}; {}", chain.join(", "), notes[0]);
        }
        notes
    }
}

/// `a`, then `b` in its frame.
pub(super) fn compose(a: &Pose, b: &Pose) -> Pose {
    (a.0 * b.0, a.0 * b.1 + a.1)
}
