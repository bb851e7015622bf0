//! Construction of the robot of the chosen joints from a scene.

use super::choice::{self, carries};
use super::couplings::{self, Couplings};
use super::pose::{Pose, compose};
use super::refusal::refused;
use super::scene::{Kind, Scene};
use crate::robot::format::choice::Wanted;
use crate::robot::judgement;
use crate::robot::{Inertia, Joint, JointKind, Limits, Link, Passive, Robot, RobotError, Spring};
use nalgebra::{Matrix3, Rotation3, Unit};

/// Largest stiffness (N·m/rad), and part of a weight, that is accepted.
const LARGEST: f64 = 1e9;

/// Difference below which two fractions of compensated weight count as equal.
const SAME: f64 = 1e-12;

/// The chosen joints and the bodies that each of them carries.
pub(super) struct Chain {
    /// Chosen joints, base first.
    pub joints: Vec<usize>,
    /// Number of chosen joints that carry each body.
    pub links: Vec<usize>,
    /// Pose of each body in the frame of its link (of the base: in the world), all other joints at their reference.
    pub poses: Vec<Pose>,
    /// Inertia of each body in the frame of its link; nothing for the base's.
    pub inertias: Vec<Inertia>,
}

impl Chain {
    pub fn of(scene: &Scene<'_, '_, '_>, wanted: &Wanted) -> Result<Self, RobotError> {
        let couplings = Couplings::read(scene)?;
        let joints = choice::joints(scene, &couplings, wanted)?;
        let count = scene.bodies.len();
        let mut chain = Self {
            joints,
            links: vec![0; count],
            poses: vec![scene.bodies[0].pose; count],
            inertias: vec![Inertia::default(); count],
        };
        for body in 1..count {
            let parent = scene.bodies[body].parent;
            match chain.joint_of(scene, body) {
                Some(k) => {
                    chain.links[body] = k + 1;
                    let anchor = scene.joints[chain.joints[k]].anchor;
                    chain.poses[body] = (Matrix3::identity(), -anchor);
                }
                None => {
                    chain.links[body] = chain.links[parent];
                    let placed = compose(&chain.poses[parent], &scene.bodies[body].pose);
                    chain.poses[body] = held(scene, wanted, body, placed)?;
                }
            }
            if chain.links[body] > 0 {
                let (rotation, origin) = &chain.poses[body];
                chain.inertias[body] = scene.inertia(body)?.transformed(rotation, origin);
            }
        }
        couplings.check(scene, &chain.joints, &chain.links)?;
        Ok(chain)
    }

    /// Position in the chain of the chosen joint that moves a body.
    fn joint_of(&self, scene: &Scene<'_, '_, '_>, body: usize) -> Option<usize> {
        let mut chosen = self.joints.iter();
        chosen.position(|&j| scene.joints[j].body == body)
    }

