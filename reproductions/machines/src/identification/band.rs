//! Speeds of an axis that count as motion.

use serde::{Deserialize, Serialize};

/// Speeds that count as motion.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Band {
    /// Lowest speed, rad/s or m/s.
    pub lower: f64,
    /// Highest speed; none but for the semi-static model.
    pub upper: Option<f64>,
}

impl Band {
    /// Whether a velocity counts.
    pub fn holds(&self, velocity: f64) -> bool {
        let speed = velocity.abs();
        speed >= self.lower && self.upper.is_none_or(|upper| speed <= upper)
    }
}
