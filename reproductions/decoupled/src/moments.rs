//! Equations that the loop's noise cannot bias.
//!
//! A controller answers to the noise of position, so that torque, velocity and acceleration of a sample all depend on it, and
//! differences of a noisy position are noise for the most part. The reference depends on nothing of the kind: sums of rows
//! weighted by functions z of the reference alone, Zᵀ W (τ − Φ θ) = 0, hold exactly in the mean, whatever the controller is
//! and however noisy Φ, as long as Φ is linear in the noise. It is: velocity and acceleration are differences, and the
//! direction of motion is the reference's, for which rows around its reversals, where the joint may stick or still go the
//! other way, are left out.

use crate::joint::{Columns, GRAVITY};
use crate::run::{Run, column};
use faer::linalg::solvers::Solve;
use faer::{Mat, MatRef, Side};
use std::f64::consts::{PI, TAU};

/// Rows are left out where the reference is slower than this part of its top speed, and come back over as much again.
const SLOW: f64 = 0.1;
/// They are left out for this long after a reversal, and come back over as much again, s: the integral of the controller takes
/// up Coulomb friction of the other sign in the meantime.
const AFTER: f64 = 0.15;
/// Window over which the level of torque noise is taken, s.
const WINDOW: f64 = 0.25;

/// Standard deviations of white noise.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Noise {
    /// Of position, rad.
    pub position: f64,
    /// Of torque, N·m.
    pub torque: f64,
}

/// A run as weighted rows.
pub struct Rows<'a> {
    run: &'a Run,
    /// What the columns are.
    pub columns: Columns,
    /// Weight of each row, 0 to 1, a function of the reference alone.
    pub weight: Vec<f64>,
    /// W Φ with Φ at the recorded motion, direction by the reference, samples × parameters.
    pub recorded: Mat<f64>,
    /// W τ, less what is known of it.
    pub torque: Mat<f64>,
}

/// Sums of a run's rows: A θ = b.
pub struct Moments {
    /// Zᵀ W Φ.
    pub a: Mat<f64>,
    /// Zᵀ W τ.
    pub b: Mat<f64>,
}

/// Parameters with their covariance.
#[derive(Debug, Clone)]
pub struct Solved {
    /// θ, in the order of the columns.
    pub parameters: Vec<f64>,
    /// Their covariance.
    pub covariance: Mat<f64>,
}

impl<'a> Rows<'a> {
    /// The rows of a run; `known` is torque that is already explained, taken off.
    pub fn new(run: &'a Run, columns: Columns, known: impl Fn(usize) -> f64) -> Self {
        let (n, p) = (run.len(), columns.len());
        let weight = weights(run);
        let mut recorded = Mat::zeros(n, p);
        let mut torque = Mat::zeros(n, 1);
        let mut row = Vec::with_capacity(p);
        for k in 1..n - 1 {
            let [v, a] = differences(run, k);
            columns.row(run.q[k], v, a, run.reference[k][1] > 0.0, &mut row);
            for (j, value) in row.iter().enumerate() {
                recorded[(k, j)] = weight[k] * value;
            }
            torque[(k, 0)] = weight[k] * (run.tau[k] - known(k));
        }
        Self {
            run,
            columns,
            weight,
            recorded,
            torque,
        }
    }

    /// W Φ at the commanded motion.
    pub fn commanded(&self) -> Mat<f64> {
        let mut table = Mat::zeros(self.run.len(), self.columns.len());
        let mut row = Vec::new();
        for (k, [q, v, a]) in self.run.reference.iter().enumerate() {
            self.columns.row(*q, *v, *a, *v > 0.0, &mut row);
            for (j, value) in row.iter().enumerate() {
                table[(k, j)] = self.weight[k] * value;
            }
        }
        table
    }

