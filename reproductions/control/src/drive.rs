//! The cascade of a drive: position loop, velocity loop, ideal current loop.

use plant::reference::Command;
use std::f64::consts::TAU;

/// Gains of the cascade. The velocity loop crosses over at ω = 2π f; its integral acts at ω/4, where the loop alone is
/// critically damped, and so does the position loop.
#[derive(Debug, Clone, PartialEq)]
pub struct Gains {
    /// Of the position loop, 1/s.
    pub position: f64,
    /// Of the velocity loop, N·m·s/rad or N·s/m, per joint: inertia times ω.
    pub velocity: Vec<f64>,
    /// Inverse of the velocity loop's integral time, 1/s.
    pub integral: f64,
}

impl Gains {
    /// By rule from each joint's inertia (kg·m² or kg, all other joints held) and the velocity loop's crossover f, Hz.
    pub fn of(inertia: &[f64], crossover_hz: f64) -> Self {
        let w = TAU * crossover_hz;
        Self {
            position: w / 4.0,
            velocity: inertia.iter().map(|m| m * w).collect(),
            integral: w / 4.0,
        }
    }
}

/// u = K_v (e_v + ∫e_v/T), e_v = q̇_r + K_p (q_r − q) − q̇.
#[derive(Debug, Clone)]
pub struct Cascade {
    gains: Gains,
    /// ∫e_v, per joint.
    integral: Vec<f64>,
}

impl Cascade {
    /// At rest.
    pub fn new(gains: Gains) -> Self {
        Self {
            integral: vec![0.0; gains.velocity.len()],
            gains,
        }
    }

    /// Torque of the feedback for a measured state (N values each), `dt` seconds after the last.
    pub fn torque(&mut self, command: &Command, q: &[f64], v: &[f64], dt: f64, u: &mut [f64]) {
        for j in 0..u.len() {
            let error = command.qd[j] + self.gains.position * (command.q[j] - q[j]) - v[j];
            self.integral[j] += dt * error;
            u[j] = self.gains.velocity[j] * (error + self.gains.integral * self.integral[j]);
        }
    }

    /// Takes the last step of the integral of joint `j` back: its motor gave less than it was asked for.
    pub fn saturated(&mut self, j: usize, command: &Command, q: &[f64], v: &[f64], dt: f64) {
        let error = command.qd[j] + self.gains.position * (command.q[j] - q[j]) - v[j];
        self.integral[j] -= dt * error;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A mass of 2 kg·m² under a constant torque of 3 N·m comes to rest where it was told to: with ω = 40/s the poles of
    /// s³ + ω s² + ω²/2 s + ω³/16 decay faster than 7/s, and the integral then carries the 3 N·m alone.
    #[test]
    fn holds_a_load_without_error() {
        let gains = Gains::of(&[2.0], 40.0 / TAU);
        assert!((gains.position - 10.0).abs() < 1e-12 && (gains.velocity[0] - 80.0).abs() < 1e-12);
        let mut cascade = Cascade::new(gains);
        let command = Command {
            q: vec![0.1],
            ..Command::new(1)
        };
        let (mut q, mut v, mut u, dt) = ([0.0], [0.0], [0.0], 1e-4);
        for _ in 0..30_000 {
            cascade.torque(&command, &q, &v, dt, &mut u);
            v[0] += dt * (u[0] - 3.0) / 2.0;
            q[0] += dt * v[0];
        }
        assert!((q[0] - 0.1).abs() < 1e-6, "{q:?}");
        assert!((u[0] - 3.0).abs() < 1e-3, "{u:?}");
    }
}
