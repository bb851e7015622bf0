//! Friction of a rubbing pair whose pressure changes over a turn.

use super::scene::{Pick, Scene, Shape};
use super::withheld::{Description, Withheld};
use physics::robot::RobotError;
use plant::build::Build;
use plant::mechanism::{Instant, Mechanism, soft_sign};
use rand::{Rng, RngExt};
use serde_json::json;
use std::f64::consts::TAU;

/// Cause of the change of a rubbing pair's contact pressure over a turn.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Cause {
    /// A bent shaft: its weight e (relative to the preload) turns with it, N = √(1 + e² + 2 e cos φ).
    BentShaft(f64),
    /// An eccentric gear: teeth press where the pitch circles overlap, max(0, cos φ)^1.5 (a line contact's stiffness grows).
    Eccentric,
}

/// Friction of a pair whose pressure changes over a turn, besides that of its mean.
#[derive(Debug, Clone)]
struct RunoutFriction {
    /// Index of the plant's joint on which the mechanism acts.
    joint: usize,
    /// Friction at the tightest place over that of the mean pressure, N·m.
    size: f64,
    /// The viscous part at 1 rad/s over the dry one, s/rad.
    viscous: f64,
    /// Turns of the part per turn of the joint.
    order: f64,
    /// Position of the highest pressure, rad.
    phase: f64,
    /// Speed over which the sign of velocity is softened, rad/s.
    v_eps: f64,
    cause: Cause,
}

impl Mechanism for RunoutFriction {
    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    fn resist(&self, now: &Instant, v: f64) -> f64 {
        let cos = (self.order * now.q[self.joint] - self.phase).cos();
        let pressure = match self.cause {
            Cause::BentShaft(e) => (1.0 + e * e + 2.0 * e * cos).sqrt() - 1.0,
            Cause::Eccentric => cos.max(0.0).powf(1.5),
        };
        self.size * pressure * (soft_sign(v, self.v_eps) + self.viscous * v)
    }
}

/// Friction that changes over a turn of the joint. Its size is the extra friction at the tightest place, N·m.
#[derive(Debug)]
struct Runout {
    joint: usize,
    order: f64,
    phase: f64,
    viscous: f64,
    cause: Cause,
}

pub(super) fn draw(scene: &Scene, pick: &Pick, rng: &mut dyn Rng) -> Option<Shape> {
    let joint = pick.any;
    // A part turns at least once over the range, with the joint or a stage of its gear.
    let once = (0.5 * TAU / scene.arm.reach[joint]).ceil();
    let order = if rng.random_bool(0.5) && scene.turns(joint) {
        once + f64::from(rng.random_range(0..4))
    } else {
        once * rng.random_range(1.0..9.0)
    };
    let cause = if rng.random_bool(0.5) {
        Cause::BentShaft(rng.random_range(0.4..0.95))
    } else {
        Cause::Eccentric
    };
    let effect = Runout {
        joint,
        order,
        phase: rng.random_range(0.0..TAU),
        viscous: rng.random_range(0.0..0.5) / scene.demand.velocity[joint],
        cause,
    };
    Some(Shape::on(joint, effect, 0.05..0.2, rng))
}

impl Withheld for Runout {
    fn apply(&self, size: f64, build: &mut Build) -> Result<(), RobotError> {
        build.add(RunoutFriction {
            joint: build.axes[self.joint],
            size,
            viscous: self.viscous,
            order: self.order,
            phase: self.phase,
            v_eps: build.v_eps(self.joint),
            cause: self.cause,
        });
        Ok(())
    }

    fn describe(&self, size: f64, _dof: usize) -> Description {
        let mechanism = match self.cause {
            Cause::BentShaft(_) => "bent_shaft",
            Cause::Eccentric => "eccentric_gear",
        };
        let values = json!({
            "friction": size,
            "order": self.order,
            "phase": self.phase,
            "viscous": self.viscous,
        });
        Description::of_joints(&[self.joint], mechanism, values)
    }

    fn is_self_contained(&self) -> bool {
        true
    }
}
