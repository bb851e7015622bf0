//! One rotating axis.

use super::{OutOfReach, Parameter, TorqueModel};

/// Gravity that the manual states for its axes, m/s².
pub const GRAVITY: f64 = 9.806_65;

/// Rotary axis (manual: dynamic models 1 to 3).
///
/// 1. Simple, centre of mass on the axis: τ = J q̈.
/// 2. Horizontal crank arm: the same; the crank's length tells what a payload adds.
/// 3. Vertical crank arm: τ = J q̈ + G_c cos q + G_s sin q. With the zero at the horizontal G_c is the moment of gravity m g r and
///    G_s is zero; both are identified, so the zero may be anywhere.
///
/// Square and length of the crank act through a payload alone and come from the geometry.
#[derive(Debug, Clone, PartialEq)]
pub struct RotaryAxis {
    number: usize,
    crank: Option<f64>,
}

impl RotaryAxis {
    /// Model 1 to 3 with the crank's length in m.
    pub fn new(number: usize, crank: Option<f64>) -> Self {
        Self { number, crank }
    }

    fn vertical(&self) -> bool {
        self.number == 3
    }
}

impl TorqueModel for RotaryAxis {
    fn parameters(&self) -> Vec<Parameter> {
        let mut list = vec![Parameter::new("inertia", "kg·m²")];
        if self.vertical() {
            list.push(Parameter::new("gravity_cos", "N·m"));
            list.push(Parameter::new("gravity_sin", "N·m"));
        }
        list
    }

    fn rows(
        &self,
        q: &[f64],
        _qd: &[f64],
        qdd: &[f64],
        rows: &mut [f64],
    ) -> Result<(), OutOfReach> {
        rows[0] = qdd[0];
        if self.vertical() {
            (rows[2], rows[1]) = q[0].sin_cos();
        }
        Ok(())
    }

    /// Inertia; crank²; m g r; g · crank.
    fn numbered(&self, values: &[f64]) -> Vec<f64> {
        let crank = self.crank.unwrap_or(0.0);
        match self.number {
            1 => vec![values[0]],
            2 => vec![values[0], crank * crank],
            _ => vec![values[0], crank * crank, values[1], GRAVITY * crank],
        }
    }

    fn derived(&self, values: &[f64]) -> Vec<(String, f64, String)> {
        if !self.vertical() {
            return Vec::new();
        }
        let moment = values[1].hypot(values[2]);
        let level = values[2].atan2(values[1]);
        vec![
            ("moment of gravity".into(), moment, "N·m".into()),
            (
                "position at which the crank is level".into(),
                level,
                "rad".into(),
            ),
        ]
    }

    /// A mass at the end of the crank, level at zero; without a crank's length inertia and first moments about the axis.
    fn payload(&self, _values: &[f64]) -> Vec<(Parameter, Vec<f64>)> {
        let upright = |inertia: f64, along: f64, across: f64| {
            if self.vertical() {
                vec![inertia, GRAVITY * along, -GRAVITY * across]
            } else {
                vec![inertia]
            }
        };
        let mass = |r: f64| (Parameter::new("mass", "kg"), upright(r * r, r, 0.0));
        match self.crank.filter(|r| *r > 0.0 && self.number > 1) {
            Some(r) => vec![mass(r)],
            None if self.vertical() => vec![
                (Parameter::new("inertia", "kg·m²"), upright(1.0, 0.0, 0.0)),
                (Parameter::new("mx", "kg·m"), upright(0.0, 1.0, 0.0)),
                (Parameter::new("my", "kg·m"), upright(0.0, 0.0, 1.0)),
            ],
            None => vec![(Parameter::new("inertia", "kg·m²"), upright(1.0, 0.0, 0.0))],
        }
    }

    fn positive(&self) -> Vec<usize> {
        vec![0]
    }
}
