//! Delta by Lagrange's equations with energies of all its bodies, differentiated by differences; its kinematics by Newton's
//! method on the forearms' lengths.

use super::carried::Carried;
use super::mechanics::{Friction, Plant};
use crate::MachineError;
use crate::description::Description;
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::TAU;

/// Step of differences, rad: with central differences of fourth order errors stay below 1e-8 of the torque.
const STEP: f64 = 2e-3;

/// Arms, forearms, plate, shaft.
pub(super) struct Delta {
    base_radius: f64,
    plate_radius: f64,
    arm: f64,
    forearm: f64,
    /// Forearms with the inertia of rods, or as points at their ends.
    rods: bool,
    axes: usize,
    plate: f64,
    shaft: f64,
}

/// Arm with rotor about its axis, kg·m²; its weight's moment, kg·m; one forearm (two rods), kg; radius of inertia of its
/// section, m; plate with tool, kg; shaft and tool about the vertical, kg·m².
const ARM_INERTIA: f64 = 0.062;
const ARM_MOMENT: f64 = 0.11;
const FOREARM: f64 = 0.22;
const SECTION: f64 = 0.02;
const PLATE: f64 = 0.9;
const SHAFT: f64 = 0.0045;
const GRAVITY: f64 = 9.81;

impl Delta {
    /// With the description's lengths.
    pub fn new(
        description: &Description,
        ideal: bool,
        carried: &Carried,
    ) -> Result<Self, MachineError> {
        let geometry = &description.geometry;
        let length = |value, name| description.length(value, name);
        Ok(Self {
            base_radius: length(geometry.base_radius, "base_radius")?,
            plate_radius: length(geometry.plate_radius, "plate_radius")?,
            arm: length(geometry.arm, "arm")?,
            forearm: length(geometry.forearm, "forearm")?,
            rods: !ideal,
            axes: description.axis.len(),
            plate: PLATE + carried.mass,
            shaft: SHAFT + carried.inertia,
        })
    }

    /// Elbow of an arm and the joint of its forearm on the plate.
    fn ends(&self, arm: usize, q: f64, plate: &Vector3<f64>) -> [Vector3<f64>; 2] {
        let angle = TAU * arm as f64 / 3.0;
        let out = Vector3::new(angle.cos(), angle.sin(), 0.0);
        let elbow =
            out * (self.base_radius + self.arm * q.cos()) - Vector3::z() * (self.arm * q.sin());
        [elbow, plate + out * self.plate_radius]
    }

    /// Position of the plate by Newton's method from below the base.
    fn plate(&self, q: [f64; 3]) -> Vector3<f64> {
        let mut x = Vector3::new(0.0, 0.0, -self.forearm);
        for _ in 0..30 {
            let rods: [Vector3<f64>; 3] = std::array::from_fn(|i| {
                let [elbow, joint] = self.ends(i, q[i], &x);
                joint - elbow
            });
            let wrong = Vector3::from_fn(|i, _| rods[i].norm_squared() - self.forearm.powi(2));
            let slope = Matrix3::from_rows(&rods.map(|s| 2.0 * s.transpose()));
            let Some(step) = slope.lu().solve(&wrong) else {
                break;
            };
            x -= step;
            // Convergence is quadratic: the next step would be rounding.
            if step.norm() < 1e-9 {
                break;
            }
        }
        x
    }

    /// Kinetic energy of motion along `qd` through q: displacements over a short time give the velocities.
    fn kinetic(&self, q: [f64; 3], qd: [f64; 3]) -> f64 {
        let norm = Vector3::from(qd).norm();
        if norm == 0.0 {
            return 0.0;
        }
        let h = STEP / norm;
        let at = |k: f64| -> [f64; 3] { std::array::from_fn(|i| q[i] + k * h * qd[i]) };
        let points = |k: f64| {
            let q = at(k);
            let plate = self.plate(q);
            (
                plate,
                std::array::from_fn::<_, 3, _>(|i| self.ends(i, q[i], &plate)),
            )
        };
        let seen = [-2.0, -1.0, 1.0, 2.0].map(points);
        // Fourth order: (f₋₂ − 8 f₋₁ + 8 f₁ − f₂) / 12 h.
        let rate = |get: &dyn Fn(usize) -> Vector3<f64>| {
            (get(0) - get(1) * 8.0 + get(2) * 8.0 - get(3)) / (12.0 * h)
        };
        let plate = rate(&|k| seen[k].0);
        let mut energy = 0.5 * self.plate * plate.norm_squared();
        for (i, velocity) in qd.iter().enumerate() {
            energy += 0.5 * ARM_INERTIA * velocity * velocity;
            let [elbow, joint] = [0, 1].map(|end| rate(&|k| seen[k].1[i][end]));
            energy += if self.rods {
                let middle = (elbow + joint) / 2.0;
                // Turning: ω across the rod from the ends' difference; thickness adds to its inertia.
                let turn = (joint - elbow) / self.forearm;
                let inertia = FOREARM * (self.forearm.powi(2) / 12.0 + SECTION.powi(2));
                0.5 * FOREARM * middle.norm_squared() + 0.5 * inertia * turn.norm_squared()
            } else {
                0.25 * FOREARM * (elbow.norm_squared() + joint.norm_squared())
            };
        }
        energy
    }

