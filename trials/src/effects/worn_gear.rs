//! Gears that are neither a spring nor plain play: friction between the teeth, play under wind-up, damping that grows with
//! the load.

use super::scene::{Pick, Scene, Shape};
use super::withheld::{Description, Place, Withheld, Yielding};
use physics::robot::RobotError;
use plant::build::Build;
use plant::mechanism::{Instant, Mechanism};
use rand::{Rng, RngExt};
use serde_json::json;
use std::f64::consts::TAU;

/// A gear between a rotor and its link.
#[derive(Debug, Clone)]
struct WornGear {
    /// Plant joint of the gear's deflection.
    joint: usize,
    /// Half of the play of the gear, rad.
    half: f64,
    /// Stiffness of the wind-up, N·m/rad.
    stiffness: f64,
    /// Friction between the teeth, N·m: σ = friction · z, ż = (v − |v| z)/bend (Dahl).
    friction: f64,
    /// Deflection over which that friction turns, rad.
    bend: f64,
    z: f64,
    /// Damping without load, N·m·s/rad.
    damping: f64,
    /// Torque at which damping has doubled, N·m.
    doubling: f64,
}

impl WornGear {
    fn depth(&self, x: f64) -> f64 {
        x - x.clamp(-self.half, self.half)
    }
}

impl Mechanism for WornGear {
    fn push(&mut self, now: &Instant, force: &mut [f64]) {
        force[self.joint] -= self.stiffness * self.depth(now.q[self.joint]);
    }

    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    fn resist(&self, now: &Instant, v: f64) -> f64 {
        let depth = self.depth(now.q[self.joint]);
        if depth == 0.0 {
            // Grease between the flanks.
            return 0.01 * self.damping * v;
        }
        let damping = self.damping * (1.0 + (self.stiffness * depth).abs() / self.doubling);
        damping * v + self.friction * self.bent(now.dt, v)
    }

    fn advance(&mut self, now: &Instant, v: &[f64]) {
        self.z = if self.depth(now.q[self.joint]) == 0.0 {
            0.0
        } else {
            self.bent(now.dt, v[self.joint])
        };
    }
}

impl WornGear {
    /// State of the teeth's friction at the end of a step that ended at velocity `v`, implicit.
    fn bent(&self, dt: f64, v: f64) -> f64 {
        (self.z + dt * v / self.bend) / (1.0 + dt * v.abs() / self.bend)
    }
}

/// Quantity that sets a worn gear's size.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Sized {
    /// Wind-up; its size is the compliance, rad/(N·m).
    WindUp,
    /// Play; its size is half of it, rad.
    Play,
}

#[derive(Debug)]
struct Worn {
    joint: usize,
    sized: Sized,
    mechanism: &'static str,
    /// Root mean square torque of the joint on the session's motion, N·m.
    usual: f64,
    /// Ratio of half the play to the wind-up under the torque `usual`.
    play: f64,
    /// Stiffness where the play sets the size, N·m/rad.
    stiffness: f64,
    /// Ratio of the friction between the teeth to the torque `usual`.
    friction: f64,
    /// Damping ratio of the rotor on its gear.
    ratio: f64,
    /// Ratio of the torque at which damping has doubled to the torque `usual`.
    doubling: f64,
}

const PLENTY: f64 = 1e6;

/// A gear that winds up: with friction between its teeth, with damping that grows with the load, or with some play.
pub(super) fn wind_up(scene: &Scene, pick: &Pick, rng: &mut dyn Rng) -> Option<Shape> {
    let joint = pick.geared?;
    let plain = Worn {
        joint,
        sized: Sized::WindUp,
        mechanism: "",
        usual: scene.demand.torque[joint],
        play: 0.0,
        stiffness: 0.0,
        friction: 0.0,
        ratio: rng.random_range(0.02..0.08),
        doubling: PLENTY,
    };
    let worn = match rng.random_range(0..3) {
        0 => Worn {
            mechanism: "wind_up_with_tooth_friction",
            friction: rng.random_range(0.05..0.15),
            ..plain
        },
        1 => Worn {
            mechanism: "wind_up_damped_by_load",
            doubling: rng.random_range(0.3..1.0),
            ..plain
        },
        _ => Worn {
            mechanism: "wind_up_with_play",
            play: rng.random_range(0.15..0.35),
            ..plain
        },
    };
    Some(Shape::on(joint, worn, 0.05..0.16, rng))
}

