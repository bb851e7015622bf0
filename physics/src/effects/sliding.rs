//! Friction of a sliding contact: a function of the joint's present velocity alone.

use serde::{Deserialize, Serialize};

/// Shape of sliding friction over velocity; `velocity` is in rad/s (m/s for prismatic joints).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Sliding {
    /// q̇: viscous friction.
    Viscous,
    /// sign(q̇): Coulomb friction, not smoothed; the column is filtered like the torque instead.
    Coulomb,
    /// tanh(q̇/velocity): Coulomb friction as a low-passed velocity or a drive at rest shows it.
    SoftCoulomb {
        /// Velocity over which the sign changes, rad/s (m/s).
        velocity: f64,
    },
    /// |q̇|: the difference of viscous friction between the two directions.
    AsymmetricViscous,
    /// sign(q̇)·exp(−|q̇|/velocity): Stribeck friction, Tustin's form.
    Stribeck {
        /// Velocity at which the extra friction has fallen to 1/e, rad/s (m/s).
        velocity: f64,
    },
    /// tanh(q̇/softness)·exp(−(|q̇|/velocity)^exponent): Stribeck friction of any steepness, its sign softened as that of
    /// [`Sliding::SoftCoulomb`] (Bo and Pavelescu 1982).
    SoftStribeck {
        /// Velocity at which the extra friction has fallen to 1/e, rad/s (m/s).
        velocity: f64,
        /// Exponent of the decay: one is Tustin's form, two is Gauss's.
        exponent: f64,
        /// Velocity over which the sign changes, rad/s (m/s).
        softness: f64,
    },
    /// tanh²(q̇/velocity): the difference of Coulomb friction between the two directions.
    AsymmetricCoulomb {
        /// Velocity over which the sign changes, rad/s (m/s).
        velocity: f64,
    },
    /// tanh(q̇/velocity): viscous friction that saturates.
    Degressive {
        /// Velocity of the knee, rad/s (m/s).
        velocity: f64,
    },
    /// sign(q̇)·|q̇|^exponent (Han et al., equation 5).
    Power {
        /// Exponent α of the speed |q̇|.
        exponent: f64,
    },
}

impl Sliding {
    /// Torque at velocity `qd` for a parameter of one.
    pub fn at(&self, qd: f64) -> f64 {
        match *self {
            Sliding::Viscous => qd,
            Sliding::Coulomb => sign(qd),
            Sliding::AsymmetricViscous => qd.abs(),
            Sliding::Stribeck { velocity } => sign(qd) * (-qd.abs() / velocity).exp(),
            Sliding::SoftStribeck {
                velocity,
                exponent,
                softness,
            } => (qd / softness).tanh() * (-(qd.abs() / velocity).powf(exponent)).exp(),
            Sliding::AsymmetricCoulomb { velocity } => (qd / velocity).tanh().powi(2),
            Sliding::SoftCoulomb { velocity } | Sliding::Degressive { velocity } => {
                (qd / velocity).tanh()
            }
            Sliding::Power { exponent } => sign(qd) * qd.abs().powf(exponent),
        }
    }

    /// Whether its parameter is the Coulomb friction of the joint.
    pub fn is_coulomb(&self) -> bool {
        matches!(self, Sliding::Coulomb | Sliding::SoftCoulomb { .. })
    }

    pub(super) fn effect(&self) -> &'static str {
        match self {
            Sliding::Viscous | Sliding::Coulomb | Sliding::SoftCoulomb { .. } => {
                "friction_parameters"
            }
            Sliding::AsymmetricViscous | Sliding::AsymmetricCoulomb { .. } => "asymmetric_friction",
            Sliding::Stribeck { .. } | Sliding::SoftStribeck { .. } => "stribeck_friction",
            Sliding::Degressive { .. } | Sliding::Power { .. } => "nonlinear_viscous_friction",
        }
    }

    pub(super) fn label(&self) -> String {
        match self {
            Sliding::Viscous => "viscous".into(),
            Sliding::Coulomb => "coulomb".into(),
            Sliding::SoftCoulomb { velocity } => format!("coulomb({velocity:.3})"),
            Sliding::AsymmetricViscous => "asymmetric_viscous".into(),
            Sliding::Stribeck { velocity } => format!("stribeck({velocity:.3})"),
            Sliding::SoftStribeck {
                velocity, exponent, ..
            } => format!("stribeck({velocity:.3}, {exponent})"),
            Sliding::AsymmetricCoulomb { velocity } => format!("asymmetric_coulomb({velocity:.3})"),
            Sliding::Degressive { velocity } => format!("degressive({velocity:.3})"),
            Sliding::Power { exponent } => format!("power({exponent:.3})"),
        }
    }

    pub(super) fn unit(&self) -> &'static str {
        match self {
            Sliding::Viscous | Sliding::AsymmetricViscous => "N·m·s/rad",
            Sliding::Power { .. } => "N·m·(s/rad)^α",
            _ => "N·m",
        }
    }
}

/// −1, 0 or 1; unlike `f64::signum`, zero at zero.
pub(super) fn sign(x: f64) -> f64 {
    if x == 0.0 { 0.0 } else { x.signum() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn stribeck_by_hand() {
        // exp(−0.02/0.01) = e⁻² = 0.135335…
        let s = Sliding::Stribeck { velocity: 0.01 };
        assert!((s.at(-0.02) + 0.135_335_283_236_612_7).abs() < 1e-15);
        assert_eq!(s.at(0.0), 0.0);
        // Far beyond the softness the sign is whole: exp(−(0.02/0.01)²) = e⁻⁴.
        let s = Sliding::SoftStribeck {
            velocity: 0.01,
            exponent: 2.0,
            softness: 1e-4,
        };
        assert!((s.at(-0.02) + 0.018_315_638_888_734_18).abs() < 1e-15);
    }

    #[test]
    fn a_difference_of_directions_is_even() {
        let s = Sliding::AsymmetricCoulomb { velocity: 0.1 };
        // tanh²(1) = 0.761594…²
        assert!((s.at(0.1) - 0.580_025_658_385_973_9).abs() < 1e-12);
        assert_eq!(s.at(0.1), s.at(-0.1));
    }

    proptest! {
        #[test]
        fn friction_opposes_both_directions_alike(qd in -3.0..3.0f64, v in 0.001..1.0f64, a in 0.1..2.0f64) {
            for s in [Sliding::Viscous, Sliding::Coulomb, Sliding::Stribeck { velocity: v }, Sliding::SoftCoulomb { velocity: v },
                      Sliding::Degressive { velocity: v }, Sliding::Power { exponent: a }] {
                prop_assert_eq!(s.at(qd), -s.at(-qd));
                prop_assert!(s.at(qd) * qd >= 0.0);
            }
        }
    }
}
