//! Reading a URDF.

use crate::robot::{Inertia, Joint, JointKind, Limits, Link, Robot, RobotError};
use nalgebra::{Matrix3, Rotation3, Vector3};
use std::collections::HashMap;
use urdf_rs::JointType;

/// Shortest axis that still has a direction.
const SHORTEST_AXIS: f64 = 1e-6;

/// Reads the robot of a URDF text.
pub(in crate::robot) fn read(text: &str) -> Result<Robot, RobotError> {
    let urdf = urdf_rs::read_from_string(text).map_err(|e| RobotError::Syntax {
        reason: e.to_string(),
    })?;
    Tree::new(&urdf)?.robot()
}

/// Links by name, and the joints below each link.
struct Tree<'a> {
    urdf: &'a urdf_rs::Robot,
    links: HashMap<&'a str, &'a urdf_rs::Link>,
    children: HashMap<&'a str, Vec<&'a urdf_rs::Joint>>,
    root: &'a str,
}

/// Links joined by fixed joints, seen from the first of them.
struct Body<'a> {
    inertia: Inertia,
    /// Moving joints that leave the body, with the pose of their parent link in its frame.
    leaving: Vec<(&'a urdf_rs::Joint, Matrix3<f64>, Vector3<f64>)>,
}

impl<'a> Tree<'a> {
    fn new(urdf: &'a urdf_rs::Robot) -> Result<Self, RobotError> {
        let mut links = HashMap::new();
        for link in &urdf.links {
            if links.insert(link.name.as_str(), link).is_some() {
                return Err(RobotError::Duplicate {
                    what: "link",
                    name: link.name.clone(),
                });
            }
        }
        let mut parents: HashMap<&str, &urdf_rs::Joint> = HashMap::new();
        let mut children: HashMap<&str, Vec<&urdf_rs::Joint>> = HashMap::new();
        let mut names = HashMap::new();
        for joint in &urdf.joints {
            if names.insert(joint.name.as_str(), ()).is_some() {
                return Err(RobotError::Duplicate {
                    what: "joint",
                    name: joint.name.clone(),
                });
            }
            for link in [&joint.parent.link, &joint.child.link] {
                if !links.contains_key(link.as_str()) {
                    return Err(RobotError::UnknownLink {
                        joint: joint.name.clone(),
                        link: link.clone(),
                    });
                }
            }
            if let Some(other) = parents.insert(&joint.child.link, joint) {
                return Err(RobotError::TwoParents {
                    link: joint.child.link.clone(),
                    first: other.name.clone(),
                    second: joint.name.clone(),
                });
            }
            children.entry(&joint.parent.link).or_default().push(joint);
        }
        let roots: Vec<&str> = urdf
            .links
            .iter()
            .map(|l| l.name.as_str())
            .filter(|name| !parents.contains_key(name))
            .collect();
        let [root] = roots[..] else {
            return Err(RobotError::Roots {
                count: roots.len(),
                names: roots.join(", "),
            });
        };
        Ok(Self {
            urdf,
            links,
            children,
            root,
        })
    }

    fn robot(&self) -> Result<Robot, RobotError> {
        let mut joints = Vec::new();
        let mut reached = 0;
        let mut body = self.body(self.root, &mut reached)?;
        let mut first = self.root;
        loop {
            let (joint, rotation, translation) = match body.leaving[..] {
                [] => break,
                [only] => only,
                [(a, ..), (b, ..), ..] => {
                    return Err(RobotError::Branch {
                        link: first.to_owned(),
                        first: a.name.clone(),
                        second: b.name.clone(),
                    });
                }
            };
            first = &joint.child.link;
            body = self.body(first, &mut reached)?;
            joints.push(moving_joint(joint, rotation, translation, body.inertia)?);
        }
        if reached != self.urdf.links.len() {
            // Every link has a parent but some are not below the root: a cycle beside the chain.
            return Err(RobotError::Roots {
                count: 1,
                names: format!("{}, with a closed loop apart from it", self.root),
            });
        }
        Robot::new(self.urdf.name.clone(), joints)
    }

