//! Basis of an effect's draw, and the drawn effect.

use super::withheld::Withheld;
use plant::arm::Arm;
use plant::random::log_uniform;
use plant::reference::Session;
use rand::seq::IndexedRandom;
use rand::{Rng, RngExt};
use std::ops::Range;

/// Robot and motion for which a shape is drawn.
pub struct Scene<'a> {
    /// Plant without effects.
    pub arm: &'a Arm,
    /// Session with the arm's motion.
    pub session: &'a Session,
    /// Demand of the session's commanded motion on each joint.
    pub demand: &'a Demand,
    /// Diagonal of the arm's mass matrix in mid-region, kg·m².
    pub inertia: &'a [f64],
}

impl Scene<'_> {
    /// Whether joint `j` turns; others slide.
    pub fn turns(&self, j: usize) -> bool {
        self.arm.joints[j].kind.is_rotation()
    }

    /// Lengths of angle over those of a turning joint: a sliding joint's positions are smaller.
    pub fn reach(&self, j: usize) -> f64 {
        self.arm.reach[j] / 1.4
    }
}

/// Demand of a motion on each joint of the plain plant.
pub struct Demand {
    /// Root mean square of the whole torque, N·m.
    pub torque: Vec<f64>,
    /// Root mean square of gravity's torque, N·m.
    pub gravity: Vec<f64>,
    /// Greatest torque of each joint, N·m.
    pub greatest: Vec<f64>,
    /// Root mean square velocity, rad/s.
    pub velocity: Vec<f64>,
    /// Mean power of each joint's friction, W.
    pub power: Vec<f64>,
}

/// Draws that are common to all effects and precede their own. They are made whether an effect uses them or
/// not, so that no effect's draws depend on another's.
pub struct Pick {
    /// Index of a joint of any kind.
    pub any: usize,
    /// Index of a joint that gravity loads; none without one.
    pub heavy: Option<usize>,
    /// Index of a joint whose rotor inertia can be told from its link's; none where the arm has no such joint.
    pub geared: Option<usize>,
    /// Sign for effects that may have either: 1 or −1.
    pub sign: f64,
}

impl Pick {
    /// Random joints and sign for a scene.
    pub fn draw(scene: &Scene, rng: &mut dyn Rng) -> Self {
        let (n, demand) = (scene.arm.dof(), scene.demand);
        let loaded: Vec<usize> = (0..n)
            .filter(|&j| demand.gravity[j] > 0.3 * demand.torque[j])
            .collect();
        let any = rng.random_range(0..n);
        let heavy = loaded.choose(rng).copied();
        let geared: Vec<usize> = (0..n).filter(|&j| scene.arm.disc[j] > 0.0).collect();
        let geared = geared.choose(rng).copied();
        let sign = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
        Self {
            any,
            heavy,
            geared,
            sign,
        }
    }
}

/// A shape and where and how large it is to be.
pub struct Shape {
    /// Effect with its drawn shape, still without a size.
    pub effect: Box<dyn Withheld>,
    /// Index of the joint on which the effect's size is set; none for the joint where it is largest.
    pub joint: Option<usize>,
    /// Share of the joint's torque that the effect makes.
    pub share: f64,
    /// Draw that gave it; none where it was not noted.
    pub source: Option<Source>,
}

/// Draw of a shape.
#[derive(Debug, Clone)]
pub struct Source {
    /// Function that drew the shape.
    pub origin: Origin,
    /// Random words of the draw; the last sets the share.
    pub words: Vec<u64>,
}

/// Function that draws a shape.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Origin {
    /// Effect of the catalogue: an index into [`super::EFFECTS`].
    Listed(usize),
    /// Worn gear: an index into `Effect::WORN`.
    Worn(usize),
    /// Mechanism outside the catalogue.
    Outside,
    /// Pushes while the arm stands.
    AtRest,
}

impl Shape {
    /// An effect whose share of the torque of joint `j` is drawn from `shares`.
    pub fn on(
        j: usize,
        effect: impl Withheld + 'static,
        shares: Range<f64>,
        rng: &mut dyn Rng,
    ) -> Self {
        Self {
            joint: Some(j),
            ..Self::anywhere(effect, shares, rng)
        }
    }

    /// An effect whose share is that of the joint where it is largest.
    pub fn anywhere(
        effect: impl Withheld + 'static,
        shares: Range<f64>,
        rng: &mut dyn Rng,
    ) -> Self {
        Self {
            effect: Box::new(effect),
            joint: None,
            share: log_uniform(rng, shares.start, shares.end),
            source: None,
        }
    }
}
