//! Structure in a residual that the catalogue does not explain.
//!
//! Judged away from reversals, where not even the true plant's model reaches the noise. Two signs of structure
//! on each joint: autocorrelation beyond the low-pass's memory, and error that a flexible learner (ridge
//! regression on products of motions of all joints) predicts on trajectories left out.

use crate::algebra::cholesky::Cholesky;
use crate::motion::frame::Frame;
use crate::motion::scene::soft_sign;
use crate::settings::Settings;
use ndarray::{Array1, Array2, Axis};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use signal::spectrum::rephased;
use std::f64::consts::TAU;
use std::ops::Range;

/// Lags beyond the autocorrelation of filtered noise, s. Several, because an oscillation is uncorrelated at some of them.
const LAGS: [f64; 6] = [0.08, 0.1, 0.125, 0.16, 0.2, 0.26];
/// Ridge penalty of the learner relative to the number of rows.
const RIDGE: f64 = 3e-3;

/// Structure in the residual of a joint, relative to the deviation of its torque.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Misfit {
    /// Root mean squared error away from reversals, N·m (N).
    pub error: f64,
    /// Part of the structure's square that is correlated over 80 ms or longer.
    pub lasting: f64,
    /// Part of the structure's square that the learner predicts on folds left out.
    pub learnable: f64,
    /// Number of rows away from reversals.
    pub rows: usize,
}

impl Misfit {
    /// Root mean square of the error's structured part, relative to the torque.
    pub fn structured(&self) -> f64 {
        self.error * self.lasting.max(self.learnable).max(0.0).sqrt()
    }
}

/// Structure of a residual at the recorded samples, shape (samples, joints), away from reversals and from
/// `skipped` rows. None for a joint with too few other rows.
pub fn examine(
    frame: &Frame,
    residual: &Array2<f64>,
    skipped: &[bool],
    settings: &Settings,
) -> Vec<Option<Misfit>> {
    let r = frame.table_thin(residual);
    let inputs = Inputs::new(frame);
    let kept = kept(frame, skipped, settings);
    let each = kept.into_par_iter().enumerate();
    each.map(|(j, kept)| Some(one(frame, j, &r.column(j).to_owned(), &kept?, &inputs)))
        .collect()
}

/// Rows of each joint away from reversals and from `skipped` ones; none where they are too few.
fn kept(frame: &Frame, skipped: &[bool], settings: &Settings) -> Vec<Option<Vec<usize>>> {
    let reversal = frame.reversals(&settings.motion);
    let fewest = settings.traces.structure.fewest_rows;
    let of = |j: usize| -> Vec<usize> {
        (0..frame.len())
            .filter(|&i| !reversal[[i, j]] && !skipped[i])
            .collect()
    };
    (0..frame.dof())
        .map(|j| Some(of(j)).filter(|rows| rows.len() >= fewest))
        .collect()
}

fn one(frame: &Frame, joint: usize, r: &Array1<f64>, kept: &[usize], inputs: &Inputs) -> Misfit {
    let deviation = frame.tau.column(joint).std(0.0).max(1e-12);
    let square = kept.iter().map(|&i| r[i] * r[i]).sum::<f64>() / kept.len() as f64;
    let mut is_kept = vec![false; frame.len()];
    kept.iter().for_each(|&i| is_kept[i] = true);
    let correlation = |lag: f64| {
        let lag = (lag * frame.row_rate()).round().max(1.0) as usize;
        let pairs = frame
            .rows
            .iter()
            .flat_map(|t| t.start..t.end.saturating_sub(lag));
        let (sum, n) = pairs
            .filter(|&i| is_kept[i] && is_kept[i + lag])
            .fold((0.0, 0usize), |(s, n), i| (s + r[i] * r[i + lag], n + 1));
        (sum / n.max(1) as f64 / square).abs()
    };
    let lasting = LAGS
        .into_iter()
        .map(correlation)
        .fold(0.0, f64::max)
        .min(1.0);
    let own = r.select(Axis(0), kept).insert_axis(Axis(1));
    let learner = Learner::new(frame, joint, kept, inputs);
    Misfit {
        error: square.sqrt() / deviation,
        lasting,
        learnable: learner.predicted(&own)[0],
        rows: kept.len(),
    }
}

/// Motion on the rows as the learner's inputs, scaled to unit deviation, each of shape (rows, joints).
struct Inputs {
    q: Array2<f64>,
    qd: Array2<f64>,
    sign: Array2<f64>,
    qdd: Array2<f64>,
}

