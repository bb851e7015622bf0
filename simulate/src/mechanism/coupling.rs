//! One joint's motion dragging at another's transmission.

use super::{Instant, Mechanism, soft_sign};

/// What the shared part is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CouplingKind {
    /// A shaft of the driver turning in the driven joint's oil.
    Viscous,
    /// A seal between both, slipping by the difference of their speeds (driven turns this many times per turn of
    /// the driver).
    Seal(f64),
    /// A wheel of the driver's gear train held in the driven joint.
    Wheel,
}

/// Torque on the driven joint by the motion of another.
#[derive(Debug, Clone)]
pub struct Coupling {
    /// Plant joint whose motion drives.
    pub driver: usize,
    /// Plant joint whose torque changes.
    pub driven: usize,
    /// N·m·s/rad, N·m, or kg·m².
    pub size: f64,
    /// Softening of the sign, rad/s.
    pub v_eps: f64,
    /// Kind.
    pub kind: CouplingKind,
}

impl Mechanism for Coupling {
    fn push(&mut self, now: &Instant, force: &mut [f64]) {
        let torque = match self.kind {
            CouplingKind::Viscous => now.v[self.driver],
            CouplingKind::Seal(ratio) => {
                let slip = now.v[self.driver] + ratio * now.v[self.driven];
                soft_sign(slip, 20.0 * self.v_eps)
            }
            CouplingKind::Wheel => now.a[self.driver],
        };
        force[self.driven] -= self.size * torque;
    }
}
