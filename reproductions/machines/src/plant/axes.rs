//! Single axes as point masses: force from acceleration, torque from force and lever, as vectors.

use super::carried::Carried;
use super::mechanics::{Friction, Plant};
use nalgebra::{Vector2, Vector3};

/// A crank with a counterweight: point masses at an angle and distance from the axis, and a rotor.
pub(super) struct Crank {
    /// Mass kg, distance m, angle from the crank rad.
    bodies: Vec<(f64, f64, f64)>,
    rotor: f64,
    gravity: f64,
}

impl Crank {
    /// For model 1 (balanced), 2 (turns in the horizontal plane) or 3 (vertical plane).
    pub fn new(model: usize, carried: &Carried) -> Self {
        let mut bodies = if model == 1 {
            vec![(3.0, 0.15, 0.0), (3.0, 0.15, std::f64::consts::PI)]
        } else {
            vec![(2.5, 0.35, 0.0), (1.5, 0.12, 2.6)]
        };
        let at_end = if model == 1 { 0.0 } else { 0.35 };
        bodies.push((carried.mass, at_end, 0.0));
        Self {
            bodies,
            rotor: 0.08 + carried.inertia,
            gravity: if model == 3 { 9.806_65 } else { 0.0 },
        }
    }
}

impl Plant for Crank {
    fn torque(&self, q: &[f64], qd: &[f64], qdd: &[f64]) -> Vec<f64> {
        let mut torque = self.rotor * qdd[0];
        for &(mass, distance, angle) in &self.bodies {
            let (sin, cos) = (q[0] + angle).sin_cos();
            let lever = Vector2::new(cos, sin) * distance;
            let along = Vector2::new(-sin, cos) * distance;
            let acceleration = along * qdd[0] - lever * (qd[0] * qd[0]);
            let force = (acceleration + Vector2::y() * self.gravity) * mass;
            torque += lever.x * force.y - lever.y * force.x;
        }
        vec![torque]
    }

    fn friction(&self) -> Vec<Friction> {
        vec![Friction {
            viscous: 0.35,
            coulomb: 1.2,
            soft: 0.01,
        }]
    }
}

/// A carriage on rails, 30° from the vertical where it is tilted.
pub(super) struct Carriage {
    rail: Vector3<f64>,
    mass: f64,
    spindle: f64,
}

impl Carriage {
    /// For model 1 (horizontal) or 2 (tilted).
    pub fn new(model: usize, carried: &Carried) -> Self {
        let rail = if model == 1 {
            Vector3::x()
        } else {
            let angle = 30.0_f64.to_radians();
            Vector3::new(angle.sin(), 0.0, angle.cos())
        };
        Self {
            rail,
            mass: 25.0 + carried.mass,
            spindle: 0.0,
        }
    }
}

impl Plant for Carriage {
    fn torque(&self, _q: &[f64], _qd: &[f64], qdd: &[f64]) -> Vec<f64> {
        let acceleration = self.rail * qdd[0] + Vector3::z() * 9.806_65;
        vec![self.mass * acceleration.dot(&self.rail) + self.spindle * qdd[0]]
    }

    fn friction(&self) -> Vec<Friction> {
        vec![Friction {
            viscous: 60.0,
            coulomb: 35.0,
            soft: 0.002,
        }]
    }
}
