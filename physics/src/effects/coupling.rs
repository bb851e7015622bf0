//! Torque on one joint caused by the motion of another: shared gears, belts, hoses.

use super::Sliding;
use serde::{Deserialize, Serialize};

/// Quantity of the driving joint that acts on the driven one.
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
    /// Spring: displacement of the driver from a position.
    Spring {
        /// Index of the driving joint, base first.
        driver: usize,
        /// Position of the driver at which the spring is relaxed, rad (m for prismatic joints).
        middle: f64,
    },
    /// tanh((q̇ + ratio·q̇_driver)/velocity): Coulomb friction of a part that both motions turn together.
    Relative {
        /// Index of the driving joint, base first.
        driver: usize,
        /// Number of turns of the rubbing part for one turn of the driver.
        ratio: f64,
        /// Velocity over which the sign changes, rad/s (m/s).
        velocity: f64,
    },
}

impl Coupling {
    /// Index of the driving joint.
    pub fn driver(&self) -> usize {
        match *self {
            Coupling::Friction { driver, .. }
            | Coupling::Inertia { driver }
            | Coupling::Spring { driver, .. }
            | Coupling::Relative { driver, .. } => driver,
        }
    }

    /// Column of the driven `joint` for positions, velocities and accelerations of all joints.
    pub fn at(&self, joint: usize, q: &[f64], qd: &[f64], qdd: &[f64]) -> f64 {
        match *self {
            Coupling::Friction { driver, shape } => shape.at(qd[driver]),
            Coupling::Inertia { driver } => qdd[driver],
            Coupling::Spring { driver, middle } => q[driver] - middle,
            Coupling::Relative {
                driver,
                ratio,
                velocity,
            } => ((qd[joint] + ratio * qd[driver]) / velocity).tanh(),
        }
    }

    pub(super) fn label(&self) -> String {
        match self {
            Coupling::Friction { driver, shape } => {
                format!("{} of joint {}", shape.label(), driver + 1)
            }
            Coupling::Inertia { driver } => format!("acceleration of joint {}", driver + 1),
            Coupling::Spring { driver, .. } => format!("position of joint {}", driver + 1),
            Coupling::Relative { driver, ratio, .. } => {
                format!("coulomb of own + {ratio} of joint {}", driver + 1)
            }
        }
    }

    pub(super) fn unit(&self) -> &'static str {
        match self {
            Coupling::Friction { shape, .. } => shape.unit(),
            Coupling::Inertia { .. } => "kg·m²",
            Coupling::Spring { .. } => "N·m/rad",
            Coupling::Relative { .. } => "N·m",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_by_hand() {
        let (q, qd, qdd) = ([0.2, 0.5], [0.3, -0.1], [2.0, 4.0]);
        let at = |c: Coupling| c.at(0, &q, &qd, &qdd);
        let driver = 1;
        assert_eq!(at(Coupling::Inertia { driver }), 4.0);
        assert_eq!(
            at(Coupling::Spring {
                driver,
                middle: 0.1
            }),
            0.4
        );
        // 0.3 − 2·0.1 = 0.1, at a softness of 0.1: tanh(1).
        let relative = Coupling::Relative {
            driver,
            ratio: 2.0,
            velocity: 0.1,
        };
        assert!((at(relative) - 0.761_594_155_955_764_9).abs() < 1e-12);
    }
}
