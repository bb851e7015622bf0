//! Solution of one trajectory: the motion whose torque is nearest to the recorded one, under the prior on motions.
//!
//! The unknowns are the coefficients of every joint's shapes. Levenberg–Marquardt steps (Marquardt 1963) minimise
//! torque errors and coefficients, each over its standard deviation.
//!
//! One gravity torque can belong to several postures. The window of samples therefore grows from the start, where the
//! position is known, and each window begins from the solution of the one before. At the end, friction's sign is
//! sharpened, and large errors get less weight, as under Student's t.

use super::law::{Derived, Law, SOFTNESS};
use super::prior::{MotionPrior, Shapes};
use ndarray::{Array1, Array2, ArrayView2, Axis, Slice};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use signal::cholesky;
use std::sync::atomic::{AtomicBool, Ordering};

/// Length of the first window, s.
const FIRST: f64 = 6.0;
/// Time by which each window is longer than the one before, s.
const GROWS: f64 = 1.5;
/// Number of random draws for each pair of neighbouring joints.
const DRAWS: usize = 8;
/// Correlation length of torque errors, samples. So many samples count as one.
const TOGETHER: f64 = 10.0;
/// Degrees of freedom of Student's t for torque errors.
const STUDENT: f64 = 6.0;
/// Deviation of torque errors while the window grows. The first number is a factor on the deviation in motion. The
/// second is the part of the deviation at rest that is added, times the share of motions at rest.
const WIDER: [f64; 2] = [3.0, 0.5];
/// Velocity below which friction at rest takes over, rad/s (m/s).
const RESTING: f64 = 0.01;
/// Relative decrease of the cost in one step below which a stage ends.
const ENOUGH: f64 = 1e-4;
/// Damping of the Levenberg–Marquardt steps: initial value, factor between trials, lower and upper bound.
const DAMPING: [f64; 4] = [1e-2, 6.0, 1e-9, 1e8];

/// Weighting of torque errors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Weights {
    /// Weights by the prior's share of motions at rest, used while the motion itself is not yet known.
    Schedule,
    /// Weights by the motion's own velocity, lower for large errors.
    Robust,
}

/// Stage of the solution: a window of samples, and how torque errors are weighted in it.
#[derive(Clone, Copy, Debug)]
struct Stage {
    /// Velocity over which friction's sign is softened, in RMS speeds of the joint.
    softness: f64,
    /// Weighting of torque errors.
    weights: Weights,
    /// Largest number of steps.
    steps: usize,
    /// Number of samples in the window, which begins at the start.
    until: usize,
}

/// Motion found for one trajectory, with its torque.
#[derive(Clone, Debug)]
pub(super) struct Solved {
    /// Coefficient of each shape, joint by joint.
    pub coefficients: Vec<f64>,
    /// Positions, rad (m), shape (samples, joints).
    pub q: Array2<f64>,
    /// Torque of the smooth law, N·m (N), shape (samples, joints).
    pub torque: Array2<f64>,
}

/// Trajectory whose motion is to be found.
pub(super) struct Trajectory<'a> {
    /// Smooth law from motion to torque.
    pub law: &'a Law,
    /// Prior on motions.
    pub prior: &'a MotionPrior,
    /// Shapes of the prior at the samples.
    pub shapes: &'a Shapes,
    /// Recorded torque minus the part that the law does not describe, N·m (N), shape (samples, joints).
    pub torque: ArrayView2<'a, f64>,
    /// Position at the start, rad (m), by joint.
    pub start: &'a [f64],
    /// Flag that cancels the search; the motion found then must not be used.
    pub cancel: &'a AtomicBool,
}

/// State of the search: cost at some coefficients, and the normal equations of the next step.
struct State {
    /// Cost: squared torque errors and coefficients, each over its variance.
    cost: f64,
    /// Product Jᵀ·W·J of the torque errors, without the prior.
    products: Array2<f64>,
    /// Product Jᵀ·W·r of the torque errors, without the prior.
    moments: Array1<f64>,
    /// Motion of the coefficients.
    solved: Solved,
}

