//! Delta: three arms whose forearms carry one plate, which they hold level.

mod kinematics;

pub use kinematics::{Pose, Shape};

use super::{OutOfReach, Parameter, TorqueModel};
use nalgebra::Vector3;

/// Gravity, m/s²; downwards along −z.
const GRAVITY: f64 = 9.81;

/// Delta with three axes (XYZ) or four (XYZR: a shaft turns a tool on the plate).
///
/// By virtual work, with x the plate's position, e_i the elbows and J = ∂x/∂q:
/// - arms: τ_i = J_a q̈_i − G_a cos q_i (positive q lowers the arm; zero is level)
/// - plate: τ = Jᵀ m (ẍ + g ẑ)
/// - forearms as thin rods of mass m_f each: their kinetic energy m_f/6 (ė² + ė·ẋ + ẋ²) puts a third of their mass each to
///   elbow and plate, half by weight, and leaves m_f/6 Σ ė_i·ẋ, of which τ_i = m_f/6 {(∂e_i/∂q_i)·ẍ + (∂x/∂q_i)·Σ_k ë_k}.
///
/// Model 1 (the manual's kind: arm inertia, arm moment, plate mass first in its list) leaves the last term out; model 2
/// has it with `forearm_mass` m_f beside J_a, G_a and m, which hold the rest of the rods' inertia. The weight of the rods acts half
/// each, their inertia a third each: `plate_weight` m_w is a parameter of its own, and differs from `plate_mass` by m_f/2.
/// - shaft: τ₄ = J₄ q̈₄.
#[derive(Debug, Clone, PartialEq)]
pub struct Delta {
    shape: Shape,
    rotates: bool,
    rods: bool,
}

impl Delta {
    /// With 3 or 4 axes, model 1 or 2.
    pub fn new(shape: Shape, axes: usize, number: usize) -> Self {
        Self {
            shape,
            rotates: axes == 4,
            rods: number == 2,
        }
    }

    fn width(&self) -> usize {
        4 + usize::from(self.rods) + usize::from(self.rotates)
    }
}

impl TorqueModel for Delta {
    fn parameters(&self) -> Vec<Parameter> {
        let mut list = vec![
            Parameter::new("arm_inertia", "kg·m²"),
            Parameter::new("arm_moment", "N·m"),
            Parameter::new("plate_mass", "kg"),
            Parameter::new("plate_weight", "kg"),
        ];
        if self.rods {
            list.push(Parameter::new("forearm_mass", "kg"));
        }
        if self.rotates {
            list.push(Parameter::new("inertia_4", "kg·m²"));
        }
        list
    }

    fn rows(&self, q: &[f64], qd: &[f64], qdd: &[f64], rows: &mut [f64]) -> Result<(), OutOfReach> {
        let width = self.width();
        rows.fill(0.0);
        let arms = |all: &[f64]| [all[0], all[1], all[2]];
        let pose = self.shape.pose(arms(q)).ok_or(OutOfReach)?;
        let state = pose.moving(arms(qd), arms(qdd));
        let elbows: Vector3<f64> = state.elbow_acceleration.iter().sum();
        for i in 0..3 {
            let row = &mut rows[i * width..][..width];
            let column = pose.jacobian.column(i);
            row[0] = qdd[i];
            row[1] = -q[i].cos();
            row[2] = column.dot(&state.acceleration);
            row[3] = GRAVITY * column.z;
            if self.rods {
                let cross = pose.elbow_slope[i].dot(&state.acceleration) + column.dot(&elbows);
                row[4] = cross / 6.0;
            }
        }
        if self.rotates {
            rows[3 * width + width - 1] = qdd[3];
        }
        Ok(())
    }

    /// Mass on the plate, which stays level, and with four axes inertia on the shaft.
    fn payload(&self, _values: &[f64]) -> Vec<(Parameter, Vec<f64>)> {
        let width = self.width();
        let mut mass = vec![0.0; width];
        mass[2..4].fill(1.0);
        let mut all = vec![(Parameter::new("mass", "kg"), mass)];
        if self.rotates {
            let mut shaft = vec![0.0; width];
            shaft[width - 1] = 1.0;
            all.push((Parameter::new("inertia_4", "kg·m²"), shaft));
        }
        all
    }

    fn positive(&self) -> Vec<usize> {
        vec![0, 2]
    }
}

#[cfg(test)]
mod tests;
