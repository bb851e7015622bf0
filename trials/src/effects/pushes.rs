//! Pushes of a person who leans on the arm while it stands.

use super::scene::{Origin, Scene, Shape, Source};
use super::withheld::{Description, Withheld};
use super::words::Words;
use nalgebra::Vector3;
use physics::dynamics::{Workspace, point_jacobian};
use physics::robot::{Robot, RobotError};
use plant::build::Build;
use plant::mechanism::{Instant, Mechanism};
use plant::random::unit_vector;
use rand::seq::SliceRandom;
use rand::{Rng, RngExt};
use serde_json::json;
use std::ops::Range;

/// A force that swells, stays and goes, N.
#[derive(Debug, Clone, Copy)]
struct Lean {
    start: f64,
    end: f64,
    force: Vector3<f64>,
}

/// Time in which a force swells and goes, s.
const SWELL: f64 = 0.15;

/// Forces at a point of the last link.
struct Leaning {
    robot: Robot,
    workspace: Workspace,
    jacobian: Vec<f64>,
    point: Vector3<f64>,
    leans: Vec<Lean>,
}

impl Mechanism for Leaning {
    fn push(&mut self, now: &Instant, force: &mut [f64]) {
        let held = |l: &&Lean| (l.start..l.end).contains(&now.t);
        let Some(lean) = self.leans.iter().find(held) else {
            return;
        };
        let n = self.robot.dof();
        point_jacobian(
            &self.robot,
            &mut self.workspace,
            now.q,
            n - 1,
            &self.point,
            &mut self.jacobian,
        );
        let edge = (now.t - lean.start).min(lean.end - now.t) / SWELL;
        let part = 0.5 - 0.5 * (std::f64::consts::PI * edge.clamp(0.0, 1.0)).cos();
        for (j, f) in force.iter_mut().enumerate() {
            let along = (0..3).map(|k| self.jacobian[k * n + j] * lean.force[k]);
            *f += part * along.sum::<f64>();
        }
    }
}

/// Pushes of a person on the standing arm. Their size is the mean force, N.
#[derive(Debug)]
struct Leans {
    point: Vector3<f64>,
    leans: Vec<Lean>,
}

/// Pushes of 0.5 to 1.5 s in up to ten of the stretches in which the arm rests (s); none where there are fewer than two.
pub fn pushes_at_rest(scene: &Scene, rests: &[Range<f64>], rng: &mut dyn Rng) -> Option<Shape> {
    let mut words = Words::new(&[], rng);
    let shape = draw(scene, rests, &mut words)?;
    Some(Shape {
        source: Some(Source {
            origin: Origin::AtRest,
            words: words.used,
        }),
        ..shape
    })
}

fn draw(scene: &Scene, rests: &[Range<f64>], rng: &mut dyn Rng) -> Option<Shape> {
    let last = scene.arm.joints.last()?;
    let mut chosen: Vec<&Range<f64>> = rests.iter().collect();
    chosen.shuffle(rng);
    chosen.truncate(rng.random_range(3..11));
    chosen.sort_by(|a, b| a.start.total_cmp(&b.start));
    let leans = chosen.into_iter().filter_map(|rest| {
        let longest = rest.end - rest.start - 0.2;
        let length = rng.random_range(0.5..1.5f64).min(longest);
        let start = rest.start + 0.1 + rng.random_range(0.0..=(longest - length).max(0.0));
        (length >= 0.5).then(|| Lean {
            start,
            end: start + length,
            force: unit_vector(rng) * rng.random_range(0.5..1.5),
        })
    });
    let leans: Vec<Lean> = leans.collect();
    if leans.len() < 2 {
        return None;
    }
    let effect = Leans {
        point: last.link.inertia.com() + unit_vector(rng) * 0.05,
        leans,
    };
    Some(Shape::anywhere(effect, 0.05..0.2, rng))
}

impl Withheld for Leans {
    fn apply(&self, size: f64, build: &mut Build) -> Result<(), RobotError> {
        let robot = build.arm.robot()?;
        let leans = self.leans.iter().map(|l| Lean {
            force: l.force * size,
            ..*l
        });
        build.add(Leaning {
            workspace: Workspace::new(&robot),
            jacobian: vec![0.0; 6 * robot.dof()],
            robot,
            point: self.point,
            leans: leans.collect(),
        });
        Ok(())
    }

    fn describe(&self, size: f64, _dof: usize) -> Description {
        let times: Vec<[f64; 2]> = self.leans.iter().map(|l| [l.start, l.end]).collect();
        let values = json!({"force": size, "times": times, "point": self.point.as_slice()});
        Description::of_arm("pushed_at_rest", values)
    }

    fn smallest(&self) -> f64 {
        1.0
    }

    fn is_self_contained(&self) -> bool {
        true
    }
}