/// A gear with play whose flanks wind up more than stiff ones, or have friction.
pub(super) fn play(scene: &Scene, pick: &Pick, rng: &mut dyn Rng) -> Option<Shape> {
    let joint = pick.geared?;
    let soft = rng.random_bool(0.5);
    let frequency = if soft { 14.0..22.0 } else { 25.0..40.0 };
    let worn = Worn {
        joint,
        sized: Sized::Play,
        mechanism: if soft {
            "play_with_wind_up"
        } else {
            "play_with_tooth_friction"
        },
        usual: scene.demand.torque[joint],
        play: 0.0,
        stiffness: scene.inertia[joint] * (TAU * rng.random_range(frequency)).powi(2),
        friction: if soft {
            0.0
        } else {
            rng.random_range(0.05..0.15)
        },
        ratio: 0.25,
        doubling: PLENTY,
    };
    Some(Shape::on(joint, worn, 0.05..0.15, rng))
}

impl Worn {
    fn half(&self, size: f64) -> f64 {
        match self.sized {
            Sized::WindUp => self.play * size * self.usual,
            Sized::Play => size,
        }
    }
}

impl Withheld for Worn {
    fn apply(&self, size: f64, build: &mut Build) -> Result<(), RobotError> {
        let disc = build.arm.disc[self.joint];
        let stiffness = self.stiffness(size);
        let joint = build.split(self.joint);
        build.add(WornGear {
            joint,
            half: self.half(size),
            stiffness,
            friction: self.friction * self.usual,
            bend: 0.3 * self.usual / stiffness,
            z: 0.0,
            damping: 2.0 * self.ratio * (stiffness * disc).sqrt(),
            doubling: self.doubling * self.usual,
        });
        Ok(())
    }

    fn describe(&self, size: f64, _dof: usize) -> Description {
        let values = json!({
            "stiffness": self.stiffness(size),
            "play": 2.0 * self.half(size),
            "tooth_friction": self.friction * self.usual,
            "damping_ratio": self.ratio,
        });
        let other = match self.sized {
            Sized::WindUp => "backlash",
            Sized::Play => "joint_elasticity",
        };
        let both = self.sized == Sized::Play || self.play > 0.0;
        Description::of_joints(&[self.joint], self.mechanism, values).same_as(other, both)
    }

    fn largest(&self) -> f64 {
        match self.sized {
            Sized::WindUp => f64::INFINITY,
            Sized::Play => 0.02,
        }
    }

    fn smallest(&self) -> f64 {
        match self.sized {
            Sized::WindUp => 1e-6,
            Sized::Play => 0.002,
        }
    }

    fn yielding(&self) -> Option<&dyn Yielding> {
        Some(self)
    }
}

impl Yielding for Worn {
    fn place(&self) -> Place {
        Place::Gear(self.joint)
    }

    fn stiffness(&self, size: f64) -> f64 {
        match self.sized {
            Sized::WindUp => 1.0 / size,
            Sized::Play => self.stiffness,
        }
    }

    /// Wind-up, and from flank to flank, softened where the torque is small.
    fn deflection(&self, size: f64, torque: f64, usual: f64) -> f64 {
        -torque / self.stiffness(size) - self.half(size) * (torque / (0.03 * usual)).tanh()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A slow pull and release: play first, then the wind-up, and less torque on the way back by twice the friction.
    #[test]
    fn teeth_hold_back_on_the_way_home() {
        let mut gear = WornGear {
            joint: 0,
            half: 0.01,
            stiffness: 100.0,
            friction: 0.5,
            bend: 1e-3,
            z: 0.0,
            damping: 0.0,
            doubling: 1.0,
        };
        let dt = 1e-4;
        let mut pull = |x: f64, v: f64| {
            let (q, vs, zero) = ([x], [v], [0.0]);
            let now = Instant {
                t: 0.0,
                dt,
                q: &q,
                v: &vs,
                a: &zero,
                load: &zero,
            };
            let mut force = [0.0];
            gear.push(&now, &mut force);
            let torque = -force[0] + gear.resist(&now, v);
            gear.advance(&now, &vs);
            torque
        };
        let (mut out, mut back) = (0.0, 0.0);
        for k in 0..=600 {
            let torque = pull(f64::from(k) * 1e-4, 1.0);
            if k == 50 {
                assert_eq!(torque, 0.0);
            }
            if k == 400 {
                out = torque;
            }
        }
        for k in (400..=600).rev() {
            back = pull(f64::from(k) * 1e-4, -1.0);
        }
        assert!((out - 3.5).abs() < 0.01, "{out}");
        assert!((back - 2.5).abs() < 0.01, "{back}");
    }
}
