//! A strut that carries part of an arm's weight: gas or coil spring.

use super::scene::{Pick, Scene, Shape};
use super::withheld::{Description, Withheld};
use physics::robot::RobotError;
use plant::build::Build;
use plant::mechanism::{CoilSpring, GasStrut, Pins};
use rand::{Rng, RngExt};
use serde_json::json;

/// Counterbalance of a joint. Its size is that of its spring: see [`Spring`].
#[derive(Debug)]
struct Counterbalance {
    joint: usize,
    pins: Pins,
    spring: Spring,
}

#[derive(Debug)]
enum Spring {
    /// Gas strut. Its size is the force at middle length, N; `volume` is the gas volume over the piston's area, m.
    Gas { volume: f64 },
    /// Coil spring. Its size is the stiffness, N/m; the free length is over the shortest distance of the pins.
    Coil { free: f64 },
}

/// Random counterbalance of a turning joint that gravity loads.
pub(super) fn draw(scene: &Scene, pick: &Pick, rng: &mut dyn Rng) -> Option<Shape> {
    let joint = pick.heavy.filter(|&j| scene.turns(j))?;
    let base = rng.random_range(0.3..0.7);
    let pins = Pins {
        lever: base * rng.random_range(0.25..0.7),
        base,
        angle: rng.random_range(0.4..2.7) * pick.sign - scene.arm.centre[joint],
    };
    let spring = if rng.random_bool(0.5) {
        Spring::Gas {
            volume: base * rng.random_range(0.8..2.0),
        }
    } else {
        Spring::Coil {
            free: rng.random_range(0.5..1.0),
        }
    };
    let effect = Counterbalance {
        joint,
        pins,
        spring,
    };
    Some(Shape::on(joint, effect, 0.1..0.5, rng))
}

impl Withheld for Counterbalance {
    fn apply(&self, size: f64, build: &mut Build) -> Result<(), RobotError> {
        let (joint, pins) = (build.axes[self.joint], self.pins);
        match self.spring {
            Spring::Gas { volume } => build.add(GasStrut {
                joint,
                pins,
                force: size,
                volume,
            }),
            Spring::Coil { free } => build.add(CoilSpring {
                joint,
                pins,
                stiffness: size,
                free,
            }),
        }
        Ok(())
    }

    fn describe(&self, size: f64, _dof: usize) -> Description {
        let Pins { lever, base, angle } = self.pins;
        let (mechanism, values) = match self.spring {
            Spring::Gas { volume } => (
                "gas_strut",
                json!({"force": size, "lever": lever, "base": base, "angle": angle, "volume": volume}),
            ),
            Spring::Coil { free } => (
                "coil_spring",
                json!({"stiffness": size, "lever": lever, "base": base, "angle": angle, "free": free}),
            ),
        };
        Description::of_joints(&[self.joint], mechanism, values)
    }

    fn smallest(&self) -> f64 {
        match self.spring {
            Spring::Gas { .. } => 100.0,
            Spring::Coil { .. } => 1000.0,
        }
    }

    fn is_self_contained(&self) -> bool {
        true
    }
}
