//! Memory in time: the direction of motion through a first-order lag.

use serde::{Deserialize, Serialize};

/// z follows sign(q̇) with a time constant and keeps its value while the joint stands still.
///
/// Describes friction lag and slow creep after a reversal, which a function of displacement alone does not describe.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LaggedSign {
    /// Time constant of the lag, s.
    pub time_constant: f64,
    /// Velocity below which the joint counts as standing still, rad/s (m/s).
    pub standstill: f64,
}

impl LaggedSign {
    /// State after `dt` seconds at velocity `qd`.
    pub fn next(&self, z: f64, qd: f64, dt: f64) -> f64 {
        if qd.abs() <= self.standstill {
            return z;
        }
        let end = super::sliding::sign(qd);
        end + (z - end) * (-dt / self.time_constant).exp()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keeps_its_value_at_rest_and_follows_in_motion() {
        let lag = LaggedSign {
            time_constant: 0.5,
            standstill: 1e-3,
        };
        assert_eq!(lag.next(0.3, 0.0, 10.0), 0.3);
        // 1 + (0 − 1)·e⁻¹
        assert!((lag.next(0.0, 0.2, 0.5) - 0.632_120_558_828_557_7).abs() < 1e-15);
    }
}