impl Inputs {
    fn new(frame: &Frame) -> Self {
        let m = frame.samples();
        let rows = |t: &Array2<f64>| {
            let mut out = Array2::zeros((frame.len(), t.ncols()));
            for (j, c) in t.columns().into_iter().enumerate() {
                out.column_mut(j)
                    .assign(&Array1::from(frame.pick(|i| c[i])));
            }
            out
        };
        let scaled = |mut t: Array2<f64>| {
            for mut c in t.columns_mut() {
                let s = c.std(0.0).max(1e-9);
                c.mapv_inplace(|x| x / s);
            }
            t
        };
        let qd = rows(&m.qd);
        Self {
            q: rows(&m.q),
            sign: qd.mapv(soft_sign),
            qd: scaled(qd),
            qdd: scaled(rows(&m.qdd)),
        }
    }

    /// Features of a joint, shape (rows, features): curves of its own motion, and products with every other joint's motion.
    fn features(&self, joint: usize, kept: &[usize]) -> Array2<f64> {
        let n = self.q.ncols();
        let mut rows = Vec::new();
        for &i in kept {
            let (q, v, s, a) = (
                self.q[[i, joint]],
                self.qd[[i, joint]],
                self.sign[[i, joint]],
                self.qdd[[i, joint]],
            );
            rows.extend([
                1.0,
                v,
                s,
                a,
                v.abs(),
                v * v * s,
                v * v * v,
                s * (-3.0 * v.abs()).exp(),
                s * (-12.0 * v.abs()).exp(),
            ]);
            for k in 1..=4 {
                let (sin, cos) = (f64::from(k) * q).sin_cos();
                rows.extend([sin, cos, s * sin, s * cos, v * sin, v * cos]);
            }
            for k in (0..n).filter(|&k| k != joint) {
                let (p, w, t, b) = (
                    self.q[[i, k]],
                    self.qd[[i, k]],
                    self.sign[[i, k]],
                    self.qdd[[i, k]],
                );
                let (sin, cos) = p.sin_cos();
                rows.extend([
                    w,
                    t,
                    b,
                    v * w,
                    s * w.abs(),
                    v * w.abs(),
                    s * t,
                    w * w,
                    s * w * w,
                    v.abs() * t,
                    s * b,
                    v * b,
                ]);
                rows.extend([sin, cos, s * sin, s * cos, v * sin, v * cos]);
            }
        }
        let width = rows.len() / kept.len();
        Array2::from_shape_vec((kept.len(), width), rows).expect("every row has the same features")
    }
}

/// The learner of one joint, fitted without each fold in turn.
struct Learner {
    x: Array2<f64>,
    /// Of each fold: its rows among the kept ones, the rows near it, which are not fitted either, and the equations of
    /// all others.
    folds: Vec<(Vec<usize>, Vec<usize>, Cholesky)>,
}

impl Learner {
    fn new(frame: &Frame, joint: usize, kept: &[usize], inputs: &Inputs) -> Self {
        let mut x = inputs.features(joint, kept);
        for mut c in x.columns_mut() {
            let scale = (c.dot(&c) / kept.len() as f64).sqrt().max(1e-9);
            c.mapv_inplace(|v| v / scale);
        }
        let within = |ranges: &[Range<usize>]| -> Vec<usize> {
            (0..kept.len())
                .filter(|&k| ranges.iter().any(|t| t.contains(&kept[k])))
                .collect()
        };
        let squares = |rows: &[usize]| {
            let x = x.select(Axis(0), rows);
            x.t().dot(&x)
        };
        let all = x.t().dot(&x);
        let folds = frame.folds().iter().map(|fold| {
            let (own, near) = (within(&fold.scored), within(&fold.near));
            let mut a = &all - &squares(&own) - squares(&near);
            for i in 0..x.ncols() {
                a[[i, i]] += RIDGE * kept.len() as f64;
            }
            (own, near, Cholesky::new(&a))
        });
        Self {
            folds: folds.collect(),
            x,
        }
    }

    /// Part of the squared error that is predicted on folds left out, for each column of `y`, shape (kept rows,
    /// residuals). Below zero where the prediction is worse than zero.
    fn predicted(&self, y: &Array2<f64>) -> Vec<f64> {
        let products = |rows: &[usize]| {
            let x = self.x.select(Axis(0), rows);
            x.t().dot(&y.select(Axis(0), rows))
        };
        let all = self.x.t().dot(y);
        let (mut left, mut size) = (vec![0.0; y.ncols()], vec![0.0; y.ncols()]);
        for (own, near, equations) in &self.folds {
            let mut b = &all - &products(own) - products(near);
            for mut column in b.columns_mut() {
                let beta = equations.solve(column.view());
                column.assign(&beta);
            }
            let y = y.select(Axis(0), own);
            let rest = &y - &self.x.select(Axis(0), own).dot(&b);
            for c in 0..y.ncols() {
                left[c] += rest.column(c).dot(&rest.column(c));
                size[c] += y.column(c).dot(&y.column(c));
            }
        }
        let part = |(left, size): (f64, f64)| if size > 0.0 { 1.0 - left / size } else { 0.0 };
        left.into_iter().zip(size).map(part).collect()
    }
}