    /// The bodies of a link, the one that its joint moves first.
    pub fn bodies(&self, link: usize) -> impl Iterator<Item = usize> + '_ {
        let links = self.links.iter().enumerate();
        links.filter(move |(_, l)| **l == link + 1).map(|(b, _)| b)
    }

    /// Robot with the joints of the chain.
    pub fn robot(&self, scene: &Scene<'_, '_, '_>) -> Result<Robot, RobotError> {
        self.supported(scene)?;
        let mut joints = Vec::new();
        for link in 0..self.joints.len() {
            joints.push(self.joint(scene, link)?);
        }
        let name = scene.name.clone();
        let robot = if joints.iter().all(|j| j.link.inertia.mass == 0.0) {
            // MuJoCo moves no body without mass, so that such a model is none.
            Robot::new(name, joints)
        } else {
            Robot::described(name, joints, &self.written(scene), Vec::new())
        };
        let mut robot = robot?.with_gravity(scene.settings.gravity);
        let mut notes = self.fixed(scene);
        notes.extend(couplings::by_version(scene, &self.joints)?);
        for (k, &j) in self.joints.iter().enumerate() {
            if let Some(spring) = spring(scene, k, j, &mut notes)? {
                robot = robot.with_passive(Passive::Spring(spring))?;
            }
        }
        let held = self.compensation(scene, &mut notes)?;
        if scene.settings.medium.iter().any(|&v| v != 0.0) {
            notes
                .push("the forces of a medium (option density, viscosity) are left out".to_owned());
        }
        Ok(robot.with_gravity_compensation(&held)?.with_notes(notes))
    }

    /// The bodies that chosen joints carry.
    fn written(&self, scene: &Scene<'_, '_, '_>) -> Vec<judgement::Body> {
        let links = self.links.iter().enumerate().filter(|(_, link)| **link > 0);
        let body = |(b, link): (usize, &usize)| judgement::Body {
            name: scene.bodies[b].name.clone(),
            joint: scene.joints[self.joints[link - 1]].name.clone(),
            inertia: self.inertias[b],
        };
        links.map(body).collect()
    }

    /// Refuses elements inside of moved bodies that bring more than the text shows.
    fn supported(&self, scene: &Scene<'_, '_, '_>) -> Result<(), RobotError> {
        for (body, &link) in scene.bodies.iter().zip(&self.links) {
            if let Some(tag) = body.unsupported.first().filter(|_| link > 0) {
                return Err(refused(format!(
                    "body {:?} holds <{tag}>, which is not supported on what the chosen joints carry; save the compiled model \
                     in MuJoCo (mj_saveLastXML) and give that",
                    body.name
                )));
            }
        }
        Ok(())
    }

    fn joint(&self, scene: &Scene<'_, '_, '_>, link: usize) -> Result<Joint, RobotError> {
        let own = &scene.joints[self.joints[link]];
        let body = &scene.bodies[own.body];
        let (rotation, origin) = compose(&self.poses[body.parent], &body.pose);
        let a = &own.attributes;
        let slides = own.kind == Kind::Slide;
        let unit = if slides { 1.0 } else { own.angle };
        let reference = a.number("ref")?.unwrap_or(0.0) * unit;
        let mut placement = (rotation, rotation * own.anchor + origin);
        if slides {
            placement.1 -= rotation * own.axis * reference;
        } else {
            let axis = Unit::new_unchecked(own.axis);
            placement.0 *= Rotation3::from_axis_angle(&axis, -reference).into_inner();
        }
        if a.numbers::<2>("springdamper")?
            .is_some_and(|v| v != [0.0, 0.0])
        {
            return Err(refused(format!(
                "joint {:?} has springdamper, which MuJoCo turns into stiffness and damping when it compiles; write those \
                 (mj_saveLastXML does)",
                own.name
            )));
        }
        let limits = limits(scene, self.joints[link], unit)?;
        let reflected = couplings::reflected(scene, self.joints[link])?;
        let inertias = self.bodies(link).map(|b| self.inertias[b]);
        let coefficient = |name: &str, acts: bool| -> Result<f64, RobotError> {
            let list = a.list(name)?.unwrap_or_default();
            Ok(list.first().copied().filter(|_| acts).unwrap_or(0.0))
        };
        Ok(Joint {
            name: own.name.clone(),
            kind: match (slides, limits.lower.is_finite() || limits.upper.is_finite()) {
                (true, _) => JointKind::Prismatic,
                (false, true) => JointKind::Revolute,
                (false, false) => JointKind::Continuous,
            },
            axis: own.axis,
            rotation: placement.0,
            translation: placement.1,
            limits,
            damping: coefficient("damping", scene.settings.dampers)? + reflected[0],
            friction: coefficient("frictionloss", scene.settings.friction)?,
            rotor_inertia: coefficient("armature", true)? + reflected[1],
            gear_ratio: None,
            torque_constant: None,
            link: Link {
                name: body.name.clone(),
                inertia: inertias.fold(Inertia::default(), |sum, i| sum.plus(&i)),
            },
        })
    }

    /// Part of each link's weight that MuJoCo holds.
    fn compensation(
        &self,
        scene: &Scene<'_, '_, '_>,
        notes: &mut Vec<String>,
    ) -> Result<Vec<f64>, RobotError> {
        let by_drives = |j: &usize| scene.joints[*j].attributes.flag("actuatorgravcomp");
        let by_drives: Vec<bool> = self
            .joints
            .iter()
            .map(|j| Ok(by_drives(j)?.unwrap_or(false)))
            .collect::<Result<_, RobotError>>()?;
        let mut parts = Vec::new();
        for link in 0..self.joints.len() {
            let bodies = self
                .bodies(link)
                .map(|b| (&scene.bodies[b], &self.inertias[b]));
            let heavy: Vec<_> = bodies.filter(|(_, i)| i.mass > 0.0).collect();
            let mass: f64 = heavy.iter().map(|(_, i)| i.mass).sum();
            let held: f64 = heavy.iter().map(|(b, i)| b.gravcomp * i.mass).sum();
            let part = if mass > 0.0 { held / mass } else { 0.0 };
            if part.is_nan() || part.abs() > LARGEST {
                return Err(refused(format!(
                    "gravcomp makes {part} of the weight of what joint {:?} moves; 1 holds all of it",
                    scene.joints[self.joints[link]].name
                )));
            }
            if let Some((other, _)) = heavy.iter().find(|(b, _)| (b.gravcomp - part).abs() > SAME) {
                notes.push(format!(
                    "bodies fixed to each other have different gravcomp (body {} has {}): the mean by mass, {part}, stands \
                     for all of that link, and its torque departs from MuJoCo's",
                    other.name, other.gravcomp
                ));
            }
            parts.push(part);
        }
        // What the drives themselves hold is part of their torque.
        if by_drives.iter().all(|d| *d) {
            return Ok(Vec::new());
        }
        if by_drives.contains(&true) && parts.iter().any(|p| *p != 0.0) {
            return Err(refused(
                "some of the chosen joints have actuatorgravcomp and others have not, which is not supported; give it to all \
                 of them or to none",
            ));
        }
        Ok(parts)
    }

    /// Notes for the user on the joints that were not chosen.
    fn fixed(&self, scene: &Scene<'_, '_, '_>) -> Vec<String> {
        let (mut fixed, mut apart) = (Vec::new(), Vec::new());
        let last = scene.joints[*self.joints.last().expect("at least one")].body;
        for (j, joint) in scene.joints.iter().enumerate() {
            if self.joints.contains(&j) {
                continue;
            }
            let counts = self.links[joint.body] > 0 || carries(scene, joint.body, last);
            let list = if counts { &mut fixed } else { &mut apart };
            list.push(joint.name.as_str());
        }
        let mut notes = Vec::new();
        if !fixed.is_empty() {
            notes.push(format!(
                "fixed at their reference position: {}",
                fixed.join(", ")
            ));
        }
        if !apart.is_empty() {
            notes.push(format!("no part of the chosen chain: {}", apart.join(", ")));
        }
        if let Some(tag) = scene.bodies.iter().find_map(|b| b.unsupported.first()) {
            notes.push(format!("elements beside the chain are not read: <{tag}>"));
        }
        notes
    }
}