    /// W times the reference's positions at `taps` lags spread over its period, and W itself: what a non-causal filter of the
    /// reference can give (COMAU paper, equation 10), samples × (taps + 1).
    pub fn lagged(&self, taps: usize) -> Mat<f64> {
        let n = self.run.len();
        let each = (self.run.period / self.run.step).round().max(1.0) as usize;
        Mat::from_fn(n, taps + 1, |k, tap| {
            // The reference is periodic: what lies before and after the run is known.
            let lag = tap * each / taps;
            let value = if tap == taps {
                1.0
            } else {
                self.run.reference[(k + lag) % each.min(n)][0]
            };
            self.weight[k] * value
        })
    }

    /// Sums with these functions of the reference, which carry the rows' weight.
    pub fn moments(&self, z: &Mat<f64>) -> Moments {
        Moments {
            a: z.transpose() * &self.recorded,
            b: z.transpose() * &self.torque,
        }
    }

    /// Covariance of the sums' noise for parameters θ (COMAU paper, equation 16: S² = B σ² Bᵀ, B the slopes of the equations
    /// by the recorded samples): noise of torque and of position, the latter through gravity, velocity and acceleration.
    pub fn noise(&self, z: &Mat<f64>, parameters: &[f64], noise: Noise) -> Mat<f64> {
        let [torque, position] = self.slopes(z, parameters);
        faer::Scale(noise.torque.powi(2)) * (torque.transpose() * &torque)
            + faer::Scale(noise.position.powi(2)) * (position.transpose() * &position)
    }

    /// B: slopes of the sums by the recorded torques and by the recorded positions, samples × sums each.
    fn slopes(&self, z: &Mat<f64>, parameters: &[f64]) -> [Mat<f64>; 2] {
        let (n, m, dt) = (self.run.len(), z.ncols(), self.run.step);
        let joint = self.columns.joint(parameters);
        let [mx, my] = joint.moments.unwrap_or_default();
        let mut weighted = z.clone();
        let mut moved = Mat::<f64>::zeros(n, m);
        let bend = joint.inertia / (dt * dt);
        for l in 0..m {
            let mut w = weighted.col_mut(l);
            let mut to = moved.col_mut(l);
            for k in 0..n {
                w[k] *= self.weight[k];
            }
            for k in 1..n - 1 {
                let q = self.run.q[k];
                let slope = -GRAVITY * (mx * q.sin() + my * q.cos());
                let way = usize::from(self.run.reference[k][1] <= 0.0);
                let drag = joint.friction.viscous[way] / (2.0 * dt);
                let y = w[k];
                to[k] += y * (slope - 2.0 * bend);
                to[k + 1] += y * (bend + drag);
                to[k - 1] += y * (bend - drag);
            }
        }
        [weighted, moved]
    }

    /// The noise of the run: that of position from third differences, in which a smooth motion leaves nothing; that of torque
    /// from what parameters θ leave in windows of a quarter of a second, less what the noise of position does there.
    pub fn level(&self, parameters: &[f64]) -> Noise {
        let q = &self.run.q;
        let cubes: f64 = q
            .windows(4)
            .map(|w| (w[3] - 3.0 * w[2] + 3.0 * w[1] - w[0]).powi(2))
            .sum();
        let position = (cubes / (20.0 * (q.len() - 3) as f64)).sqrt();
        let each = ((WINDOW / self.run.step) as usize).max(8);
        // All windows in one column: they touch where they are zero.
        let windows = Mat::from_fn(self.run.len(), 1, |k, _| {
            self.weight[k] * (PI * (k % each) as f64 / each as f64).sin().powi(4)
        });
        let left = &self.torque - &self.recorded * column(parameters);
        let weighted: Vec<f64> = (0..left.nrows())
            .map(|k| windows[(k, 0)] * left[(k, 0)])
            .collect();
        let sums = weighted.chunks(each).map(|w| w.iter().sum::<f64>());
        let squares: f64 = sums.map(|s| s * s).sum();
        let [torque, moved] = self.slopes(&windows, parameters);
        let count = self.run.len() / each;
        let spent = count as f64 / (count.saturating_sub(parameters.len())).max(1) as f64;
        let energy = spent * squares - position.powi(2) * moved.squared_norm_l2();
        let torque = (energy.max(0.0) / torque.squared_norm_l2().max(f64::MIN_POSITIVE)).sqrt();
        Noise { position, torque }
    }
}

