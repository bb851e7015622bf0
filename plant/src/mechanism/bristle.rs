//! Presliding as the bending of bristles.

use super::{Instant, Mechanism};

/// Elasto-plastic bristle friction (Dupont, Hayward, Armstrong and Altpeter, 2002): the bristles' mean deflection
/// z follows ż = v (1 − α(z, v) sign(v) z/z_s), α = 0 while they only bend and 1 when all slide, and the torque is
/// σ₀ z + σ₁ ż with σ₀ = coulomb/z_s. It carries the joint's whole Coulomb friction.
#[derive(Debug, Clone)]
pub struct Bristle {
    /// Index of the plant's joint on which the mechanism acts.
    pub joint: usize,
    /// Friction when sliding, N·m.
    pub coulomb: f64,
    /// Deflection when sliding, rad.
    pub deflection: f64,
    /// Part of that deflection that is purely elastic, 0 to 1.
    pub elastic: f64,
    /// Micro-damping σ₁, N·m·s/rad.
    pub damping: f64,
    /// Mean deflection z of the bristles, rad.
    pub z: f64,
}

impl Bristle {
    /// Deflection at the end of a step that ended at velocity `v`, implicit in z.
    fn bent(&self, dt: f64, v: f64) -> f64 {
        let x = self.z / self.deflection;
        let sliding = if x * v <= 0.0 || x.abs() <= self.elastic {
            0.0
        } else {
            let u = ((x.abs() - self.elastic) / (1.0 - self.elastic)).min(1.0);
            0.5 - 0.5 * (std::f64::consts::PI * u).cos()
        };
        let z = (self.z + dt * v) / (1.0 + dt * sliding * v.abs() / self.deflection);
        // A step may be longer than the bristles: they slide then.
        z.clamp(-self.deflection, self.deflection)
    }
}

impl Mechanism for Bristle {
    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    fn resist(&self, now: &Instant, v: f64) -> f64 {
        let z = self.bent(now.dt, v);
        self.coulomb * z / self.deflection + self.damping * (z - self.z) / now.dt
    }

    fn advance(&mut self, now: &Instant, v: &[f64]) {
        self.z = self.bent(now.dt, v[self.joint]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pull(b: &mut Bristle, v: f64, seconds: f64) -> f64 {
        let dt = 5e-4;
        let zero = [0.0];
        let now = Instant {
            t: 0.0,
            dt,
            q: &zero,
            v: &zero,
            a: &zero,
            load: &zero,
        };
        let mut torque = 0.0;
        for _ in 0..(seconds / dt) as usize {
            torque = b.resist(&now, v);
            b.advance(&now, &[v]);
        }
        torque
    }

    #[test]
    fn slides_at_coulomb_friction_and_remembers_its_reversal() {
        let mut b = Bristle {
            joint: 0,
            coulomb: 3.0,
            deflection: 0.01,
            elastic: 0.4,
            damping: 0.0,
            z: 0.0,
        };
        assert!((pull(&mut b, 0.1, 1.0) - 3.0).abs() < 1e-3);
        // Half a deflection back, far below the elastic limit: 3 (1 − 0.5) N·m, at any speed.
        let mut slow = b.clone();
        assert!((pull(&mut b, -0.1, 0.05) - 1.5).abs() < 0.02);
        assert!((pull(&mut slow, -0.01, 0.5) - 1.5).abs() < 0.02);
    }
}
