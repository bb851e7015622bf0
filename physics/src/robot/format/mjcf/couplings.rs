//! Elements that tie joints to each other or drive them: actuators, tendons, equality constraints.

use super::attributes::{ACTUATORS, Attributes};
use super::models::Instance;
use super::refusal::refused;
use super::scene::Scene;
use super::source::Element;
use crate::robot::RobotError;

/// A tendon or equality constraint.
struct Coupling {
    /// Name of the coupling in messages.
    label: String,
    /// Indices of the joints that the coupling acts on.
    joints: Vec<usize>,
    /// Indices of the bodies that the coupling ties to each other.
    bodies: Vec<usize>,
}

/// Elements that act on the joints of a scene from outside the chain.
pub(super) struct Couplings {
    /// Joints that an actuator drives directly.
    pub actuated: Vec<usize>,
    couplings: Vec<Coupling>,
}

impl Couplings {
    pub fn read(scene: &Scene<'_, '_, '_>) -> Result<Self, RobotError> {
        let mut found = Self {
            actuated: Vec::new(),
            couplings: Vec::new(),
        };
        for actuator in actuators(scene)? {
            found.actuated.extend(actuator.joint);
        }
        for (tendon, instance) in scene.sections("tendon") {
            found.couplings.push(of_tendon(scene, tendon, instance));
        }
        for (constraint, instance) in scene.sections("equality") {
            let classes = &scene.model(instance).classes;
            let a = classes.of_kind("equality", constraint, None)?;
            if a.flag("active")? != Some(false) {
                found
                    .couplings
                    .push(of_equality(scene, constraint, instance));
            }
        }
        Ok(found)
    }

    /// Whether a tendon or an equality constraint acts on a joint.
    pub fn coupled(&self, joint: usize) -> bool {
        self.couplings.iter().any(|c| c.joints.contains(&joint))
    }

    /// Refuses elements that act on a chosen joint, or that tie links which chosen joints move apart. `links`
    /// has for each body the number of chosen joints that carry it.
    pub fn check(
        &self,
        scene: &Scene<'_, '_, '_>,
        chosen: &[usize],
        links: &[usize],
    ) -> Result<(), RobotError> {
        for coupling in &self.couplings {
            let label = &coupling.label;
            if let Some(joint) = coupling.joints.iter().find(|j| chosen.contains(j)) {
                return Err(refused(format!(
                    "{label} acts on joint {:?}, which makes it no free joint of a serial chain; choose other joints by \
                     --joints, or take it out",
                    scene.joints[*joint].name
                )));
            }
            let mut ends = coupling.bodies.iter();
            let Some(first) = ends.next() else { continue };
            if let Some(other) = ends.find(|b| links[**b] != links[*first]) {
                return Err(refused(format!(
                    "{label} ties body {:?} to body {:?}, between which chosen joints move, and closes a loop; choose \
                     other joints by --joints, or take it out",
                    scene.bodies[*first].name, scene.bodies[*other].name
                )));
            }
        }
        Ok(())
    }
}

/// An actuator with the model in which it stands.
pub(super) struct Actuator<'c, 'd, 't> {
    pub attributes: Attributes<'c, 'd, 't>,
    /// Index of the joint that the actuator drives.
    pub joint: Option<usize>,
}

/// Actuators with their defaults.
pub(super) fn actuators<'c, 'd, 't>(
    scene: &Scene<'c, 'd, 't>,
) -> Result<Vec<Actuator<'c, 'd, 't>>, RobotError> {
    let mut found = Vec::new();
    for (element, instance) in scene.sections("actuator") {
        if ACTUATORS.contains(&element.tag()) {
            let name = element.get("joint").or(element.get("jointinparent"));
            found.push(Actuator {
                attributes: scene.model(instance).of(element, None)?,
                joint: name.and_then(|name| scene.joint_in(instance, name)),
            });
        }
    }
    Ok(found)
}