    fn potential(&self, q: [f64; 3]) -> f64 {
        let plate = self.plate(q);
        let mut height = self.plate * plate.z;
        for (i, &q) in q.iter().enumerate() {
            let [elbow, joint] = self.ends(i, q, &plate);
            height += -ARM_MOMENT * q.sin() + FOREARM * (elbow.z + joint.z) / 2.0;
        }
        GRAVITY * height
    }

    /// Mass matrix from energies of unit velocities: T is quadratic.
    fn mass(&self, q: [f64; 3]) -> Matrix3<f64> {
        let unit = |i: usize| -> [f64; 3] { std::array::from_fn(|k| f64::from(u8::from(k == i))) };
        let alone = [0, 1, 2].map(|i| self.kinetic(q, unit(i)));
        Matrix3::from_fn(|i, j| {
            if i == j {
                return 2.0 * alone[i];
            }
            let both: [f64; 3] = std::array::from_fn(|k| unit(i)[k] + unit(j)[k]);
            self.kinetic(q, both) - alone[i] - alone[j]
        })
    }
}

/// Derivative at zero by central differences of fourth order.
fn slope<T>(f: impl Fn(f64) -> T) -> T
where
    T: std::ops::Sub<Output = T> + std::ops::Add<Output = T> + std::ops::Mul<f64, Output = T>,
{
    let h = STEP;
    (f(-2.0 * h) - f(2.0 * h) + (f(h) - f(-h)) * 8.0) * (1.0 / (12.0 * h))
}

impl Plant for Delta {
    fn torque(&self, q: &[f64], qd: &[f64], qdd: &[f64]) -> Vec<f64> {
        let (at, velocity) = ([q[0], q[1], q[2]], [qd[0], qd[1], qd[2]]);
        let shifted = |i: usize, h: f64| -> [f64; 3] {
            std::array::from_fn(|k| if k == i { at[k] + h } else { at[k] })
        };
        // M q̈ + Ṁ q̇ − ∂T/∂q + ∂V/∂q, with Ṁ along the motion.
        let v = Vector3::from(velocity);
        let speed = v.norm().max(f64::MIN_POSITIVE);
        let along = |h: f64| self.mass(std::array::from_fn(|k| at[k] + h * velocity[k] / speed));
        let mut torque = self.mass(at) * Vector3::new(qdd[0], qdd[1], qdd[2]);
        torque += slope(along) * v * speed;
        let mut all: Vec<f64> = (0..3)
            .map(|i| {
                let kinetic = slope(|h| self.kinetic(shifted(i, h), velocity));
                torque[i] - kinetic + slope(|h| self.potential(shifted(i, h)))
            })
            .collect();
        if self.axes == 4 {
            all.push(self.shaft * qdd[3]);
        }
        all
    }

    fn friction(&self) -> Vec<Friction> {
        let arm = Friction {
            viscous: 0.25,
            coulomb: 0.7,
            soft: 0.01,
        };
        let mut all = vec![arm; 3];
        if self.axes == 4 {
            all.push(Friction {
                viscous: 0.01,
                coulomb: 0.06,
                soft: 0.05,
            });
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::TorqueModel;
    use crate::models::delta::{Delta as Model, Shape};

    /// With forearms as points at their ends the plant is the model, by other equations: parameters by hand.
    #[test]
    fn points_at_the_ends_are_the_model_1() {
        let description = Description::load("delta3").expect("built in");
        let plant = Delta::new(&description, true, &Carried::default()).expect("lengths are given");
        let shape = Shape {
            offset: plant.base_radius - plant.plate_radius,
            arm: plant.arm,
            forearm: plant.forearm,
        };
        let model = Model::new(shape, 3, 1);
        let parameters = [
            ARM_INERTIA + 0.5 * FOREARM * plant.arm.powi(2),
            GRAVITY * (ARM_MOMENT + 0.5 * FOREARM * plant.arm),
            PLATE + 1.5 * FOREARM,
            PLATE + 1.5 * FOREARM,
        ];
        let (q, qd, qdd) = ([0.3, -0.2, 0.9], [2.0, -3.0, 1.0], [10.0, 20.0, -15.0]);
        let mut rows = [0.0; 12];
        model.rows(&q, &qd, &qdd, &mut rows).expect("within reach");
        let torque = plant.torque(&q, &qd, &qdd);
        for (i, row) in rows.chunks_exact(4).enumerate() {
            let expected: f64 = row.iter().zip(parameters).map(|(y, p)| y * p).sum();
            assert!(
                (torque[i] - expected).abs() < 1e-6 * expected.abs().max(1.0),
                "{torque:?} {expected}"
            );
        }
    }
}
