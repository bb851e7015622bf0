//! Background: small effects that every real joint has, besides the withheld effect.

use crate::cases::experiment::Chosen;
use crate::cases::rehearsal::Rehearsal;
use crate::effects::{CoggingWaves, Presliding, Scene, StartingFriction, Withheld};
use physics::robot::RobotError;
use plant::build::Build;
use plant::mechanism::StribeckKind;
use plant::random::log_uniform;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;
use std::ops::Range;

/// Range from which each background effect's share is drawn, log-uniformly: RMS of its torque over that of its joint's whole
/// torque. [`settle`] accepts from 0.5 times its start to 1.5 times its end.
const SHARES: Range<f64> = 0.01..0.04;
/// Probability of each background effect on each joint.
const CHANCE: f64 = 0.5;

/// Stribeck friction, presliding and ripple on about half of the joints each; none on a joint from which the very same effect
/// is withheld, and no presliding where a withheld effect has to do with Coulomb friction.
pub fn draw(
    scene: &Scene,
    rehearsal: &Rehearsal,
    withheld: &[Chosen],
    rng: &mut ChaCha8Rng,
) -> Result<Vec<Chosen>, RobotError> {
    let plain = Build::plain(scene.arm);
    let mut with = Build::plain(scene.arm);
    for w in withheld {
        w.effect.apply(w.size, &mut with)?;
    }
    let altered = |j: usize| with.friction[with.axes[j]] != plain.friction[j];
    let mut all = Vec::new();
    for j in 0..scene.arm.dof() {
        let candidates: [(&'static str, Box<dyn Withheld>); 3] = [
            ("stribeck_friction", Box::new(starting(scene, j, rng))),
            ("presliding_hysteresis", Box::new(presliding(scene, j, rng))),
            ("torque_ripple", Box::new(ripple(scene, j, rng))),
        ];
        for (name, effect) in candidates {
            let share = log_uniform(rng, SHARES.start, SHARES.end);
            let own = withheld.iter().any(|w| w.at == j && w.name == name);
            let bristles = name == "presliding_hysteresis";
            if !rng.random_bool(CHANCE) || own || (bristles && altered(j)) {
                continue;
            }
            let Some((size, at)) = rehearsal.size_for(effect.as_ref(), Some(j), share)? else {
                continue;
            };
            all.push(Chosen {
                name,
                effect,
                size,
                at,
                share,
                source: None,
            });
        }
    }
    Ok(all)
}

/// Result of setting the background's sizes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Settled {
    /// Sizes as meant: all effects are small.
    Well,
    /// Sizes of which some were corrected, so that the robot has to be simulated again.
    Again,
}

/// Corrects the sizes of effects that came out with other shares than meant: memory was only guessed from the commanded motion.
pub fn settle(background: &mut [Chosen], shares: &[f64]) -> Settled {
    let mut settled = Settled::Well;
    for (b, share) in background.iter_mut().zip(shares) {
        if !(0.5 * SHARES.start..1.5 * SHARES.end).contains(share) {
            b.size = (b.size * (b.share / share).clamp(0.1, 4.0)).min(b.effect.largest());
            settled = Settled::Again;
        }
    }
    settled
}

fn starting(scene: &Scene, joint: usize, rng: &mut ChaCha8Rng) -> StartingFriction {
    StartingFriction {
        joint,
        v_s: scene.demand.velocity[joint] * rng.random_range(0.05..0.3),
        law: StribeckKind::Lorentz,
    }
}

fn presliding(scene: &Scene, joint: usize, rng: &mut ChaCha8Rng) -> Presliding {
    Presliding {
        joint,
        elastic: rng.random_range(0.1..0.6),
        more: 0.0,
        damping: 0.1 * scene.inertia[joint] * TAU * 15.0,
    }
}

fn ripple(scene: &Scene, joint: usize, rng: &mut ChaCha8Rng) -> CoggingWaves {
    let order = rng.random_range(4.0..40.0) / scene.reach(joint);
    CoggingWaves {
        joint,
        waves: vec![[order, 1.0, rng.random_range(0.0..TAU)]],
    }
}