/// Probability that the learnable part of some joint exceeds the level by chance.
const RARE: f64 = 0.01;
/// Seed of the residuals with other phases.
const SEED: u64 = 0x5EED;

/// Level of the learnable part by chance, by joint: what the learner predicts of residuals with the same spectrum that
/// do not follow the motion. None as in [`examine`], whose arguments these are.
pub fn by_chance(
    frame: &Frame,
    residual: &Array2<f64>,
    skipped: &[bool],
    settings: &Settings,
) -> Vec<Option<f64>> {
    let r = frame.table_thin(residual);
    let inputs = Inputs::new(frame);
    // The largest of so many is exceeded with the probability, shared among the joints.
    let draws = (frame.dof() as f64 / RARE).round() as usize - 1;
    let of = |(j, kept): (usize, Option<Vec<usize>>)| {
        let kept = kept?;
        let learner = Learner::new(frame, j, &kept, &inputs);
        let mut rng = ChaCha8Rng::seed_from_u64(SEED);
        rng.set_stream(j as u64);
        let own = r.column(j).to_vec();
        let mut drawn = Array2::zeros((kept.len(), draws));
        for mut column in drawn.columns_mut() {
            let mut other = vec![0.0; own.len()];
            for rows in &frame.rows {
                let phase = || rng.random_range(0.0..TAU);
                other[rows.clone()].copy_from_slice(&rephased(&own[rows.clone()], phase));
            }
            for (to, &row) in column.iter_mut().zip(&kept) {
                *to = other[row];
            }
        }
        learner.predicted(&drawn).into_iter().reduce(f64::max)
    };
    let kept = kept(frame, skipped, settings);
    kept.into_par_iter().enumerate().map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use datasets::{PrepareOptions, Recording};

    /// A minute of two joints at 100 Hz.
    fn frame() -> Frame {
        let time: Vec<f64> = (0..6000).map(|i| 0.01 * f64::from(i)).collect();
        let q = Array2::from_shape_fn((time.len(), 2), |(i, j)| {
            let t = time[i];
            (0.7 * t + j as f64).sin() + 0.5 * (1.9 * t - 0.3 * j as f64).sin()
        });
        let tau = q.mapv(|x| 10.0 * x);
        let recording = Recording::new("two sines", time, q, Some(tau.clone()));
        Frame::new(&recording, tau, &PrepareOptions::low_passed(20.0)).unwrap()
    }

    #[test]
    fn a_function_of_motion_is_learned_and_noise_is_not() {
        let frame = frame();
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let q = &frame.samples().q;
        // A torque over the other joint's position, and uniform noise.
        let residual = Array2::from_shape_fn(q.dim(), |(i, j)| match j {
            0 => q[[i, 1]].sin(),
            _ => rng.random::<f64>() - 0.5,
        });
        let skipped = vec![false; frame.len()];
        let found = examine(&frame, &residual, &skipped, &Settings::default());
        let (learned, noise) = (found[0].unwrap(), found[1].unwrap());
        assert!(
            learned.learnable > 0.98 && learned.lasting > 0.9,
            "{learned:?}"
        );
        assert!(noise.learnable < 0.02 && noise.lasting < 0.2, "{noise:?}");
        assert!((learned.structured() / learned.error - 1.0).abs() < 0.02);
        // A slow wave that comes from elsewhere is learned in part by accident, a function of the motion beyond that.
        let slow = Array2::from_shape_fn(q.dim(), |(i, _)| (0.0021 * i as f64).sin());
        let level = |r: &Array2<f64>| by_chance(&frame, r, &skipped, &Settings::default());
        let learnable = |r: &Array2<f64>| {
            examine(&frame, r, &skipped, &Settings::default())[0]
                .unwrap()
                .learnable
        };
        assert!(learnable(&residual) > level(&residual)[0].unwrap());
        assert!(learnable(&slow) < level(&slow)[0].unwrap());
        // Where all rows are left out nothing is said.
        let none = examine(
            &frame,
            &residual,
            &vec![true; frame.len()],
            &Settings::default(),
        );
        assert_eq!(none, [None, None]);
    }

    #[test]
    fn structure_is_the_larger_of_both_signs() {
        let misfit = Misfit {
            error: 0.02,
            lasting: 0.25,
            learnable: -0.1,
            rows: 500,
        };
        assert!((misfit.structured() - 0.01).abs() < 1e-15);
        let learned = Misfit {
            learnable: 0.64,
            ..misfit
        };
        assert!((learned.structured() - 0.016).abs() < 1e-15);
    }
}
