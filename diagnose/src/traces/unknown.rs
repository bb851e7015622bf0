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
use rayon::prelude::*;
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
    let mut reversal = frame.reversals(&settings.motion);
    for (mut row, _) in reversal
        .rows_mut()
        .into_iter()
        .zip(skipped)
        .filter(|r| *r.1)
    {
        row.fill(true);
    }
    let inputs = Inputs::new(frame);
    let fewest = settings.traces.structure.fewest_rows;
    (0..frame.dof())
        .into_par_iter()
        .map(|j| {
            let kept: Vec<usize> = (0..r.nrows()).filter(|&i| !reversal[[i, j]]).collect();
            let own = r.column(j).to_owned();
            (kept.len() >= fewest).then(|| one(frame, j, &own, &reversal, &kept, &inputs))
        })
        .collect()
}

fn one(
    frame: &Frame,
    joint: usize,
    r: &Array1<f64>,
    reversal: &Array2<bool>,
    kept: &[usize],
    inputs: &Inputs,
) -> Misfit {
    let deviation = frame.tau.column(joint).std(0.0).max(1e-12);
    let square = kept.iter().map(|&i| r[i] * r[i]).sum::<f64>() / kept.len() as f64;
    let correlation = |lag: f64| {
        let lag = (lag * frame.row_rate()).round().max(1.0) as usize;
        let pairs = frame
            .rows
            .iter()
            .flat_map(|t| t.start..t.end.saturating_sub(lag));
        let (sum, n) = pairs
            .filter(|&i| !reversal[[i, joint]] && !reversal[[i + lag, joint]])
            .fold((0.0, 0usize), |(s, n), i| (s + r[i] * r[i + lag], n + 1));
        (sum / n.max(1) as f64 / square).abs()
    };
    let lasting = LAGS
        .into_iter()
        .map(correlation)
        .fold(0.0, f64::max)
        .min(1.0);
    Misfit {
        error: square.sqrt() / deviation,
        lasting,
        learnable: learnable(frame, joint, r, kept, inputs),
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

/// Part of the squared error that ridge regression predicts on folds left out; below zero where it predicts worse than zero.
fn learnable(frame: &Frame, joint: usize, r: &Array1<f64>, kept: &[usize], inputs: &Inputs) -> f64 {
    let mut x = inputs.features(joint, kept);
    for mut c in x.columns_mut() {
        let scale = (c.dot(&c) / kept.len() as f64).sqrt().max(1e-9);
        c.mapv_inplace(|v| v / scale);
    }
    let y: Array1<f64> = kept.iter().map(|&i| r[i]).collect();
    let of = |ranges: &[Range<usize>]| {
        let rows: Vec<usize> = (0..kept.len())
            .filter(|&k| ranges.iter().any(|t| t.contains(&kept[k])))
            .collect();
        let xf = x.select(Axis(0), &rows);
        let yf = y.select(Axis(0), &rows);
        (rows, xf.t().dot(&xf), xf.t().dot(&yf))
    };
    let folds = frame.folds();
    let parts: Vec<(Vec<usize>, Array2<f64>, Array1<f64>)> =
        folds.iter().map(|fold| of(&fold.scored)).collect();
    let (mut left, mut all) = (0.0, 0.0);
    for (f, (rows, _, _)) in parts.iter().enumerate() {
        let mut a = Array2::<f64>::zeros((x.ncols(), x.ncols()));
        let mut b = Array1::<f64>::zeros(x.ncols());
        for (_, xx, xy) in parts
            .iter()
            .enumerate()
            .filter(|(g, _)| *g != f)
            .map(|(_, p)| p)
        {
            a += xx;
            b += xy;
        }
        if !folds[f].near.is_empty() {
            let (_, xx, xy) = of(&folds[f].near);
            a -= &xx;
            b -= &xy;
        }
        for i in 0..x.ncols() {
            a[[i, i]] += RIDGE * kept.len() as f64;
        }
        let beta = Cholesky::new(&a).solve(b.view());
        for &k in rows {
            let e = y[k] - x.row(k).dot(&beta);
            left += e * e;
            all += y[k] * y[k];
        }
    }
    if all > 0.0 { 1.0 - left / all } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use datasets::{PrepareOptions, Recording};
    use rand::{RngExt, SeedableRng};

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
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(3);
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
