//! Torque periodic in a joint's position.

use super::{Instant, Mechanism};

/// Cogging and meshing: Σ A sin(n q + φ) with orders n that need not be whole numbers of each other, for a motor's
/// poles and a gear's teeth turn at their own ratios.
#[derive(Debug, Clone)]
pub struct Ripple {
    /// Index of the plant's joint on which the mechanism acts.
    pub joint: usize,
    /// Order (cycles per turn of the joint; rad⁻¹), amplitude (N·m) and phase (rad) of each wave.
    pub waves: Vec<[f64; 3]>,
}

impl Mechanism for Ripple {
    fn push(&mut self, now: &Instant, force: &mut [f64]) {
        let q = now.q[self.joint];
        let waves = self
            .waves
            .iter()
            .map(|[n, a, phase]| a * (n * q + phase).sin());
        force[self.joint] -= waves.sum::<f64>();
    }
}
