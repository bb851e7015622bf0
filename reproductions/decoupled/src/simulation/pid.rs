//! The controller of the paper's recordings: a simple PID on the measured position.

use std::f64::consts::TAU;

/// Corner of the derivative's low-pass, Hz.
const CORNER: f64 = 20.0;

/// u = K_p e + K_i ∫e + K_d ė, ė behind a low-pass of first order.
#[derive(Debug, Clone)]
pub struct Pid {
    gains: [f64; 3],
    step: f64,
    pass: f64,
    integral: f64,
    slope: f64,
    last: Option<f64>,
}

impl Pid {
    /// By rule from the joint's inertia (kg·m²) and a bandwidth f (Hz), ω = 2π f: K_p = 2 Γ ω², K_d = 2 Γ ω, K_i = Γ ω³/2.
    pub fn new(inertia: f64, bandwidth: f64, step: f64) -> Self {
        let w = TAU * bandwidth;
        Self {
            gains: [
                2.0 * inertia * w * w,
                0.5 * inertia * w * w * w,
                2.0 * inertia * w,
            ],
            step,
            pass: 1.0 - (-TAU * CORNER * step).exp(),
            integral: 0.0,
            slope: 0.0,
            last: None,
        }
    }

    /// Torque for the error of one sample.
    pub fn torque(&mut self, error: f64) -> f64 {
        let [proportional, integral, derivative] = self.gains;
        self.integral += self.step * error;
        let slope = (error - self.last.unwrap_or(error)) / self.step;
        self.slope += self.pass * (slope - self.slope);
        self.last = Some(error);
        proportional * error + integral * self.integral + derivative * self.slope
    }
}
