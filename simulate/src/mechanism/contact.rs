//! Somebody or something touching the tool.

use super::{Instant, Mechanism};
use nalgebra::Vector3;
use physics::dynamics::{Workspace, link_placements, point_jacobian};
use physics::robot::Robot;

/// One contact: from `start` to `end` (s) a spring and damper hold the tool where it was when touched, and
/// slip at `limit`.
#[derive(Debug, Clone, Copy)]
pub struct Grab {
    /// s.
    pub start: f64,
    /// s.
    pub end: f64,
    /// N/m.
    pub stiffness: f64,
    /// N·s/m.
    pub damping: f64,
    /// Greatest force, N.
    pub limit: f64,
}

/// Contacts at a point of the last link.
pub struct ToolContact {
    robot: Robot,
    workspace: Workspace,
    point: Vector3<f64>,
    grabs: Vec<Grab>,
    anchor: Option<Vector3<f64>>,
    jacobian: Vec<f64>,
}

impl ToolContact {
    /// Contacts in order of time at `point` (m, last joint's frame).
    pub fn new(robot: Robot, point: Vector3<f64>, grabs: Vec<Grab>) -> Self {
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
