//! One sliding axis.

use super::rotary_axis::GRAVITY;
use super::{OutOfReach, Parameter, TorqueModel};

/// Linear axis (manual: dynamic models 1 and 2).
///
/// 1. Horizontal: F = m q̈.
/// 2. Tilted or vertical: F = m q̈ + F_g, with F_g = m g cos α for an axis at the angle α from the vertical that counts
///    upwards. The angle follows from both and is no input.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearAxis {
    tilted: bool,
}

impl LinearAxis {
    /// Model 1 or 2.
    pub fn new(number: usize) -> Self {
        Self {
            tilted: number == 2,
        }
    }
}

impl TorqueModel for LinearAxis {
    fn parameters(&self) -> Vec<Parameter> {
        let mut list = vec![Parameter::new("mass", "kg")];
        if self.tilted {
            list.push(Parameter::new("gravity", "N"));
        }
        list
    }

    fn rows(
        &self,
        _q: &[f64],
        _qd: &[f64],
        qdd: &[f64],
        rows: &mut [f64],
    ) -> Result<(), OutOfReach> {
        rows[0] = qdd[0];
        if self.tilted {
            rows[1] = 1.0;
        }
        Ok(())
    }

    /// Mass; force of gravity; force of gravity per mass.
    fn numbered(&self, values: &[f64]) -> Vec<f64> {
        if self.tilted {
            vec![values[0], values[1], values[1] / values[0]]
        } else {
            values.to_vec()
        }
    }

    /// The angle from the vertical; none where gravity pulls harder than the mass weighs.
    fn derived(&self, values: &[f64]) -> Vec<(String, f64, String)> {
        if !self.tilted {
            return Vec::new();
        }
        let cosine = values[1] / (values[0] * GRAVITY);
        // A vertical axis lies at 1 within the estimate's error.
        if cosine.is_nan() || cosine.abs() > 1.05 {
            return Vec::new();
        }
        let angle = cosine.clamp(-1.0, 1.0).acos().to_degrees();
        vec![("angle from the vertical".into(), angle, "°".into())]
    }

    /// Its mass, which weighs as much of itself along the axis as the carriage does.
    fn payload(&self, values: &[f64]) -> Vec<(Parameter, Vec<f64>)> {
        let mut column = vec![1.0];
        if self.tilted {
            column.push(values[1] / values[0]);
        }
        vec![(Parameter::new("mass", "kg"), column)]
    }

    fn positive(&self) -> Vec<usize> {
        vec![0]
    }
}
