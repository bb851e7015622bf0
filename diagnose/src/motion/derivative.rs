//! Smoothing and derivatives of signals on a scene's motion, within each of its segments.

use super::scene::Scene;
use ndarray::{Array1, Array2, Axis};

impl Scene<'_> {
    /// First-order change of the rigid torque when one joint's link departs from its motor by `dq`.
    pub fn departure(&self, joint: usize, dq: &Array1<f64>) -> Array2<f64> {
        let rate = self.derivative(dq);
        let acceleration = self.derivative(&rate);
        let by = self.tangent(joint);
        let column = |x: &Array1<f64>| x.clone().insert_axis(Axis(1));
        &by.q * &column(dq) + &by.qd * &column(&rate) + &by.qdd * &column(&acceleration)
    }

    /// Gaussian smoothing within each segment by three running means; `deviation` in s.
    pub fn rounded(&self, x: &Array1<f64>, deviation: f64) -> Array1<f64> {
        // Three boxes of half width h have the variance h(h + 1).
        let half = ((deviation / self.scale.step).round() as usize).max(1);
        let mut out = x.clone();
        for s in &self.motion.segments {
            for _ in 0..3 {
                let mut sums = Vec::with_capacity(s.len() + 1);
                sums.push(0.0);
                for i in s.clone() {
                    sums.push(sums[i - s.start] + out[i]);
                }
                for i in 0..s.len() {
                    let h = half.min(i).min(s.len() - 1 - i);
                    out[s.start + i] = (sums[i + h + 1] - sums[i - h]) / (2 * h + 1) as f64;
                }
            }
        }
        out
    }

    /// First derivative in time within each segment, by central differences.
    pub fn derivative(&self, x: &Array1<f64>) -> Array1<f64> {
        let mut d = Array1::zeros(x.len());
        for s in &self.motion.segments {
            let t = &self.motion.time;
            for i in s.clone() {
                let (a, b) = (i.saturating_sub(1).max(s.start), (i + 1).min(s.end - 1));
                if b > a {
                    d[i] = (x[b] - x[a]) / (t[b] - t[a]);
                }
            }
        }
        d
    }
}
