//! A person or an object touching the tool.

use super::scene::{Pick, Scene, Shape};
use super::withheld::{Description, Withheld};
use nalgebra::Vector3;
use physics::dynamics::{Workspace, link_placements, point_jacobian};
use physics::robot::{Robot, RobotError};
use plant::build::Build;
use plant::mechanism::{Instant, Mechanism};
use plant::random::{log_uniform, unit_vector};
use plant::reference::Session;
use rand::{Rng, RngExt};
use serde_json::json;

/// One contact: from `start` to `end` (s) a spring and damper hold the tool where it was when touched, and
/// slip at `limit`.
#[derive(Debug, Clone, Copy)]
struct Grab {
    /// Time at which the contact begins, s.
    start: f64,
    /// Time at which the contact ends, s.
    end: f64,
    /// Stiffness of the contact's spring, N/m.
    stiffness: f64,
    /// Damping of the contact, N·s/m.
    damping: f64,
    /// Force beyond which the grip slips, N.
    limit: f64,
}

/// Contacts at a point of the last link.
struct ToolContact {
    robot: Robot,
    workspace: Workspace,
    point: Vector3<f64>,
    grabs: Vec<Grab>,
    anchor: Option<Vector3<f64>>,
    jacobian: Vec<f64>,
}

impl ToolContact {
    /// Contacts in order of time at `point` (m, last joint's frame).
    fn new(robot: Robot, point: Vector3<f64>, grabs: Vec<Grab>) -> Self {
        Self {
            workspace: Workspace::new(&robot),
            jacobian: vec![0.0; 6 * robot.dof()],
            robot,
            point,
            grabs,
            anchor: None,
        }
    }
}

impl Mechanism for ToolContact {
    fn push(&mut self, now: &Instant, force: &mut [f64]) {
        let Some(grab) = self
            .grabs
            .iter()
            .find(|g| (g.start..g.end).contains(&now.t))
        else {
            self.anchor = None;
            return;
        };
        let n = self.robot.dof();
        let Some(tool) = link_placements(&self.robot, now.q).last() else {
            return;
        };
        let here = tool.rotation * self.point + tool.translation;
        let anchor = *self.anchor.get_or_insert(here);
        point_jacobian(
            &self.robot,
            &mut self.workspace,
            now.q,
            n - 1,
            &self.point,
            &mut self.jacobian,
        );
        let velocity = Vector3::from_fn(|k, _| {
            let row = &self.jacobian[k * n..][..n];
            row.iter().zip(now.v).map(|(j, v)| j * v).sum()
        });
        // A hand closes and opens within a tenth of a second.
        let ease = ((now.t - grab.start).min(grab.end - now.t) / 0.1).clamp(0.0, 1.0);
        let pull = (anchor - here) * grab.stiffness - velocity * grab.damping;
        let pull = pull * (ease * (grab.limit / pull.norm().max(1e-9)).min(1.0));
        for (j, f) in force.iter_mut().enumerate() {
            *f += (0..3)
                .map(|k| self.jacobian[k * n + j] * pull[k])
                .sum::<f64>();
        }
    }
}

/// Contacts of the tool with the surroundings. Their size is a factor on stiffness, damping and force.
#[derive(Debug)]
struct Contact {
    point: Vector3<f64>,
    grabs: Vec<Grab>,
}

pub(super) fn draw(scene: &Scene, _pick: &Pick, rng: &mut dyn Rng) -> Option<Shape> {
    let com = scene.arm.joints[scene.arm.dof() - 1].link.inertia.com();
    let effect = Contact {
        point: com + unit_vector(rng) * 0.05,
        grabs: grabs(scene.session, rng),
    };
    Some(Shape::anywhere(effect, 0.1..0.35, rng))
}

/// Contacts in about half of the trajectories, of training and test alike.
fn grabs(session: &Session, rng: &mut dyn Rng) -> Vec<Grab> {
    let mut grabs = Vec::new();
    for (i, (start, length)) in session.starts.iter().zip(&session.lengths).enumerate() {
        // The third and every other test trajectory, and the first, are always touched.
        if i != 0 && i % 6 != 2 && rng.random_bool(0.55) {
            continue;
        }
        let mut t = start + rng.random_range(0.5..5.0);
        for _ in 0..rng.random_range(1..3) {
            let end = t + rng.random_range(0.8..3.0);
            if end > start + length - 0.3 {
                break;
            }
            grabs.push(Grab {
                start: t,
                end,
                stiffness: log_uniform(rng, 200.0, 900.0),
                damping: 8.0,
                limit: rng.random_range(20.0..60.0),
            });
            t = end + rng.random_range(1.0..4.0);
        }
    }
    grabs
}

impl Withheld for Contact {
    fn apply(&self, size: f64, build: &mut Build) -> Result<(), RobotError> {
        let grabs = self.grabs.iter().map(|g| Grab {
            stiffness: g.stiffness * size,
            damping: g.damping * size,
            limit: g.limit * size,
            ..*g
        });
        let robot = build.arm.robot()?;
        build.add(ToolContact::new(robot, self.point, grabs.collect()));
        Ok(())
    }

    fn describe(&self, size: f64, _dof: usize) -> Description {
        let times: Vec<[f64; 2]> = self.grabs.iter().map(|g| [g.start, g.end]).collect();
        let values = json!({"scale": size, "point": self.point.as_slice(), "times": times});
        Description::of_arm("tool_held", values)
    }

    fn smallest(&self) -> f64 {
        1.0
    }

    fn is_self_contained(&self) -> bool {
        true
    }
}
