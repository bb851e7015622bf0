//! Friction that is higher in one direction than in the other.

use super::scene::{Pick, Scene, Shape};
use super::withheld::{Description, Withheld};
use physics::robot::RobotError;
use plant::build::Build;
use plant::mechanism::{Instant, Mechanism, soft_sign};
use rand::{Rng, RngExt};
use serde_json::json;

/// Friction that is higher forwards than backwards by the same amounts, as in a worm gear with a preloaded
/// thrust bearing: the mean over both directions is unchanged.
#[derive(Debug, Clone)]
struct ThrustBearing {
    /// Index of the plant's joint on which the mechanism acts.
    joint: usize,
    /// Half the difference of Coulomb friction, N·m; negative: higher backwards.
    coulomb: f64,
    /// Half the difference of viscous friction, N·m·s/rad.
    viscous: f64,
    /// Speed over which the sign of velocity is softened, rad/s.
    v_eps: f64,
}

impl Mechanism for ThrustBearing {
    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    fn resist(&self, _now: &Instant, v: f64) -> f64 {
        self.coulomb * soft_sign(v.abs(), self.v_eps) + self.viscous * v.abs()
    }
}

/// Friction that differs by direction. Its size is the extra torque at top speed, N·m.
#[derive(Debug)]
pub struct Asymmetry {
    /// Index of the joint on which the effect acts.
    pub joint: usize,
    /// Coulomb part over the size, without unit.
    pub coulomb: f64,
    /// Viscous part over the size, s/rad.
    pub viscous: f64,
}

/// Random asymmetry, mostly dry or mostly viscous.
pub(super) fn draw(scene: &Scene, pick: &Pick, rng: &mut dyn Rng) -> Option<Shape> {
    let (joint, sign) = (pick.any, pick.sign);
    let (coulomb, viscous) = if rng.random_bool(0.35) {
        (sign, 0.0)
    } else {
        let dry = 0.2 * sign * rng.random_range(-1.0..1.0);
        (dry, sign / scene.demand.velocity[joint])
    };
    let effect = Asymmetry {
        joint,
        coulomb,
        viscous,
    };
    Some(Shape::on(joint, effect, 0.05..0.2, rng))
}

impl Withheld for Asymmetry {
    fn apply(&self, size: f64, build: &mut Build) -> Result<(), RobotError> {
        build.add(ThrustBearing {
            joint: build.axes[self.joint],
            coulomb: size * self.coulomb,
            viscous: size * self.viscous,
            v_eps: build.v_eps(self.joint),
        });
        Ok(())
    }

    fn describe(&self, size: f64, _dof: usize) -> Description {
        let values = json!({"coulomb": self.coulomb * size, "viscous": self.viscous * size});
        // Without a viscous part the joint only pulls to one side.
        let dry = self.viscous == 0.0;
        Description::of_joints(&[self.joint], "asymmetric_friction", values)
            .same_as("torque_offset", dry)
    }

    fn is_self_contained(&self) -> bool {
        true
    }
}
