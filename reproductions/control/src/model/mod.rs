//! What a controller knows of its robot's torque.

mod directory;
mod identified;
mod nominal;

pub use directory::DirectoryModel;
pub use identified::IdentifiedMachine;
pub use nominal::Nominal;

use plant::reference::Command;

/// A torque model in a control loop. All slices have N values, SI.
pub trait Model {
    /// Number of joints, N.
    fn dof(&self) -> usize;

    /// Torque of what has no friction: bodies, rotors, counterbalance, offsets.
    fn rigid(&mut self, q: &[f64], qd: &[f64], qdd: &[f64], tau: &mut [f64]);

    /// Torque of the physics, friction and its memory included, for the motion of the next control period.
    fn physics(&mut self, motion: &Command, tau: &mut [f64]);

    /// Torque of physics and compensator for the motion of the next control period.
    fn compensated(&mut self, motion: &Command, tau: &mut [f64]);

    /// Whether there is a compensator.
    fn has_compensator(&self) -> bool;

    /// Forgets what it remembers of motion.
    fn reset(&mut self);

    /// Generalised momentum M(q)·`qd`.
    fn momentum(&mut self, q: &[f64], qd: &[f64], momentum: &mut [f64]) {
        let still = vec![0.0; self.dof()];
        let mut held = still.clone();
        self.rigid(q, &still, &still, &mut held);
        self.rigid(q, &still, qd, momentum);
        momentum.iter_mut().zip(held).for_each(|(p, h)| *p -= h);
    }

    /// Diagonal of M(q): each joint's inertia with all others held, kg·m² or kg.
    fn inertia(&mut self, q: &[f64]) -> Vec<f64> {
        let n = self.dof();
        let (mut unit, mut momentum) = (vec![0.0; n], vec![0.0; n]);
        let mut diagonal = Vec::with_capacity(n);
        for j in 0..n {
            unit[j] = 1.0;
            self.momentum(q, &unit, &mut momentum);
            diagonal.push(momentum[j]);
            unit[j] = 0.0;
        }
        diagonal
    }
}
