//! Softened sign of velocity for dry friction near rest.

/// Sign of `v`, softened below `eps`: v/√(v² + ε²), which comes to rest more slowly than the hyperbolic tangent of
/// identification and diagnosis.
pub fn soft_sign(v: f64, eps: f64) -> f64 {
    v / v.hypot(eps)
}

/// A law by which a joint's Coulomb friction comes to rest, over x = v/ε. All grow from 0 to 1 with a slope that falls with
/// speed, as [`crate::integrate::Plant`] needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum RestLaw {
    /// Law x/√(1 + x²), as [`soft_sign`].
    #[default]
    Root,
    /// Law (2/π) arctan(πx/2): the slowest to reach 1.
    Arctangent,
    /// Exponential law: 1 − exp(−x).
    Exponential,
    /// Linear law: x up to 1, then 1.
    Ramp,
}

impl RestLaw {
    /// All laws, in the order of the enum.
    pub const ALL: [Self; 4] = [Self::Root, Self::Arctangent, Self::Exponential, Self::Ramp];

    /// Softened sign of the velocity `v`.
    pub fn sign(self, v: f64, eps: f64) -> f64 {
        match self {
            Self::Root => soft_sign(v, eps),
            Self::Arctangent => {
                (std::f64::consts::FRAC_PI_2 * v / eps).atan() * std::f64::consts::FRAC_2_PI
            }
            Self::Exponential => -(-v.abs() / eps).exp_m1() * v.signum(),
            Self::Ramp => (v / eps).clamp(-1.0, 1.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_law_is_an_odd_step_whose_slope_falls() {
        for law in RestLaw::ALL {
            let at = |x: f64| law.sign(x * 0.01, 0.01);
            assert_eq!(at(0.0), 0.0, "{law:?}");
            assert!((at(300.0) - 1.0).abs() < 3e-3, "{law:?}");
            for k in 1..40 {
                let x = 0.2 * f64::from(k);
                assert!((at(x) + at(-x)).abs() < 1e-15, "{law:?}");
                let (before, after) = (at(x) - at(x - 0.2), at(x + 0.2) - at(x));
                assert!(after >= -1e-12 && after <= before + 1e-12, "{law:?} at {x}");
            }
        }
    }
}
