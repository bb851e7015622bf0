//! Periodic trajectories.

use super::ExcitationError;
use ndarray::Array2;

/// What a joint may do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionLimits {
    /// Smallest position, rad or m.
    pub lower: f64,
    /// Largest position.
    pub upper: f64,
    /// Largest speed, rad/s or m/s.
    pub velocity: f64,
    /// Largest acceleration, rad/s² or m/s².
    pub acceleration: f64,
}

impl MotionLimits {
    pub(super) fn check(&self, joint: usize) -> Result<(), ExcitationError> {
        let sizes = [self.upper - self.lower, self.velocity, self.acceleration];
        if sizes.iter().all(|s| s.is_finite() && *s > 0.0) {
            Ok(())
        } else {
            Err(ExcitationError::NoRoom { joint })
        }
    }
}

/// q_j(t) = δ_j + Σ_i (μ_ji sin(i ω t) + ν_ji cos(i ω t)), ω = 2π/period (Han et al., eq. 33).
#[derive(Debug, Clone, PartialEq)]
pub struct Fourier {
    /// s.
    pub period: f64,
    /// δ, length N.
    pub offset: Vec<f64>,
    /// μ, N × harmonics.
    pub sine: Array2<f64>,
    /// ν, N × harmonics.
    pub cosine: Array2<f64>,
}

impl Fourier {
    /// Number of joints N.
    pub fn dof(&self) -> usize {
        self.offset.len()
    }

    /// Position, velocity and acceleration at time `t` (s), each of length N.
    ///
    /// # Panics
    /// When a slice has another length.
    pub fn at(&self, t: f64, q: &mut [f64], qd: &mut [f64], qdd: &mut [f64]) {
        let n = self.dof();
        assert!(
            q.len() == n && qd.len() == n && qdd.len() == n,
            "one value per joint"
        );
        q.copy_from_slice(&self.offset);
        qd.fill(0.0);
        qdd.fill(0.0);
        for i in 0..self.sine.ncols() {
            let w = self.pulsation(i);
            let (s, c) = (w * t).sin_cos();
            for j in 0..n {
                let (mu, nu) = (self.sine[(j, i)], self.cosine[(j, i)]);
                q[j] += mu * s + nu * c;
                qd[j] += w * (mu * c - nu * s);
                qdd[j] -= w * w * (mu * s + nu * c);
            }
        }
    }

    /// Starts every joint at rest and shrinks each until it keeps its limits at all times: bounds on the sums of
    /// amplitudes, eq. 34, so no time grid can miss a peak.
    pub(super) fn keep(&mut self, limits: &[MotionLimits]) {
        let harmonics = self.sine.ncols();
        let w: Vec<f64> = (0..harmonics).map(|i| self.pulsation(i)).collect();
        let w2: f64 = w.iter().map(|w| w * w).sum();
        for (j, limit) in limits.iter().enumerate() {
            // q̇(0) = Σ ω_i μ_i = 0.
            let start: f64 = (0..harmonics).map(|i| w[i] * self.sine[(j, i)]).sum();
            for (i, w) in w.iter().enumerate() {
                self.sine[(j, i)] -= w * start / w2;
            }
            let middle = 0.5 * (limit.lower + limit.upper);
            let half = 0.5 * (limit.upper - limit.lower);
            // A tenth of the range is always kept for motion.
            let shift = (self.offset[j] - middle).clamp(-0.9 * half, 0.9 * half);
            self.offset[j] = middle + shift;
            let bound = |power: i32| -> f64 {
                let size = |i: usize| self.sine[(j, i)].hypot(self.cosine[(j, i)]);
                (0..harmonics).map(|i| w[i].powi(power) * size(i)).sum()
            };
            let shrink = [
                (half - shift.abs()) / bound(0),
                limit.velocity / bound(1),
                limit.acceleration / bound(2),
            ];
            let factor = shrink.into_iter().fold(1.0, f64::min);
            for i in 0..harmonics {
                self.sine[(j, i)] *= factor;
                self.cosine[(j, i)] *= factor;
            }
        }
    }

    fn pulsation(&self, harmonic: usize) -> f64 {
        std::f64::consts::TAU * (harmonic + 1) as f64 / self.period
    }
}