impl Moments {
    /// θ = argmin (A θ − b)ᵀ K⁻¹ (A θ − b) with its covariance H S Hᵀ, θ = H b, for noise of covariance S. `None` where A
    /// lacks rank.
    pub fn solve(
        &self,
        metric: MatRef<f64>,
        noise: impl FnOnce(&[f64]) -> Mat<f64>,
    ) -> Option<Solved> {
        let factor = metric.llt(Side::Lower).ok()?;
        let weighted = factor.solve(&self.a);
        let normal = self.a.transpose() * &weighted;
        // Unit columns: parameters differ by orders of magnitude.
        let p = normal.nrows();
        let scale: Vec<f64> = (0..p).map(|j| 1.0 / normal[(j, j)].sqrt()).collect();
        let unit = Mat::from_fn(p, p, |i, j| normal[(i, j)] * scale[i] * scale[j]);
        let root = unit.llt(Side::Lower).ok()?;
        let right = Mat::from_fn(p, weighted.nrows(), |i, k| scale[i] * weighted[(k, i)]);
        let solved = root.solve(&right);
        let h = Mat::from_fn(p, weighted.nrows(), |i, k| scale[i] * solved[(i, k)]);
        let theta = &h * &self.b;
        let parameters: Vec<f64> = (0..p).map(|j| theta[(j, 0)]).collect();
        if parameters.iter().any(|v| !v.is_finite()) {
            return None;
        }
        let covariance = &h * noise(&parameters) * h.transpose();
        Some(Solved {
            parameters,
            covariance,
        })
    }
}

/// The diagonal raised by a part of its mean: what a reference of few harmonics leaves without rank.
pub fn regularised(mut matrix: Mat<f64>, part: f64) -> Mat<f64> {
    let n = matrix.nrows();
    let mean = (0..n).map(|i| matrix[(i, i)]).sum::<f64>() / n as f64;
    for i in 0..n {
        matrix[(i, i)] += part * mean;
    }
    matrix
}

/// Velocity and acceleration at sample k, by central differences of the recorded position.
pub fn differences(run: &Run, k: usize) -> [f64; 2] {
    let (before, here, after, dt) = (run.q[k - 1], run.q[k], run.q[k + 1], run.step);
    [
        (after - before) / (2.0 * dt),
        (after - 2.0 * here + before) / (dt * dt),
    ]
}

/// Weights by the reference: none around its reversals and at the ends of the run.
fn weights(run: &Run) -> Vec<f64> {
    let (n, top) = (run.len(), run.speed());
    let smooth = |x: f64| {
        let x = x.clamp(0.0, 1.0);
        0.5 - 0.5 * (0.5 * TAU * x).cos()
    };
    let mut weight: Vec<f64> = run
        .reference
        .iter()
        .map(|r| smooth((r[1].abs() / top.max(f64::MIN_POSITIVE) - SLOW) / SLOW))
        .collect();
    let (after, before) = (
        ((AFTER / run.step) as usize).max(1),
        ((0.25 * AFTER / run.step) as usize).max(1),
    );
    for k in 1..n {
        if run.reference[k][1] * run.reference[k - 1][1] > 0.0 {
            continue;
        }
        for l in 0..(2 * after).min(n - k) {
            let come = smooth((l as f64 - after as f64) / after as f64);
            weight[k + l] = weight[k + l].min(come);
        }
        for l in 0..before.min(k) {
            let go = smooth(l as f64 / before as f64);
            weight[k - l] = weight[k - l].min(go);
        }
    }
    weight[0] = 0.0;
    weight[n - 1] = 0.0;
    weight
}
