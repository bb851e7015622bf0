//! A joint that sticks and slides.

use crate::joint::Joint;

/// Γ q̈ + gravity + friction = u, integrated with friction implicit: the end velocity of a step solves
/// Γ (v₁ − v₀)/h = u − g(q) − f(v₁), which is piecewise linear with at most one solution; none on either side of zero means
/// that the joint sticks.
#[derive(Debug, Clone)]
pub struct Plant {
    joint: Joint,
    /// Position, rad.
    pub q: f64,
    /// Velocity, rad/s.
    pub v: f64,
}

impl Plant {
    /// At rest at `q`.
    pub fn new(joint: Joint, q: f64) -> Self {
        Self { joint, q, v: 0.0 }
    }

    /// One step of `h` seconds under torque `u`.
    pub fn step(&mut self, u: f64, h: f64) {
        let inertia = self.joint.inertia / h;
        let push = inertia * self.v + u - self.joint.gravity(self.q);
        let friction = &self.joint.friction;
        let forwards = (push - friction.coulomb[0]) / (inertia + friction.viscous[0]);
        let backwards = (push + friction.coulomb[1]) / (inertia + friction.viscous[1]);
        let end = if forwards > 0.0 {
            forwards
        } else if backwards < 0.0 {
            backwards
        } else {
            0.0
        };
        self.q += 0.5 * h * (self.v + end);
        self.v = end;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::joint::Friction;

    fn joint() -> Joint {
        Joint {
            inertia: 2.0,
            moments: None,
            friction: Friction {
                viscous: [4.0, 5.0],
                coulomb: [3.0, 6.0],
            },
        }
    }

    /// It holds up to its Coulomb friction of that direction, and runs at (u − β^c)/β^v beyond.
    #[test]
    fn it_sticks_and_slides() {
        for (u, speed) in [(2.9, 0.0), (-5.9, 0.0), (11.0, 2.0), (-11.0, -1.0)] {
            let mut plant = Plant::new(joint(), 0.0);
            for _ in 0..20_000 {
                plant.step(u, 1e-3);
            }
            assert!((plant.v - speed).abs() < 1e-9, "{u}: {}", plant.v);
        }
    }
}
