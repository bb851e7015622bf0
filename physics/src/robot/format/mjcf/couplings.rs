//! What ties joints to each other or drives them: actuators, tendons, equality constraints.

use super::attributes::{ACTUATORS, Attributes};
use super::refusal::refused;
use super::scene::Scene;
use super::source::Element;
use crate::robot::RobotError;

/// A tendon or equality constraint.
struct Coupling {
    /// As a message has it.
    label: String,
    /// Joints that it acts on.
    joints: Vec<usize>,
    /// Bodies that it ties to each other.
    bodies: Vec<usize>,
}

/// What acts on the joints of a scene from outside the chain.
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
            found.actuated.extend(driven(scene, &actuator));
        }
        for section in scene.root.tagged("tendon") {
            for tendon in section.children() {
                found.couplings.push(of_tendon(scene, tendon));
            }
        }
        for section in scene.root.tagged("equality") {
            for constraint in section.children() {
                let a = scene.classes.of_kind("equality", constraint, None)?;
                if a.flag("active")? != Some(false) {
                    found.couplings.push(of_equality(scene, constraint));
                }
            }
        }
        Ok(found)
    }

    /// Whether a tendon or an equality constraint acts on a joint.
    pub fn coupled(&self, joint: usize) -> bool {
        self.couplings.iter().any(|c| c.joints.contains(&joint))
    }

    /// Refuses what acts on a chosen joint, or ties links that chosen joints move apart. `links` has for each body the
    /// number of chosen joints that carry it.
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

/// Actuators with their defaults.
pub(super) fn actuators<'c, 'd, 't>(
    scene: &Scene<'c, 'd, 't>,
) -> Result<Vec<Attributes<'c, 'd, 't>>, RobotError> {
    let mut found = Vec::new();
    for section in scene.root.tagged("actuator") {
        for actuator in section.children() {
            if ACTUATORS.contains(&actuator.tag()) {
                found.push(scene.classes.of(actuator, None)?);
            }
        }
    }
    Ok(found)
}

/// The joint that an actuator drives.
pub(super) fn driven(
    scene: &Scene<'_, '_, '_>,
    actuator: &Attributes<'_, '_, '_>,
) -> Option<usize> {
    let element = &actuator.element;
    let name = element.get("joint").or(element.get("jointinparent"))?;
    scene.joint_named(name)
}

/// Damping and armature that actuators add to a joint: their own, times the square of the gear.
pub(super) fn reflected(scene: &Scene<'_, '_, '_>, joint: usize) -> Result<[f64; 2], RobotError> {
    let mut sum = [0.0; 2];
    for actuator in actuators(scene)? {
        if driven(scene, &actuator) == Some(joint) {
            let first = |name: &str| {
                Ok::<_, RobotError>(actuator.list(name)?.and_then(|l| l.first().copied()))
            };
            let gear = first("gear")?.unwrap_or(1.0);
            for (sum, name) in sum.iter_mut().zip(["damping", "armature"]) {
                *sum += gear * gear * first(name)?.unwrap_or(0.0);
            }
        }
    }
    Ok(sum)
}

fn label(what: &str, element: Element<'_, '_>) -> String {
    match element.get("name") {
        Some(name) => format!("the {what} {name:?}"),
        None => format!("a <{}> {what}", element.tag()),
    }
}

fn of_tendon(scene: &Scene<'_, '_, '_>, tendon: Element<'_, '_>) -> Coupling {
    let parts = tendon.children();
    let joints = parts.iter().filter_map(|p| p.get("joint"));
    let sites = parts.iter().filter_map(|p| p.get("site"));
    Coupling {
        label: label("tendon", tendon),
        joints: joints.filter_map(|name| scene.joint_named(name)).collect(),
        bodies: sites
            .filter_map(|name| scene.sites.get(name).copied())
            .collect(),
    }
}

fn of_equality(scene: &Scene<'_, '_, '_>, constraint: Element<'_, '_>) -> Coupling {
    let named = |names: [&str; 2]| names.map(|name| constraint.get(name));
    let joints = named(["joint1", "joint2"]).into_iter().flatten();
    let joints = joints.filter_map(|name| scene.joint_named(name)).collect();
    let body = |name: &str| scene.bodies.iter().position(|b| b.name == name);
    let first = constraint.get("body1").and_then(body);
    // A missing second body is the world.
    let second = first.map(|_| constraint.get("body2").and_then(body).unwrap_or(0));
    let sites = named(["site1", "site2"]).into_iter().flatten();
    let sites = sites.filter_map(|name| scene.sites.get(name).copied());
    Coupling {
        label: label("equality constraint", constraint),
        joints,
        bodies: first.into_iter().chain(second).chain(sites).collect(),
    }
}
