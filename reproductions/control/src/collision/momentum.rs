//! Generalised momentum.

use crate::model::Model;

/// r = K (p − p(0) − ∫(τ − τ_f + β + r) dt), p = M(q) q̇, β = C(q, q̇)ᵀ q̇ − g(q): with an exact model ṙ = K (τ_ext − r), a first-order
/// estimate of the torque from outside that takes no acceleration (De Luca and Mattone 2005, eqs 9 and 12).
///
/// β is Ṁ q̇ − (C q̇ + g), the first by central differences of p along the motion with q̇ held.
#[derive(Debug, Clone)]
pub struct Momentum {
    gain: f64,
    /// p(0) + ∫(…), none before the first sample.
    sum: Option<Vec<f64>>,
    residual: Vec<f64>,
    work: [Vec<f64>; 4],
}

/// Step of the differences, s.
const STEP: f64 = 1e-5;

impl Momentum {
    /// For `dof` joints with gain K, 1/s.
    pub fn new(dof: usize, gain: f64) -> Self {
        Self {
            gain,
            sum: None,
            residual: vec![0.0; dof],
            work: std::array::from_fn(|_| vec![0.0; dof]),
        }
    }

    /// Starts anew.
    pub fn reset(&mut self) {
        self.sum = None;
        self.residual.fill(0.0);
    }

    /// The next sample's residual, N·m or N, `dt` seconds after the last; `torque` is what the motors give less friction.
    pub fn step(
        &mut self,
        model: &mut dyn Model,
        q: &[f64],
        qd: &[f64],
        torque: &[f64],
        dt: f64,
    ) -> &[f64] {
        let [p, ahead, behind, bias] = &mut self.work;
        model.momentum(q, qd, p);
        let Some(sum) = &mut self.sum else {
            self.sum = Some(p.clone());
            return &self.residual;
        };
        let shifted = |sign: f64| -> Vec<f64> {
            q.iter().zip(qd).map(|(q, v)| q + sign * STEP * v).collect()
        };
        model.momentum(&shifted(1.0), qd, ahead);
        model.momentum(&shifted(-1.0), qd, behind);
        model.rigid(q, qd, &vec![0.0; q.len()], bias);
        for j in 0..q.len() {
            let beta = (ahead[j] - behind[j]) / (2.0 * STEP) - bias[j];
            sum[j] += dt * (torque[j] + beta);
            // Implicit in r: the gain may be as fast as the samples.
            let r = self.gain * (p[j] - sum[j]) / (1.0 + self.gain * dt);
            sum[j] += dt * r;
            self.residual[j] = r;
        }
        &self.residual
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Nominal;
    use physics::robot::Robot;

    /// Along a motion with the torque of the model and 3 N·m from outside on joint 2: the residual of that joint is 3 (1 − exp(−K t))
    /// and of the others nothing.
    #[test]
    fn sees_what_comes_from_outside() {
        let robot = Robot::builtin("puma560").unwrap();
        let mut model = Nominal::new(&robot);
        let (k, dt) = (80.0, 2e-4);
        let mut observer = Momentum::new(6, k);
        let at = |t: f64| {
            let wave = |j: usize| (0.7 + 0.3 * j as f64, 0.4 * j as f64);
            let q: Vec<f64> = (0..6).map(|j| (wave(j).0 * t + wave(j).1).sin()).collect();
            let qd = (0..6).map(|j| wave(j).0 * (wave(j).0 * t + wave(j).1).cos());
            let qdd = (0..6).map(|j| -wave(j).0.powi(2) * q[j]);
            (q.clone(), qd.collect::<Vec<_>>(), qdd.collect::<Vec<_>>())
        };
        let mut tau = vec![0.0; 6];
        let mut seen = Vec::new();
        for step in 0..500 {
            // Torque over the step before this sample.
            let (q, qd, qdd) = at((f64::from(step) - 0.5) * dt);
            model.rigid(&q, &qd, &qdd, &mut tau);
            tau[1] -= 3.0;
            let (q, qd, _) = at(f64::from(step) * dt);
            seen = observer.step(&mut model, &q, &qd, &tau, dt).to_vec();
        }
        let expected = 3.0 * (1.0 - (-k * 499.0 * dt).exp());
        for (j, r) in seen.iter().enumerate() {
            let wanted = if j == 1 { expected } else { 0.0 };
            assert!((r - wanted).abs() < 0.02, "joint {}: {seen:?}", j + 1);
        }
    }
}
