//! Gears: meshing losses.

use super::{Instant, Mechanism, soft_sign};

/// Loss of a gear of a given efficiency: to deliver a load it needs 1/η of it when driving, and passes on only η
/// of it when driven back.
#[derive(Debug, Clone)]
pub struct GearMesh {
    /// Plant joint.
    pub joint: usize,
    /// Lost share 1 − η.
    pub loss: f64,
    /// Softening of the sign, rad/s.
    pub v_eps: f64,
}

impl Mechanism for GearMesh {
    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    fn resist(&self, now: &Instant, v: f64) -> f64 {
        let load = now.load[self.joint];
        let lost = if load * v > 0.0 {
            self.loss / (1.0 - self.loss)
        } else {
            self.loss
        };
        lost * load.abs() * soft_sign(v, self.v_eps)
    }
}
