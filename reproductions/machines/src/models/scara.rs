//! SCARA: two parallel rotating axes, a sliding one, and a rotating one about the same line.

use super::rotary_axis::GRAVITY;
use super::{OutOfReach, Parameter, TorqueModel};
use std::f64::consts::TAU;

/// SCARA with three axes (XYZ) or four (XYZR); all rotations about the vertical.
///
/// Lagrange's equations with the angles q₁, q₂ of the arms (lengths a₁, a₂), the quill's height and its rotation q₄, and
/// w = q̈₁ + q̈₂ (+ q̈₄):
/// - τ₁ = J₁ q̈₁ + J₂ (q̈₁ + q̈₂) + K {cos q₂ (2 q̈₁ + q̈₂) − sin q₂ (q̇₂² + 2 q̇₁ q̇₂)} + J₄ w
/// - τ₂ = J₂ (q̈₁ + q̈₂) + K {cos q₂ q̈₁ + sin q₂ q̇₁²} + J₄ w + I₂ q̈₂
/// - F₃ = M q̈₃ + F_g
/// - τ₄ = J₄ w + I₄ q̈₄
///
/// J₁, J₂ hold arms, quill and the rotor of axis 1; K = a₁ (m₂ c₂ + m_q a₂); I₂, I₄ are rotors seen from their axes, M
/// quill and rotor; F_g is what gravity and a balance leave. Eight parameters with four axes, the number that the
/// manual lists.
///
/// **Coupled axes** (model 2; the manual leaves them out and warns of their errors): nut and spline of one spindle, so that
/// turning axis 4 alone lifts the quill by −c q₄. With the drives' positions q₃, q₄ its height is q₃ − c q₄, and by virtual
/// work axis 4 carries −c times the force on the screw:
/// - F₃ = M q̈₃ + B q̈₄ + F_g, B = −c m_q
/// - τ₄ = J₄ w + I₄' q̈₄ + B q̈₃ + D, I₄' = I₄ + c² m_q, D = −c F_g
///
/// linear in ten parameters; the pitch is identified (c = −D/F_g) and needs no input.
#[derive(Debug, Clone, PartialEq)]
pub struct Scara {
    rotates: bool,
    coupled: bool,
}

impl Scara {
    /// With 3 or 4 axes, model 1 or 2; three axes have nothing to couple.
    pub fn new(axes: usize, number: usize) -> Self {
        Self {
            rotates: axes == 4,
            coupled: axes == 4 && number == 2,
        }
    }
}

impl TorqueModel for Scara {
    fn parameters(&self) -> Vec<Parameter> {
        let mut list = vec![
            Parameter::new("inertia_1", "kg·m²"),
            Parameter::new("inertia_2", "kg·m²"),
            Parameter::new("product", "kg·m²"),
            Parameter::new("rotor_2", "kg·m²"),
            Parameter::new("mass_3", "kg"),
            Parameter::new("gravity_3", "N"),
        ];
        if self.rotates {
            list.push(Parameter::new("inertia_4", "kg·m²"));
            list.push(Parameter::new("rotor_4", "kg·m²"));
        }
        if self.coupled {
            list.push(Parameter::new("coupled_mass", "kg·m"));
            list.push(Parameter::new("coupled_gravity", "N·m"));
        }
        list
    }

    fn rows(&self, q: &[f64], qd: &[f64], qdd: &[f64], rows: &mut [f64]) -> Result<(), OutOfReach> {
        let width = 6 + 2 * usize::from(self.rotates) + 2 * usize::from(self.coupled);
        rows.fill(0.0);
        let (sin, cos) = q[1].sin_cos();
        let mut set = |axis: usize, column: usize, value: f64| rows[axis * width + column] = value;
        set(0, 0, qdd[0]);
        for axis in 0..2 {
            set(axis, 1, qdd[0] + qdd[1]);
        }
        let swing = 2.0 * qdd[0] + qdd[1];
        set(
            0,
            2,
            cos * swing - sin * (qd[1] * qd[1] + 2.0 * qd[0] * qd[1]),
        );
        set(1, 2, cos * qdd[0] + sin * qd[0] * qd[0]);
        set(1, 3, qdd[1]);
        set(2, 4, qdd[2]);
        set(2, 5, 1.0);
        if self.rotates {
            for axis in [0, 1, 3] {
                set(axis, 6, qdd[0] + qdd[1] + qdd[3]);
            }
            set(3, 7, qdd[3]);
        }
        if self.coupled {
            set(2, 8, qdd[3]);
            set(3, 8, qdd[2]);
            set(3, 9, 1.0);
        }
        Ok(())
    }

    fn derived(&self, values: &[f64]) -> Vec<(String, f64, String)> {
        if !self.coupled || values[5] == 0.0 {
            return Vec::new();
        }
        let lift = -values[9] / values[5];
        vec![(
            "lift of the quill by one turn of axis 4".into(),
            -TAU * lift,
            "m".into(),
        )]
    }

    /// Mass and, with four axes, inertia of a body whose centre is on the quill's line, and what it adds to the arms: a₁² m, a₂² m and
    /// a₁ a₂ m, whose lengths no description has.
    fn payload(&self, values: &[f64]) -> Vec<(Parameter, Vec<f64>)> {
        let width = self.parameters().len();
        let column = |entries: &[(usize, f64)]| {
            let mut column = vec![0.0; width];
            entries.iter().for_each(|&(k, v)| column[k] = v);
            column
        };
        let mut mass = vec![(4, 1.0), (5, GRAVITY)];
        if self.coupled && values[5] != 0.0 {
            let lift = -values[9] / values[5];
            mass.extend([(8, -lift), (9, -lift * GRAVITY)]);
            mass.push((7, lift * lift));
        }
        let mut all = vec![
            (Parameter::new("mass", "kg"), column(&mass)),
            (Parameter::new("inertia_1", "kg·m²"), column(&[(0, 1.0)])),
            (Parameter::new("inertia_2", "kg·m²"), column(&[(1, 1.0)])),
            (Parameter::new("product", "kg·m²"), column(&[(2, 1.0)])),
        ];
        if self.rotates {
            all.push((Parameter::new("inertia_4", "kg·m²"), column(&[(6, 1.0)])));
        }
        all
    }

    fn positive(&self) -> Vec<usize> {
        vec![0, 1, 4]
    }
}
