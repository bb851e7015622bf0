//! The joints of a scene as the choice among them takes them.

use super::couplings::Couplings;
use super::refusal::refused;
use super::scene::{Kind, Scene};
use crate::robot::RobotError;
use crate::robot::format::choice::{Candidate, Tree, Wanted};

/// The joints and bodies of a scene.
pub(super) fn tree<'a>(scene: &'a Scene<'_, '_, '_>, couplings: &Couplings) -> Tree<'a> {
    // The last joint of each body, or of the nearest that carries it and has one.
    let mut last: Vec<Option<usize>> = vec![None; scene.bodies.len()];
    let mut above = vec![None; scene.joints.len()];
    for (b, body) in scene.bodies.iter().enumerate().skip(1) {
        last[b] = last[body.parent];
        for (j, _) in scene.joints.iter().enumerate().filter(|(_, j)| j.body == b) {
            above[j] = last[b];
            last[b] = Some(j);
        }
    }
    let joints = scene.joints.iter().enumerate().map(|(j, joint)| Candidate {
        name: &joint.name,
        above: above[j],
        scalar: joint.kind != Kind::Other,
        driven: couplings.actuated.contains(&j),
        coupled: couplings.coupled(j),
    });
    let bodies = scene.bodies.iter().zip(&last);
    let bodies = bodies.map(|(body, &joint)| (body.name.as_str(), joint));
    let sites = scene
        .sites
        .iter()
        .map(|(name, &b)| (name.as_str(), last[b]));
    Tree {
        joints: joints.collect(),
        frames: bodies.chain(sites).collect(),
    }
}

/// The chosen joints, base first, each on a body of its own.
pub(super) fn joints(
    scene: &Scene<'_, '_, '_>,
    couplings: &Couplings,
    wanted: &Wanted,
) -> Result<Vec<usize>, RobotError> {
    let chosen = tree(scene, couplings).choose(wanted)?;
    if chosen.is_empty() {
        return Err(RobotError::NoJoints {
            name: scene.name.clone(),
        });
    }
    for pair in chosen.windows(2) {
        let (a, b) = (&scene.joints[pair[0]], &scene.joints[pair[1]]);
        if a.body == b.body {
            return Err(refused(format!(
                "joints {:?} and {:?} move the same body {:?}, and a link without mass between them is not supported; \
                 give each a body of its own with an <inertial>, or choose one of them by --joints",
                a.name, b.name, scene.bodies[a.body].name
            )));
        }
    }
    Ok(chosen)
}

/// Whether a body is the other or carries it.
pub(super) fn carries(scene: &Scene<'_, '_, '_>, body: usize, mut other: usize) -> bool {
    // Parents come first.
    while other > body {
        other = scene.bodies[other].parent;
    }
    other == body
}
