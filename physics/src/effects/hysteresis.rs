//! Presliding: friction with memory of displacement, independent of rate.
//!
//! Both operators have one state z in [−1, 1] that runs on through standstill and, on one clock,
//! from one trajectory to the next: at rest a joint keeps the friction torque it arrived with.

use serde::{Deserialize, Serialize};

/// Stop operator (one Maxwell-slip element): z ← clip(z + Δq/width, −1, 1).
///
/// Al-Bender, Lampaert and Swevers (2005), "The generalized Maxwell-slip model".
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stop {
    /// Displacement from rest to sliding, rad (m for prismatic joints).
    pub width: f64,
}

impl Stop {
    /// State after a displacement `dq`.
    pub fn next(&self, z: f64, dq: f64) -> f64 {
        (z + dq / self.width).clamp(-1.0, 1.0)
    }
}

/// Dahl's friction: dz/dq = stiffness·(1 − z·sign(q̇)), integrated exactly over each step.
///
/// P. R. Dahl (1968), "A solid friction model".
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Dahl {
    /// Relative stiffness at zero torque, 1/rad (1/m for prismatic joints).
    pub stiffness: f64,
}

impl Dahl {
    /// State after a displacement `dq`.
    pub fn next(&self, z: f64, dq: f64) -> f64 {
        let end = super::sliding::sign(dq);
        end + (z - end) * (-self.stiffness * dq.abs()).exp()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn dahl_by_hand() {
        // From rest, 1e-4 rad at 1e4 1/rad: 1 − e⁻¹.
        let z = Dahl { stiffness: 1e4 }.next(0.0, 1e-4);
        assert!((z - 0.632_120_558_828_557_7).abs() < 1e-15);
    }

    proptest! {
        #[test]
        fn states_are_bounded_and_rate_independent(steps in prop::collection::vec(-0.01..0.01f64, 1..50), z0 in -1.0..1.0f64) {
            let (stop, dahl) = (Stop { width: 0.003 }, Dahl { stiffness: 500.0 });
            let (mut a, mut b, mut a2, mut b2) = (z0, z0, z0, z0);
            for dq in steps {
                a = stop.next(a, dq);
                b = dahl.next(b, dq);
                for _ in 0..4 {
                    a2 = stop.next(a2, dq / 4.0);
                    b2 = dahl.next(b2, dq / 4.0);
                }
                prop_assert!(a.abs() <= 1.0 && b.abs() <= 1.0);
                prop_assert!((a - a2).abs() < 1e-9 && (b - b2).abs() < 1e-9);
            }
        }
    }
}
