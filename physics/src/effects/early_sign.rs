//! Friction whose sign changes before that of the velocity.

use serde::{Deserialize, Serialize};

/// tanh((q̇ + lead·q̈)/velocity): the sign that the velocity will have after `lead` seconds, softened.
///
/// No physical contact behaves so, but simulators do. Where friction is a constraint on the acceleration
/// (MuJoCo's `frictionloss`, Todorov 2014) it is the sign of q̈ + b·q̇ with the constraint's damping b, and 1/b
/// is the lead. Where it is solved for the end of a step, the lead is the step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct EarlySign {
    /// Velocity over which the sign changes, rad/s (m/s).
    pub velocity: f64,
    /// Time by which the sign changes before the velocity's, s.
    pub lead: f64,
}

impl EarlySign {
    /// Torque for a parameter of one at velocity `qd` and acceleration `qdd`.
    pub fn at(&self, qd: f64, qdd: f64) -> f64 {
        ((qd + self.lead * qdd) / self.velocity).tanh()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_round_before_the_velocity() {
        let early = EarlySign {
            velocity: 0.001,
            lead: 0.01,
        };
        // Slowing down from 0.5 rad/s² · 10 ms on: half of that ahead it is still positive.
        assert!(early.at(0.006, -0.5) > 0.7);
        assert_eq!(early.at(0.005, -0.5), 0.0);
        assert!(early.at(0.004, -0.5) < -0.7);
    }
}
