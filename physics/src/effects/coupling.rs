//! Torque on one joint caused by the motion of another: shared gears, belts, hoses.

use super::Sliding;
use serde::{Deserialize, Serialize};

/// What of the driving joint acts on the driven one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Coupling {
    /// Friction of the driver's velocity.
    Friction {
        /// Index of the driving joint, base first.
        driver: usize,
        /// Shape over the driver's velocity.
        shape: Sliding,
    },
    /// Inertia: the driver's acceleration.
    Inertia {
        /// Index of the driving joint, base first.
        driver: usize,
    },
}

impl Coupling {
    /// Index of the driving joint.
    pub fn driver(&self) -> usize {
        match *self {
            Coupling::Friction { driver, .. } | Coupling::Inertia { driver } => driver,
        }
    }

    /// Column for the velocities and accelerations of all joints.
    pub fn at(&self, qd: &[f64], qdd: &[f64]) -> f64 {
        match *self {
            Coupling::Friction { driver, shape } => shape.at(qd[driver]),
            Coupling::Inertia { driver } => qdd[driver],
        }
    }

    pub(super) fn label(&self) -> String {
        match self {
            Coupling::Friction { driver, shape } => {
                format!("{} of joint {}", shape.label(), driver + 1)
            }
            Coupling::Inertia { driver } => format!("acceleration of joint {}", driver + 1),
        }
    }

    pub(super) fn unit(&self) -> &'static str {
        match self {
            Coupling::Friction { shape, .. } => shape.unit(),
            Coupling::Inertia { .. } => "kg·m²",
        }
    }
}