/// Pose of a body whose joints were not chosen, moved to the positions at which they are to stand.
fn held(
    scene: &Scene<'_, '_, '_>,
    wanted: &Wanted,
    body: usize,
    placed: Pose,
) -> Result<Pose, RobotError> {
    let mut pose = placed;
    for joint in scene.joints.iter().filter(|j| j.body == body) {
        let Some((_, position)) = wanted.held.iter().find(|(name, _)| *name == joint.name) else {
            continue;
        };
        let slides = joint.kind == Kind::Slide;
        let unit = if slides { 1.0 } else { joint.angle };
        let moved = position - joint.attributes.number("ref")?.unwrap_or(0.0) * unit;
        if slides {
            pose.1 += pose.0 * joint.axis * moved;
        } else {
            let axis = Unit::new_unchecked(joint.axis);
            let turn = Rotation3::from_axis_angle(&axis, moved).into_inner();
            pose.1 += pose.0 * (joint.anchor - turn * joint.anchor);
            pose.0 *= turn;
        }
    }
    Ok(pose)
}

/// The spring of a chosen joint.
fn spring(
    scene: &Scene<'_, '_, '_>,
    k: usize,
    joint: usize,
    notes: &mut Vec<String>,
) -> Result<Option<Spring>, RobotError> {
    let own = &scene.joints[joint];
    let a = &own.attributes;
    for name in ["stiffness", "damping"] {
        let list = a.list(name)?.unwrap_or_default();
        if list.iter().skip(1).any(|&v| v != 0.0) {
            notes.push(format!(
                "the higher coefficients of {name} of joint {} are left out",
                own.name
            ));
        }
    }
    let unit = match own.kind {
        Kind::Slide => 1.0,
        _ => own.angle,
    };
    let stiffness = a.list("stiffness")?.unwrap_or_default();
    let stiffness = stiffness.first().copied().unwrap_or(0.0);
    if stiffness == 0.0 || !scene.settings.springs {
        return Ok(None);
    }
    let rest = a.number("springref")?.unwrap_or(0.0) * unit;
    if stiffness.abs() > LARGEST || rest.abs() > LARGEST {
        return Err(refused(format!(
            "joint {:?} has the stiffness {stiffness} and springref {rest}; give those of a robot",
            own.name
        )));
    }
    Ok(Some(Spring {
        joint: k,
        stiffness,
        rest,
    }))
}

/// Range of a joint, and the smallest of the limits on its torque.
fn limits(scene: &Scene<'_, '_, '_>, joint: usize, unit: f64) -> Result<Limits, RobotError> {
    let own = &scene.joints[joint];
    let auto = own.autolimits;
    let mut limits = Limits::NONE;
    if let Some([lower, upper]) = own.attributes.range("limited", "range", auto)? {
        (limits.lower, limits.upper) = (lower * unit, upper * unit);
    }
    let largest = |[low, high]: [f64; 2]| low.abs().max(high.abs());
    if let Some(range) = own
        .attributes
        .range("actuatorfrclimited", "actuatorfrcrange", auto)?
    {
        limits.effort = largest(range);
    }
    for actuator in couplings::actuators(scene)? {
        if actuator.joint != Some(joint) {
            continue;
        }
        let actuator = &actuator.attributes;
        let gear = actuator.list("gear")?.unwrap_or_default();
        let gear = gear.first().copied().unwrap_or(1.0).abs();
        if let Some(range) = actuator.range("forcelimited", "forcerange", auto)? {
            limits.effort = limits.effort.min(largest(range) * gear);
        }
    }
    if limits.effort == 0.0 {
        limits.effort = f64::INFINITY;
    }
    Ok(limits)
}
