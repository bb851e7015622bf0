//! A joint whose neighbours stand still (COMAU paper, equations 2, 21 and 22).
//!
//! τ = Γ q̈ + g (mx cos q − my sin q) + f(q̇), f = β^{v±} q̇ ± β^{c±} by the direction of motion.

use serde::{Deserialize, Serialize};

/// Gravity, m/s².
pub const GRAVITY: f64 = 9.81;

/// Friction of one direction each (equation 2); all four are positive, against the motion.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Friction {
    /// β^{v+}, β^{v−}, N·m·s/rad.
    pub viscous: [f64; 2],
    /// β^{c+}, β^{c−}, N·m.
    pub coulomb: [f64; 2],
}

impl Friction {
    /// Torque against motion at velocity `v` (rad/s); zero at rest.
    pub fn torque(&self, v: f64) -> f64 {
        if v > 0.0 {
            self.viscous[0] * v + self.coulomb[0]
        } else if v < 0.0 {
            self.viscous[1] * v - self.coulomb[1]
        } else {
            0.0
        }
    }
}

/// Parameters of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Joint {
    /// Γ about its axis, kg·m².
    pub inertia: f64,
    /// mx and my, kg·m; none where gravity does no work about the axis.
    pub moments: Option<[f64; 2]>,
    /// Friction.
    pub friction: Friction,
}

impl Joint {
    /// Torque of gravity at position `q` (rad), N·m.
    pub fn gravity(&self, q: f64) -> f64 {
        let [mx, my] = self.moments.unwrap_or_default();
        GRAVITY * (mx * q.cos() - my * q.sin())
    }

    /// Torque of a motion, N·m.
    pub fn torque(&self, q: f64, v: f64, a: f64) -> f64 {
        self.inertia * a + self.gravity(q) + self.friction.torque(v)
    }

    /// The parameters in the order of [`Columns`].
    pub fn parameters(&self) -> Vec<f64> {
        let f = &self.friction;
        let moments = self.moments.into_iter().flatten();
        let friction = f.viscous.into_iter().chain(f.coulomb);
        [self.inertia]
            .into_iter()
            .chain(moments)
            .chain(friction)
            .collect()
    }
}

/// The columns of a joint's torque: Γ, then mx and my where gravity works, then β^{v+}, β^{v−}, β^{c+}, β^{c−}.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Columns {
    /// Whether gravity works about the axis.
    pub gravity: bool,
}

/// Most columns.
pub const MOST: usize = 7;

impl Columns {
    /// Number of parameters.
    pub fn len(self) -> usize {
        if self.gravity { MOST } else { MOST - 2 }
    }

    /// Never.
    pub fn is_empty(self) -> bool {
        false
    }

    /// Names as the paper has them, with units.
    pub fn names(self) -> Vec<(&'static str, &'static str)> {
        let gravity = [("mx", "kg·m"), ("my", "kg·m")];
        let friction = [
            ("β^v+", "N·m·s/rad"),
            ("β^v−", "N·m·s/rad"),
            ("β^c+", "N·m"),
            ("β^c−", "N·m"),
        ];
        let gravity = gravity.into_iter().filter(|_| self.gravity);
        [("Γ", "kg·m²")]
            .into_iter()
            .chain(gravity)
            .chain(friction)
            .collect()
    }

    /// Torque by unit of each parameter at position, velocity and acceleration, `forwards` the direction of motion.
    pub fn row(self, q: f64, v: f64, a: f64, forwards: bool, row: &mut Vec<f64>) {
        row.clear();
        row.push(a);
        if self.gravity {
            let (sin, cos) = q.sin_cos();
            row.extend([GRAVITY * cos, -GRAVITY * sin]);
        }
        row.extend(if forwards {
            [v, 0.0, 1.0, 0.0]
        } else {
            [0.0, v, 0.0, -1.0]
        });
    }

    /// The joint with these parameters.
    ///
    /// # Panics
    /// Where their number is another.
    pub fn joint(self, parameters: &[f64]) -> Joint {
        assert_eq!(parameters.len(), self.len(), "one value per column");
        let f = &parameters[self.len() - 4..];
        Joint {
            inertia: parameters[0],
            moments: self.gravity.then(|| [parameters[1], parameters[2]]),
            friction: Friction {
                viscous: [f[0], f[1]],
                coulomb: [f[2], f[3]],
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_times_parameters_are_the_torque() {
        let joint = Joint {
            inertia: 3.0,
            moments: Some([2.0, -1.0]),
            friction: Friction {
                viscous: [4.0, 5.0],
                coulomb: [6.0, 7.0],
            },
        };
        let columns = Columns { gravity: true };
        let mut row = Vec::new();
        for (q, v, a) in [(0.4, 0.5, -1.0), (-1.2, -0.3, 2.0)] {
            columns.row(q, v, a, v > 0.0, &mut row);
            let sum: f64 = row.iter().zip(joint.parameters()).map(|(y, p)| y * p).sum();
            assert!((sum - joint.torque(q, v, a)).abs() < 1e-12);
        }
        // 3·(−1) + 9.81·(2 cos 0 + sin 0) + 4·0.5 + 6 = −3 + 19.62 + 8
        assert!((joint.torque(0.0, 0.5, -1.0) - 24.62).abs() < 1e-12);
        assert!((joint.torque(0.0, -0.5, 0.0) - (19.62 - 2.5 - 7.0)).abs() < 1e-12);
        assert_eq!(columns.joint(&joint.parameters()), joint);
        assert_eq!(columns.names().len(), columns.len());
    }
}