    /// Collects `link` and all that is fixed to it, counting the links.
    fn body(&self, link: &'a str, reached: &mut usize) -> Result<Body<'a>, RobotError> {
        let mut body = Body {
            inertia: Inertia::default(),
            leaving: Vec::new(),
        };
        let mut open = vec![(link, Matrix3::identity(), Vector3::zeros())];
        while let Some((name, rotation, translation)) = open.pop() {
            *reached += 1;
            let own = inertia(self.links[name])?.transformed(&rotation, &translation);
            body.inertia = body.inertia.plus(&own);
            for &joint in self.children.get(name).into_iter().flatten() {
                if joint.joint_type == JointType::Fixed {
                    let (r, t) = pose(&joint.origin);
                    open.push((&joint.child.link, rotation * r, rotation * t + translation));
                } else {
                    body.leaving.push((joint, rotation, translation));
                }
            }
        }
        Ok(body)
    }
}

/// A moving joint whose parent link has the given pose in the parent joint's frame.
fn moving_joint(
    joint: &urdf_rs::Joint,
    rotation: Matrix3<f64>,
    translation: Vector3<f64>,
    inertia: Inertia,
) -> Result<Joint, RobotError> {
    let unsupported = |kind: &str| RobotError::UnsupportedJoint {
        joint: joint.name.clone(),
        kind: kind.to_owned(),
    };
    if joint.mimic.is_some() {
        return Err(unsupported("a mimic of another joint"));
    }
    let kind = match joint.joint_type {
        JointType::Revolute => JointKind::Revolute,
        JointType::Continuous => JointKind::Continuous,
        JointType::Prismatic => JointKind::Prismatic,
        ref other => return Err(unsupported(&format!("{other:?}").to_lowercase())),
    };
    let axis = Vector3::from(*joint.axis.xyz);
    let length = axis.norm();
    // A NaN axis fails this comparison too.
    if !(length > SHORTEST_AXIS && length.is_finite()) {
        return Err(RobotError::BadAxis {
            joint: joint.name.clone(),
            axis: axis.into(),
        });
    }
    let (r, t) = pose(&joint.origin);
    let dynamics = joint.dynamics.as_ref();
    Ok(Joint {
        name: joint.name.clone(),
        kind,
        axis: axis / length,
        rotation: rotation * r,
        translation: rotation * t + translation,
        limits: limits(kind, &joint.limit),
        damping: dynamics.map_or(0.0, |d| d.damping),
        friction: dynamics.map_or(0.0, |d| d.friction),
        rotor_inertia: 0.0,
        gear_ratio: None,
        torque_constant: None,
        link: Link {
            name: joint.child.link.clone(),
            inertia,
        },
    })
}

/// A limit of this size or beyond, rad, m, rad/s, m/s, N·m or N, is none: what is written where the format demands a
/// number.
pub(super) const UNLIMITED: f64 = 1e9;

/// A missing `<limit>` reads as zeros, and so does a missing attribute: neither limits anything.
fn limits(kind: JointKind, limit: &urdf_rs::JointLimit) -> Limits {
    let bounded = kind != JointKind::Continuous && limit.upper > limit.lower;
    let (lower, upper) = if bounded {
        (open(limit.lower), open(limit.upper))
    } else {
        (f64::NEG_INFINITY, f64::INFINITY)
    };
    let positive = |v: f64| if v > 0.0 { open(v) } else { f64::INFINITY };
    Limits {
        lower,
        upper,
        velocity: positive(limit.velocity),
        effort: positive(limit.effort),
    }
}

fn open(limit: f64) -> f64 {
    if limit.abs() >= UNLIMITED {
        f64::INFINITY.copysign(limit)
    } else {
        limit
    }
}

/// Inertia of one link in its own frame.
fn inertia(link: &urdf_rs::Link) -> Result<Inertia, RobotError> {
    let inertial = &link.inertial;
    let i = &inertial.inertia;
    let about_com = Matrix3::new(
        i.ixx, i.ixy, i.ixz, i.ixy, i.iyy, i.iyz, i.ixz, i.iyz, i.izz,
    );
    let mass = inertial.mass.value;
    if mass < 0.0 || !mass.is_finite() {
        return Err(RobotError::BadNumber {
            owner: link.name.clone(),
            what: "mass".to_owned(),
            value: mass,
            hint: "it must be finite and not negative".to_owned(),
        });
    }
    let (r, com) = pose(&inertial.origin);
    Ok(Inertia::from_com(mass, com, r * about_com * r.transpose()))
}

/// Orientation and origin of a URDF pose (fixed-axis roll, pitch, yaw).
fn pose(pose: &urdf_rs::Pose) -> (Matrix3<f64>, Vector3<f64>) {
    let [roll, pitch, yaw] = *pose.rpy;
    let rotation = Rotation3::from_euler_angles(roll, pitch, yaw).into_inner();
    (rotation, Vector3::from(*pose.xyz))
}
