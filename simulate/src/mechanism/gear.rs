//! Gears: meshing losses, wind-up, play.

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

/// Elastic gear between a rotor and its link: a spring that hardens, with damping, on the joint that
/// [`crate::arm::Arm::split_joint`] adds.
#[derive(Debug, Clone)]
pub struct GearSpring {
    /// Plant joint of the gear's deflection.
    pub joint: usize,
    /// N·m/rad.
    pub stiffness: f64,
    /// Deflection at which stiffness has doubled, rad.
    pub hardening: f64,
    /// N·m·s/rad.
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

/// Play between a rotor and its link: stiff flanks with damping, and nothing between them.
#[derive(Debug, Clone)]
pub struct GearPlay {
    /// Plant joint of the gear's deflection.
    pub joint: usize,
    /// Half of the play, rad.
    pub half: f64,
    /// Stiffness of a flank, N·m/rad.
    pub stiffness: f64,
    /// Damping of a flank in contact, N·m·s/rad.
    pub damping: f64,
    /// Damping of the grease between the flanks, N·m·s/rad.
    pub grease: f64,
}

impl GearPlay {
    fn depth(&self, x: f64) -> f64 {
        x - x.clamp(-self.half, self.half)
    }
}

impl Mechanism for GearPlay {
    fn push(&mut self, now: &Instant, force: &mut [f64]) {
        force[self.joint] -= self.stiffness * self.depth(now.q[self.joint]);
    }

    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    fn resist(&self, now: &Instant, v: f64) -> f64 {
        let touching = self.depth(now.q[self.joint]) != 0.0;
        v * if touching { self.damping } else { self.grease }
    }
}
