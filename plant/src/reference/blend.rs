//! Quintic from one state of motion to another.

use super::Command;

/// Polynomials of degree five that match position, velocity and acceleration at both ends.
#[derive(Debug, Clone)]
pub struct Blend {
    duration: f64,
    /// Coefficients of u⁰…u⁵ with u = t/duration, per joint.
    coefficients: Vec<[f64; 6]>,
}

impl Blend {
    /// Blend from one state to another in `duration`, s.
    pub fn new(from: &Command, to: &Command, duration: f64) -> Self {
        let d = duration;
        let coefficients = (0..from.q.len())
            .map(|j| {
                let (p0, v0, a0) = (from.q[j], from.qd[j] * d, from.qdd[j] * d * d);
                let (p1, v1, a1) = (to.q[j], to.qd[j] * d, to.qdd[j] * d * d);
                let p = p1 - p0;
                [
                    p0,
                    v0,
                    0.5 * a0,
                    10.0 * p - 6.0 * v0 - 4.0 * v1 - 1.5 * a0 + 0.5 * a1,
                    -15.0 * p + 8.0 * v0 + 7.0 * v1 + 1.5 * a0 - a1,
                    6.0 * p - 3.0 * (v0 + v1) - 0.5 * (a0 - a1),
                ]
            })
            .collect();
        Self {
            duration,
            coefficients,
        }
    }

    /// The command at time `t`, s.
    pub fn sample(&self, t: f64, out: &mut Command) {
        let d = self.duration;
        let u = (t / d).clamp(0.0, 1.0);
        for (j, c) in self.coefficients.iter().enumerate() {
            out.q[j] = c[0] + u * (c[1] + u * (c[2] + u * (c[3] + u * (c[4] + u * c[5]))));
            let qd = c[1] + u * (2.0 * c[2] + u * (3.0 * c[3] + u * (4.0 * c[4] + u * 5.0 * c[5])));
            let qdd = 2.0 * c[2] + u * (6.0 * c[3] + u * (12.0 * c[4] + u * 20.0 * c[5]));
            out.qd[j] = qd / d;
            out.qdd[j] = qdd / (d * d);
        }
    }
}
