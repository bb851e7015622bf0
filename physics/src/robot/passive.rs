//! Torques of a joint's own position that a description gives: known, not identified.

use super::Counterbalance;
use serde::{Deserialize, Serialize};

/// A linear spring between a joint's link and the link before it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Spring {
    /// Index of the joint on which the spring acts.
    pub joint: usize,
    /// Stiffness, N·m/rad or N/m.
    pub stiffness: f64,
    /// Position at which the spring is relaxed, rad or m.
    pub rest: f64,
}

impl Spring {
    /// Torque at joint position `q`, N·m or N, as a part of the torque that the drive has to deliver (it is
    /// added to inverse dynamics): `stiffness`·(q − `rest`).
    pub fn torque(&self, q: f64) -> f64 {
        self.stiffness * (q - self.rest)
    }
}

/// A torque of the joint's own position that comes from the robot's description.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Passive {
    /// Hydraulic counterbalance with a gas spring.
    Counterbalance(Counterbalance),
    /// Linear spring at the joint.
    Spring(Spring),
}

impl Passive {
    /// Index of the joint on which it acts.
    pub fn joint(&self) -> usize {
        match self {
            Self::Counterbalance(c) => c.joint,
            Self::Spring(s) => s.joint,
        }
    }

    /// Torque at joint position `q` (rad or m), N·m or N; added to inverse dynamics.
    pub fn torque(&self, q: f64) -> f64 {
        match self {
            Self::Counterbalance(c) => c.torque(q),
            Self::Spring(s) => s.torque(q),
        }
    }
}
