//! Random shapes of mechanisms that the catalogue does not list.

use super::scene::{Scene, Shape};
use super::withheld::Withheld;
use crate::families::log_uniform;
use nalgebra::Vector3;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::PI;

/// A mechanism that the catalogue does not list.
pub(super) fn outside(scene: &Scene, j: usize, rng: &mut ChaCha8Rng) -> Option<Shape> {
    let n = scene.arm.dof();
    let other = (j + rng.random_range(1..n)) % n;
    let joints = [j, other];
    let centre = |j: usize, rng: &mut ChaCha8Rng| {
        scene.arm.centre[j] + scene.arm.reach[j] * rng.random_range(-0.4..0.4)
    };
    let (start, end) = scene.session.span();
    let (effect, joint) = match rng.random_range(0..8) {
        0 => {
            let ratio = scene.rehearsal.torque[j] / scene.rehearsal.torque[other];
            (Withheld::CrossDrag { joints, ratio }, Some(j))
        }
        1 => {
            let effect = Withheld::CableTug {
                joints,
                centre: [centre(j, rng), centre(other, rng)],
                ratio: rng.random_range(0.5..1.2),
                slack: rng.random_range(-0.1..0.25),
            };
            (effect, Some(j))
        }
        2 => {
            let (s, c) = rng.random_range(0.0..PI).sin_cos();
            let mass: f64 = scene.arm.joints.iter().map(|j| j.link.inertia.mass).sum();
            let effect = Withheld::Mount {
                axis: Vector3::new(c, s, 0.0),
                below: scene.arm.joints[0].translation.norm().max(0.1) * rng.random_range(0.5..1.2),
                mass,
                ratio: rng.random_range(0.03..0.1),
            };
            (effect, None)
        }
        3 => {
            let mut times = Vec::new();
            let mut t = start;
            while t < end {
                t += exponential(rng, 1.3);
                let stop = t + 0.04 + exponential(rng, 0.15);
                times.push((t, stop));
                t = stop;
            }
            (Withheld::Dropouts { joint: j, times }, Some(j))
        }
        4 => {
            let effect = Withheld::Hum {
                joint: j,
                frequency: rng.random_range(2.5..9.0),
                swell: rng.random_range(20.0..70.0),
            };
            (effect, Some(j))
        }
        5 => {
            let effect = Withheld::Tank {
                joint: j,
                frequency: rng.random_range(0.8..2.0),
                damping: rng.random_range(0.03..0.12),
            };
            (effect, Some(j))
        }
        6 => {
            let step = rng.random_range(0.6..1.5);
            let memory: f64 = 0.75;
            let mut value = 0.0;
            let knots = (0..((end + 10.0) / step) as usize).map(|_| {
                let kick: f64 = StandardNormal.sample(rng);
                value = memory * value + (1.0 - memory * memory).sqrt() * kick;
                value
            });
            let knots = knots.collect();
            (
                Withheld::Wander {
                    joint: j,
                    step,
                    knots,
                },
                Some(j),
            )
        }
        _ => {
            let effect = Withheld::Worn {
                joint: j,
                centre: centre(j, rng),
                half: scene.arm.reach[j] * rng.random_range(0.1..0.3),
            };
            (effect, Some(j))
        }
    };
    let share = log_uniform(rng, 0.1, 0.35);
    Some(Shape {
        effect,
        joint,
        share,
    })
}

fn exponential(rng: &mut ChaCha8Rng, mean: f64) -> f64 {
    -mean * (1.0 - rng.random::<f64>()).ln()
}
