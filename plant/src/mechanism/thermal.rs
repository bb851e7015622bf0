//! Grease that warms up.

use super::{Instant, Mechanism, soft_sign};

/// Extra friction of cold grease, which fades as dissipation heats the gear: with the relative temperature θ
/// (1 at the steady state of the given mean power), time·dθ/dt = P/P̄ − θ and an extra friction of
/// `cold`·exp(−`fading` θ) times the warm one.
#[derive(Debug, Clone)]
pub struct WarmingGrease {
    /// Index of the plant's joint on which the mechanism acts.
    pub joint: usize,
    /// Ratio of the cold gear's extra friction to the warm gear's friction.
    pub cold: f64,
    /// Exponent of viscosity at θ = 1.
    pub fading: f64,
    /// Thermal time constant, s.
    pub time: f64,
    /// Mean dissipated power P̄, W.
    pub power: f64,
    /// Warm viscous friction, N·m·s/rad.
    pub viscous: f64,
    /// Warm Coulomb friction that warms along, N·m.
    pub coulomb: f64,
    /// Speed over which the sign of velocity is softened, rad/s.
    pub v_eps: f64,
    /// Relative temperature θ, 1 at the steady state.
    pub warmth: f64,
}

impl WarmingGrease {
    fn warm(&self, v: f64) -> f64 {
        self.viscous * v + self.coulomb * soft_sign(v, self.v_eps)
    }
}

impl Mechanism for WarmingGrease {
    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    fn resist(&self, _now: &Instant, v: f64) -> f64 {
        self.cold * (-self.fading * self.warmth).exp() * self.warm(v)
    }

    fn advance(&mut self, now: &Instant, v: &[f64]) {
        let power = self.warm(v[self.joint]) * v[self.joint];
        self.warmth += (power / self.power - self.warmth) * now.dt / self.time;
    }

    fn warmth(&self) -> Option<f64> {
        Some(self.warmth)
    }
}
