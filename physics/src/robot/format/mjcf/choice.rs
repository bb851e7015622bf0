//! Which joints make the robot: those that are asked for, or the one actuated chain.

use super::couplings::Couplings;
use super::refusal::refused;
use super::scene::{Kind, Scene};
use crate::robot::RobotError;
use std::collections::HashSet;

/// The chosen joints, base first, on one way from the base outwards, each on a body of its own.
pub(super) fn joints(
    scene: &Scene<'_, '_, '_>,
    couplings: &Couplings,
    wanted: &[String],
) -> Result<Vec<usize>, RobotError> {
    let chosen = if wanted.is_empty() {
        actuated(scene, couplings)?
    } else {
        named(scene, wanted)?
    };
    for pair in chosen.windows(2) {
        let (a, b) = (&scene.joints[pair[0]], &scene.joints[pair[1]]);
        if a.body == b.body {
            return Err(refused(format!(
                "joints {:?} and {:?} move the same body {:?}, and a link without mass between them is not supported; \
                 give each a body of its own with an <inertial>, or choose one of them by --joints",
                a.name, b.name, scene.bodies[a.body].name
            )));
        }
        if !carries(scene, a.body, b.body) {
            return Err(refused(format!(
                "joints {:?} and {:?} do not lie on one chain; choose joints of one arm by --joints, base first",
                a.name, b.name
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

fn named(scene: &Scene<'_, '_, '_>, wanted: &[String]) -> Result<Vec<usize>, RobotError> {
    let mut chosen = Vec::new();
    for name in wanted {
        let Some(joint) = scene.joint_named(name) else {
            return Err(refused(format!(
                "there is no joint {name:?}; the hinge and slide joints are {}",
                list(scene, &scalar(scene))
            )));
        };
        if scene.joints[joint].kind == Kind::Other {
            return Err(refused(format!(
                "joint {name:?} is a ball or free joint; only hinge and slide joints can be chosen"
            )));
        }
        if chosen.contains(&joint) {
            return Err(refused(format!("joint {name:?} is chosen twice")));
        }
        chosen.push(joint);
    }
    let mut order = chosen.clone();
    order.sort_unstable();
    if order != chosen {
        return Err(refused(format!(
            "the chosen joints are not in the order of the chain; give --joints {}",
            list(scene, &order).replace(", ", ",")
        )));
    }
    Ok(chosen)
}

fn scalar(scene: &Scene<'_, '_, '_>) -> Vec<usize> {
    let joints = scene.joints.iter().enumerate();
    let scalar = joints.filter(|(_, j)| j.kind != Kind::Other);
    scalar.map(|(i, _)| i).collect()
}

fn list(scene: &Scene<'_, '_, '_>, joints: &[usize]) -> String {
    let names = joints.iter().map(|&j| scene.joints[j].name.as_str());
    names.collect::<Vec<_>>().join(", ")
}

/// The chain of actuated joints (of all joints where none is actuated) from the base to where it ends or spreads into the
/// fingers of a hand.
fn actuated(scene: &Scene<'_, '_, '_>, couplings: &Couplings) -> Result<Vec<usize>, RobotError> {
    let all = scalar(scene);
    let driven: HashSet<usize> = couplings.actuated.iter().copied().collect();
    let mut candidates: Vec<usize> = all.iter().copied().filter(|j| driven.contains(j)).collect();
    if candidates.is_empty() {
        candidates = all;
    }
    if candidates.is_empty() {
        return Err(RobotError::NoJoints {
            name: scene.name.clone(),
        });
    }
    let above = |joint: usize| -> Option<usize> {
        let before = candidates.iter().rev().filter(|&&c| c < joint);
        let mut before = before.copied();
        before.find(|&c| carries(scene, scene.joints[c].body, scene.joints[joint].body))
    };
    let parents: Vec<Option<usize>> = candidates.iter().map(|&j| above(j)).collect();
    let below = |joint: Option<usize>| -> Vec<usize> {
        let pairs = candidates.iter().zip(&parents);
        pairs
            .filter(|(_, p)| **p == joint)
            .map(|(j, _)| *j)
            .collect()
    };
    // Longest way outwards from each candidate; children come after their parents.
    let mut longest = vec![1; candidates.len()];
    for i in (0..candidates.len()).rev() {
        if let Some(parent) = parents[i]
            && let Ok(at) = candidates.binary_search(&parent)
        {
            longest[at] = longest[at].max(longest[i] + 1);
        }
    }
    let reach = |joint: &usize| candidates.binary_search(joint).map_or(0, |at| longest[at]);
    let mut chain: Vec<usize> = Vec::new();
    loop {
        match below(chain.last().copied())[..] {
            [] => break,
            [only] => chain.push(only),
            ref several => {
                // The fingers of a hand are no longer than the arm; two arms on a column are.
                let branch = several.iter().map(reach).max().unwrap_or(0);
                if chain.len() > branch {
                    break;
                }
                let starts = list(scene, several);
                return Err(refused(format!(
                    "it holds more than one actuated chain (they begin at {starts}); name the joints of one, base first, \
                     by --joints a,b,c"
                )));
            }
        }
    }
    // A finger that drives others is no joint of the arm.
    while chain.len() > 1 && chain.last().is_some_and(|j| couplings.coupled(*j)) {
        chain.pop();
    }
    Ok(chain)
}
