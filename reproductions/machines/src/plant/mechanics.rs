//! What a simulated machine is.

/// Friction of one axis of a plant: viscous · q̇ + coulomb · q̇ / √(q̇² + soft²).
#[derive(Debug, Clone, Copy)]
pub struct Friction {
    /// N·m·s/rad or N·s/m.
    pub viscous: f64,
    /// N·m or N.
    pub coulomb: f64,
    /// Speed over which the sign turns, rad/s or m/s.
    pub soft: f64,
}

impl Friction {
    /// Torque or force at a velocity.
    pub fn torque(self, velocity: f64) -> f64 {
        let sign = velocity / velocity.hypot(self.soft);
        self.viscous * velocity + self.coulomb * sign
    }
}

/// A machine's "real" torque.
pub trait Plant: Send {
    /// Torque of every axis without friction, at position, velocity and acceleration.
    fn torque(&self, q: &[f64], qd: &[f64], qdd: &[f64]) -> Vec<f64>;

    /// Friction of every axis.
    fn friction(&self) -> Vec<Friction>;
}