impl Trajectory<'_> {
    /// Motion of the trajectory, found from its start position alone.
    pub(super) fn solve(&self) -> Solved {
        let all = self.torque.nrows();
        let samples = |s: f64| (s * self.prior.rate_hz).round().max(1.0) as usize;
        let growing = |until| Stage {
            softness: 0.25,
            weights: Weights::Schedule,
            steps: 6,
            until,
        };
        let stages: Vec<Stage> = (samples(FIRST)..all)
            .step_by(samples(GROWS))
            .map(growing)
            .collect();
        let mut x = vec![0.0; self.unknowns()];
        for stage in &stages {
            x = self.descend(x, *stage).coefficients;
        }
        let whole = Stage {
            steps: 20,
            ..growing(all)
        };
        let best = self.redraw(self.lower(x, whole), whole);
        self.refine(best.solved.coefficients)
    }

    /// Search for a lower cost at other postures. The motion of two neighbouring joints is drawn at random, the cost is
    /// lowered from there, and the better result is kept.
    fn redraw(&self, mut best: State, stage: Stage) -> State {
        let (joints, kept) = (self.torque.ncols(), self.prior.shapes.len());
        let mut random = ChaCha8Rng::seed_from_u64(0);
        for first in 0..joints.saturating_sub(1) {
            for _ in 0..DRAWS {
                if self.cancel.load(Ordering::SeqCst) {
                    return best;
                }
                let mut x = best.solved.coefficients.clone();
                for (i, x) in x.iter_mut().enumerate() {
                    if (first..first + 2).contains(&(i / kept)) {
                        let normal: f64 = random.sample(StandardNormal);
                        *x = normal * self.prior.deviation[i % kept];
                    }
                }
                let other = self.lower(x, stage);
                if other.cost < best.cost {
                    best = other;
                }
            }
        }
        best
    }

    /// Motion found from coefficients that are near the solution.
    pub(super) fn refine(&self, mut x: Vec<f64>) -> Solved {
        let sharp = |softness, steps| Stage {
            softness,
            weights: Weights::Robust,
            steps,
            until: self.torque.nrows(),
        };
        x = self.descend(x, sharp(2.5 * SOFTNESS, 20)).coefficients;
        self.descend(x, sharp(SOFTNESS, 30))
    }

    /// Number of coefficients of all joints.
    fn unknowns(&self) -> usize {
        self.torque.ncols() * self.prior.shapes.len()
    }

    /// Motion after one stage from the coefficients `x`.
    fn descend(&self, x: Vec<f64>, stage: Stage) -> Solved {
        self.lower(x, stage).solved
    }

    /// State after one stage of Levenberg–Marquardt steps from the coefficients `x`.
    fn lower(&self, x: Vec<f64>, stage: Stage) -> State {
        let [mut damping, factor, least, most] = DAMPING;
        let mut state = self.state(x, stage);
        for _ in 0..stage.steps {
            let before = state.cost;
            loop {
                let next = self.step(&state, damping).map(|x| self.state(x, stage));
                match next {
                    Some(next) if next.cost < before => {
                        state = next;
                        break;
                    }
                    _ if damping > most => return state,
                    _ => damping *= factor,
                }
            }
            damping = (damping / factor).max(least);
            if before - state.cost < ENOUGH * before {
                break;
            }
        }
        state
    }

    /// Coefficients after a damped step; none where the equations cannot be solved.
    fn step(&self, state: &State, damping: f64) -> Option<Vec<f64>> {
        let (n, x) = (self.unknowns(), &state.solved.coefficients);
        let mut factor = state.products.as_slice()?.to_vec();
        let mut change = state.moments.to_vec();
        for i in 0..n {
            let precision = self.precision(i);
            let diagonal = factor[i * n + i] + precision;
            factor[i * n + i] = diagonal * (1.0 + damping);
            change[i] -= precision * x[i];
        }
        cholesky::factor(&mut factor, n)?;
        cholesky::solve(&factor, &mut change);
        Some(std::iter::zip(x, change).map(|(x, d)| x + d).collect())
    }

    /// Prior precision (inverse variance) of a coefficient.
    fn precision(&self, unknown: usize) -> f64 {
        self.prior.deviation[unknown % self.prior.shapes.len()].powi(-2)
    }

    /// State at the coefficients `x`: motion over the whole trajectory, cost and its derivatives over the stage's
    /// window.
    fn state(&self, x: Vec<f64>, stage: Stage) -> State {
        let (all, n, kept) = (
            self.torque.nrows(),
            self.torque.ncols(),
            self.prior.shapes.len(),
        );
        let motion = |shapes: &Array2<f64>| {
            let coefficients =
                ArrayView2::from_shape((n, kept), &x).unwrap_or_else(|e| unreachable!("{e}"));
            let mut table = shapes
                .slice_axis(Axis(0), Slice::from(..all))
                .dot(&coefficients.t());
            for (mut column, scale) in table.columns_mut().into_iter().zip(&self.prior.scale) {
                column *= *scale;
            }
            table
        };
        let mut q = motion(&self.shapes.q);
        for (mut column, start) in q.columns_mut().into_iter().zip(self.start) {
            column += *start;
        }
        let (qd, qdd) = (motion(&self.shapes.qd), motion(&self.shapes.qdd));
        let mut torque = Array2::zeros((all, n));
        let mut rows = Array2::zeros((stage.until * n, n * kept));
        let mut errors = Array1::zeros(stage.until * n);
        let mut at = Derived::new(self.law.robot());
        let mut cost = 0.0;
        let [mut p, mut v, mut a] = [vec![0.0; n], vec![0.0; n], vec![0.0; n]];
        for k in 0..all {
            for j in 0..n {
                (p[j], v[j], a[j]) = (q[[k, j]], qd[[k, j]], qdd[[k, j]]);
            }
            self.law.derive(&p, &v, &a, stage.softness, &mut at);
            torque.row_mut(k).assign(
                &ArrayView2::from_shape((1, n), &at.torque)
                    .unwrap_or_else(|e| unreachable!("{e}"))
                    .row(0),
            );
            if k >= stage.until {
                continue;
            }
            for i in 0..n {
                let error = self.torque[[k, i]] - at.torque[i];
                let (share, weight) = self.weigh(i, k, v[i], error, stage.weights);
                cost += share;
                let root = weight.sqrt();
                errors[k * n + i] = error * root;
                let mut row = rows.row_mut(k * n + i);
                for j in 0..n {
                    let by = |d: usize| at.by[d][i * n + j] * self.prior.scale[j] * root;
                    let [by_q, by_qd, by_qdd] = [by(0), by(1), by(2)];
                    for b in 0..kept {
                        row[j * kept + b] = by_q * self.shapes.q[[k, b]]
                            + by_qd * self.shapes.qd[[k, b]]
                            + by_qdd * self.shapes.qdd[[k, b]];
                    }
                }
            }
        }
        cost += (0..x.len())
            .map(|i| self.precision(i) * x[i] * x[i])
            .sum::<f64>();
        State {
            cost,
            products: rows.t().dot(&rows),
            moments: rows.t().dot(&errors),
            solved: Solved {
                coefficients: x,
                q,
                torque,
            },
        }
    }

    /// Cost of one torque error, and its weight in the normal equations.
    fn weigh(
        &self,
        joint: usize,
        sample: usize,
        speed: f64,
        error: f64,
        weights: Weights,
    ) -> (f64, f64) {
        let f = &self.law.friction[joint];
        match weights {
            Weights::Schedule => {
                let deviation =
                    WIDER[0] * f.moving + WIDER[1] * f.standing * self.prior.standing[sample];
                let weight = deviation.powi(-2) / TOGETHER;
                (error * error * weight, weight)
            }
            Weights::Robust => {
                let rest = (-(speed / RESTING).powi(2)).exp();
                let variance = f.moving.powi(2) + rest * f.standing.powi(2);
                let square = error * error / variance;
                let cost = (STUDENT + 1.0) * (square / STUDENT).ln_1p() / TOGETHER;
                (
                    cost,
                    (STUDENT + 1.0) / (STUDENT + square) / variance / TOGETHER,
                )
            }
        }
    }
}