/// Damping and armature that actuators add to a joint: their own, and the back-EMF of a DC motor, times the square of the gear.
pub(super) fn reflected(scene: &Scene<'_, '_, '_>, joint: usize) -> Result<[f64; 2], RobotError> {
    let mut sum = [0.0; 2];
    for actuator in actuators(scene)? {
        if actuator.joint == Some(joint) {
            let a = &actuator.attributes;
            let first =
                |name: &str| Ok::<_, RobotError>(a.list(name)?.and_then(|l| l.first().copied()));
            let gear = first("gear")?.unwrap_or(1.0);
            for (sum, name) in sum.iter_mut().zip(["damping", "armature"]) {
                *sum += gear * gear * first(name)?.unwrap_or(0.0);
            }
            sum[0] += gear * gear * back_emf(a)?;
        }
    }
    Ok(sum)
}

/// Damping of a `<dcmotor>` at its shaft while its voltage is zero, K·K/R (N·m·s/rad): `motorconst` holds the constants of
/// torque and back-EMF (one number for both) and `resistance` R, or `nominal` voltage, stall torque and no-load speed.
fn back_emf(a: &Attributes<'_, '_, '_>) -> Result<f64, RobotError> {
    if a.element.tag() != "dcmotor" {
        return Ok(0.0);
    }
    let list = |name: &str| Ok::<_, RobotError>(a.list(name)?.unwrap_or_default());
    let (constants, nominal) = (list("motorconst")?, list("nominal")?);
    let resistance = list("resistance")?.first().copied().filter(|r| *r > 0.0);
    Ok(match (constants[..].first(), resistance, &nominal[..]) {
        (Some(torque), Some(resistance), _) => {
            torque * constants.get(1).unwrap_or(torque) / resistance
        }
        (_, _, [_, stall, speed, ..]) if *speed > 0.0 => stall / speed,
        _ => 0.0,
    })
}

/// Actuators of chosen joints whose class makes them another kind before MuJoCo 3.16 than since, as a message has it.
pub(super) fn by_version(
    scene: &Scene<'_, '_, '_>,
    chosen: &[usize],
) -> Result<Vec<String>, RobotError> {
    let mut notes = Vec::new();
    for actuator in actuators(scene)? {
        let a = &actuator.attributes;
        let servo = |tag: &&str| ["position", "velocity", "intvelocity", "pid"].contains(tag);
        let Some(joint) = actuator.joint.filter(|j| chosen.contains(j)) else {
            continue;
        };
        if let (Some(tag), "motor") = (a.default_tag().filter(servo), a.element.tag()) {
            notes.push(format!(
                "the actuator of joint {} is a <motor> whose class has the defaults of a <{tag}>: a motor since MuJoCo 3.16, \
                 a servo before",
                scene.joints[joint].name
            ));
        }
    }
    Ok(notes)
}

fn label(what: &str, element: Element<'_, '_>) -> String {
    match element.get("name") {
        Some(name) => format!("the {what} {name:?}"),
        None => format!("a <{}> {what}", element.tag()),
    }
}

fn of_tendon(scene: &Scene<'_, '_, '_>, tendon: Element<'_, '_>, instance: &Instance) -> Coupling {
    let parts = tendon.children();
    let joints = parts.iter().filter_map(|p| p.get("joint"));
    let sites = parts.iter().filter_map(|p| p.get("site"));
    Coupling {
        label: label("tendon", tendon),
        joints: joints
            .filter_map(|name| scene.joint_in(instance, name))
            .collect(),
        bodies: sites
            .filter_map(|name| scene.site_in(instance, name))
            .collect(),
    }
}

fn of_equality(
    scene: &Scene<'_, '_, '_>,
    constraint: Element<'_, '_>,
    instance: &Instance,
) -> Coupling {
    let named = |names: [&str; 2]| names.map(|name| constraint.get(name));
    let joints = named(["joint1", "joint2"]).into_iter().flatten();
    let joints = joints
        .filter_map(|name| scene.joint_in(instance, name))
        .collect();
    let body = |name: &str| scene.body_in(instance, name);
    let first = constraint.get("body1").and_then(body);
    // A missing second body is the world.
    let second = first.map(|_| constraint.get("body2").and_then(body).unwrap_or(0));
    let sites = named(["site1", "site2"]).into_iter().flatten();
    let sites = sites.filter_map(|name| scene.site_in(instance, name));
    Coupling {
        label: label("equality constraint", constraint),
        joints,
        bodies: first.into_iter().chain(second).chain(sites).collect(),
    }
}
