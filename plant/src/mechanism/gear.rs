//! Gears: meshing losses, and a gear that winds up.

use super::{Instant, Mechanism, soft_sign};

/// Loss of a gear of a given efficiency: to deliver a load it needs 1/η of it when driving, and passes on only η
/// of it when driven back.
#[derive(Debug, Clone)]
pub struct GearMesh {
    /// Index of the plant's joint on which the mechanism acts.
    pub joint: usize,
    /// Share 1 − η of the load that the gear loses.
    pub loss: f64,
    /// Speed over which the sign of velocity is softened, rad/s.
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

/// Elastic gear between a rotor and its link: a spring that hardens, with damping, on the joint that
/// [`crate::arm::Arm::split_joint`] adds.
#[derive(Debug, Clone)]
pub struct GearSpring {
    /// Plant joint of the gear's deflection.
    pub joint: usize,
    /// Stiffness of the spring at rest, N·m/rad.
    pub stiffness: f64,
    /// Deflection at which stiffness has doubled, rad.
    pub hardening: f64,
    /// Damping of the spring, N·m·s/rad.
    pub damping: f64,
}

impl Mechanism for GearSpring {
    fn push(&mut self, now: &Instant, force: &mut [f64]) {
        let x = now.q[self.joint];
        let y = x / self.hardening;
        force[self.joint] -= self.stiffness * x * (1.0 + y * y / 3.0);
    }

    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    fn resist(&self, _now: &Instant, v: f64) -> f64 {
        self.damping * v
    }
}
