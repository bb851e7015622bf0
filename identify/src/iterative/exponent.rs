//! Friction that grows with a power of speed.

use super::Problem;
use crate::least_squares::{LeastSquaresError, check_size};
use nalgebra::{Matrix3, Vector3};
use ndarray::Array2;

/// Fc·sign(q̇) + Fv·|q̇|^α·sign(q̇) + B (eq. 30) on some joints: which columns hold the power term. The columns of
/// Coulomb friction and offset must be in the regressor too.
#[derive(Debug, Clone, PartialEq)]
pub struct PowerLaw {
    /// Column of |q̇|^α·sign(q̇) of each joint, or `None` where friction is linear.
    pub columns: Vec<Option<usize>>,
    /// Joint velocities, samples × N, rad/s (m/s).
    pub velocity: Array2<f64>,
    /// Exponent to start from. Han et al. start from 1, linear viscous friction.
    pub start: f64,
    /// Smallest and largest exponent that is tried.
    pub range: (f64, f64),
}

impl PowerLaw {
    /// Power law on these columns, with exponents from 0.05 to 3. The search starts from 1, as in Han et al. (2020).
    pub fn new(columns: Vec<Option<usize>>, velocity: Array2<f64>) -> Self {
        Self {
            columns,
            velocity,
            start: 1.0,
            range: (0.05, 3.0),
        }
    }

    pub(super) fn check(&self, problem: &Problem) -> Result<(), LeastSquaresError> {
        check_size("the power-law columns", self.columns.len(), problem.dof())?;
        check_size("the velocities", self.velocity.nrows(), problem.samples())?;
        check_size("the velocities", self.velocity.ncols(), problem.dof())?;
        if self.velocity.iter().any(|v| !v.is_finite()) {
            return Err(LeastSquaresError::NotFinite);
        }
        let columns = problem.columns();
        match self.columns.iter().flatten().find(|&&c| c >= columns) {
            Some(&column) => Err(LeastSquaresError::NoSuchColumn { column, columns }),
            None => Ok(()),
        }
    }

    /// Exponent of each joint to start from; one where friction is linear.
    pub(super) fn starts(&self) -> Vec<f64> {
        let start = |column: &Option<usize>| column.map_or(1.0, |_| self.start);
        self.columns.iter().map(start).collect()
    }

    /// One round of L3: the step of each exponent to the one that best fits the torque left to friction (eqs
    /// 29, 31), weights kept.
    pub(super) fn steps(
        &self,
        problem: &Problem,
        exponents: &[f64],
        parameters: &[f64],
        residual: &Array2<f64>,
        weights: &Array2<f64>,
    ) -> Vec<f64> {
        let mut steps = vec![0.0; exponents.len()];
        for joint in 0..problem.dof() {
            let Some(column) = self.columns[joint] else {
                continue;
            };
            let power = problem.column(joint, column);
            let points: Vec<Point> = (0..problem.samples())
                .filter(|&k| weights[(k, joint)] > 0.0 && self.velocity[(k, joint)] != 0.0)
                .map(|k| {
                    let v = self.velocity[(k, joint)];
                    Point {
                        sign: v.signum(),
                        log_speed: v.abs().ln(),
                        friction: residual[(k, joint)] + parameters[column] * power[k],
                        weight: weights[(k, joint)],
                    }
                })
                .collect();
            // Three coefficients and the exponent: fewer samples say nothing.
            if points.len() > 4 {
                let best = minimum(self.range, |alpha| misfit(&points, alpha));
                steps[joint] = best - exponents[joint];
            }
        }
        steps
    }

    /// Writes |q̇|^α·sign(q̇) into the columns.
    pub(super) fn apply(&self, problem: &mut Problem, exponents: &[f64]) {
        for (joint, &alpha) in exponents.iter().enumerate() {
            let Some(column) = self.columns[joint] else {
                continue;
            };
            let target = problem.column_mut(joint, column);
            for (entry, v) in std::iter::zip(target, self.velocity.column(joint)) {
                *entry = if *v == 0.0 {
                    0.0
                } else {
                    v.signum() * v.abs().powf(alpha)
                };
            }
        }
    }
}

struct Point {
    sign: f64,
    log_speed: f64,
    friction: f64,
    weight: f64,
}

/// Weighted residual sum of squares of friction on [sign, |q̇|^α·sign, 1].
fn misfit(points: &[Point], alpha: f64) -> f64 {
    let (mut normal, mut right, mut total) = (Matrix3::zeros(), Vector3::zeros(), 0.0);
    for p in points {
        let a = Vector3::new(p.sign, p.sign * (alpha * p.log_speed).exp(), 1.0);
        normal += a * a.transpose() * p.weight;
        right += a * (p.friction * p.weight);
        total += p.friction * p.friction * p.weight;
    }
    // A trace of ridge: motion in one direction alone makes sign and offset the same.
    for i in 0..3 {
        normal[(i, i)] *= 1.0 + 1e-12;
    }
    match normal.cholesky() {
        Some(factor) => total - right.dot(&factor.solve(&right)),
        None => f64::INFINITY,
    }
}

/// Minimum of f on a range: the best of 24 even points, refined by golden section to 1e-5.
fn minimum((low, high): (f64, f64), f: impl Fn(f64) -> f64) -> f64 {
    const POINTS: usize = 24;
    let step = (high - low) / (POINTS - 1) as f64;
    let values = (0..POINTS).map(|i| f(low + step * i as f64));
    let best = values
        .enumerate()
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .map_or(0, |(i, _)| i);
    let centre = low + step * best as f64;
    let (mut a, mut b) = ((centre - step).max(low), (centre + step).min(high));
    let ratio = (5.0_f64.sqrt() - 1.0) / 2.0;
    let (mut c, mut d) = (b - ratio * (b - a), a + ratio * (b - a));
    let (mut fc, mut fd) = (f(c), f(d));
    while b - a > 1e-5 {
        if fc < fd {
            (b, d, fd) = (d, c, fc);
            c = b - ratio * (b - a);
            fc = f(c);
        } else {
            (a, c, fc) = (c, d, fd);
            d = a + ratio * (b - a);
            fd = f(d);
        }
    }
    0.5 * (a + b)
}
