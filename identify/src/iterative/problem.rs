//! The rows of an identification problem, joint by joint.

use crate::least_squares::{Gram, LeastSquaresError, check_size};
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::{Accum, Mat, MatRef, Par};
use ndarray::{Array2, ArrayView1, ArrayView2};
use std::ops::Range;

/// Number of samples handled at once: a block of 60 columns is 0.5 MB, within the second-level cache.
const BLOCK: usize = 1024;

/// Torque of all joints as a linear function of the parameters, for every sample.
///
/// Stored joint by joint, so that whitening across joints (eq. 18) is a sum of whole blocks.
#[derive(Debug, Clone)]
pub struct Problem {
    /// Regressor and torque of each joint, samples × (p + 1), column-major, the torque last.
    joints: Vec<Mat<f64>>,
    /// Zero for rows left out, one for the others, samples × N.
    kept: Array2<f64>,
}

impl Problem {
    /// Problem from the stacked regressor (samples·N × p, the N rows of a sample together, joints in order: eq.
    /// 7) and the torques in the same order (eq. 8).
    ///
    /// # Errors
    /// Sizes that do not agree (rows must be a multiple of `dof`), no rows, values that are not finite.
    pub fn new(
        regressor: ArrayView2<f64>,
        torque: ArrayView1<f64>,
        dof: usize,
    ) -> Result<Self, LeastSquaresError> {
        check_size("the torque", torque.len(), regressor.nrows())?;
        if dof == 0 || torque.is_empty() {
            return Err(LeastSquaresError::NoRows);
        }
        let samples = regressor.nrows() / dof;
        check_size("the regressor", regressor.nrows(), samples * dof)?;
        let p = regressor.ncols();
        let joints: Vec<Mat<f64>> = (0..dof)
            .map(|joint| {
                Mat::from_fn(samples, p + 1, |k, j| {
                    let row = k * dof + joint;
                    if j < p {
                        regressor[(row, j)]
                    } else {
                        torque[row]
                    }
                })
            })
            .collect();
        Self::of_joints(joints)
    }

    /// Problem from the rows of each joint: samples × (p + 1), the torque last.
    ///
    /// # Errors
    /// Tables of different sizes, no rows, values that are not finite.
    pub fn of_joints(joints: Vec<Mat<f64>>) -> Result<Self, LeastSquaresError> {
        let (samples, width) = joints.first().map_or((0, 0), |m| (m.nrows(), m.ncols()));
        if samples == 0 || width == 0 {
            return Err(LeastSquaresError::NoRows);
        }
        for joint in &joints {
            check_size("a joint's table", joint.nrows(), samples)?;
            check_size("a joint's rows", joint.ncols(), width)?;
        }
        if joints.iter().any(|m| !m.is_all_finite()) {
            return Err(LeastSquaresError::NotFinite);
        }
        let kept = Array2::ones((samples, joints.len()));
        Ok(Self { joints, kept })
    }

    /// Excludes the row of one joint at one sample from every fit.
    ///
    /// # Panics
    /// A sample or joint that does not exist.
    pub fn leave_out(&mut self, sample: usize, joint: usize) {
        self.kept[(sample, joint)] = 0.0;
    }

    /// Weights to start from: zero for rows left out, one for the others.
    pub(super) fn kept(&self) -> &Array2<f64> {
        &self.kept
    }

    /// Number of joints N of the robot.
    pub fn dof(&self) -> usize {
        self.joints.len()
    }

    /// Number of samples of each joint.
    pub fn samples(&self) -> usize {
        self.joints[0].nrows()
    }

    /// Number of parameters p of the model.
    pub fn columns(&self) -> usize {
        self.joints[0].ncols() - 1
    }

    /// Measured less predicted torque, samples × N.
    pub(super) fn residual(&self, parameters: &[f64]) -> Array2<f64> {
        let mut residual = Array2::zeros((self.samples(), self.dof()));
        for (joint, rows) in self.joints.iter().enumerate() {
            let e = residual_of(rows.as_ref(), parameters);
            for (k, e) in e.into_iter().enumerate() {
                residual[(k, joint)] = e;
            }
        }
        residual
    }

    /// Passes the weighted, whitened rows Ω^(−1/2) W^(1/2) [Y τ] (eqs 18, 22; `root` is Ω^(−1/2)) of some samples to
    /// `visit` block by block, each (rows × p + 1, torque last) with the number of its rows that have weight.
    pub(super) fn whitened_blocks(
        &self,
        within: Range<usize>,
        root: &Mat<f64>,
        weights: &Array2<f64>,
        mut visit: impl FnMut(MatRef<'_, f64>, usize),
    ) {
        let (n, width) = (self.dof(), self.columns() + 1);
        let mut buffer = Mat::zeros(BLOCK.min(within.len()), width);
        // Factor of each joint's rows in the whitened row at hand: Ω^(−1/2)_ik √w_k.
        let mut factors = vec![[0.0; BLOCK]; n];
        for first in within.clone().step_by(BLOCK) {
            let rows = BLOCK.min(within.end - first);
            for i in 0..n {
                let live = (first..first + rows).filter(|&k| weights[(k, i)] > 0.0);
                let live = live.count();
                for (k, factor) in factors.iter_mut().enumerate() {
                    for (s, f) in factor[..rows].iter_mut().enumerate() {
                        *f = root[(i, k)] * weights[(first + s, k)].sqrt();
                    }
                }
                for j in 0..width {
                    let target = &mut buffer.col_as_slice_mut(j)[..rows];
                    target.fill(0.0);
                    for (k, joint) in self.joints.iter().enumerate() {
                        if root[(i, k)] == 0.0 {
                            continue;
                        }
                        let source = &joint.col_as_slice(j)[first..first + rows];
                        let terms = std::iter::zip(source, &factors[k]);
                        for (t, (s, f)) in std::iter::zip(target.iter_mut(), terms) {
                            *t += f * s;
                        }
                    }
                }
                visit(buffer.as_ref().subrows(0, rows), live);
            }
        }
    }

    /// Normal equations of the whitened, weighted rows.
    pub(super) fn gram(&self, root: &Mat<f64>, weights: &Array2<f64>) -> Gram {
        self.gram_of(0..self.samples(), root, weights)
    }

    /// Normal equations as by [`Problem::gram`], for each of up to `most` blocks of consecutive samples, of at
    /// least eight samples.
    pub(super) fn block_grams(
        &self,
        root: &Mat<f64>,
        weights: &Array2<f64>,
        most: usize,
    ) -> Vec<Gram> {
        let size = self.samples().div_ceil(most).max(8);
        (0..self.samples())
            .step_by(size)
            .map(|first| {
                let samples = first..(first + size).min(self.samples());
                self.gram_of(samples, root, weights)
            })
            .collect()
    }

    fn gram_of(&self, samples: Range<usize>, root: &Mat<f64>, weights: &Array2<f64>) -> Gram {
        let width = self.columns() + 1;
        let mut products = Mat::<f64>::zeros(width, width);
        let mut rows = 0;
        self.whitened_blocks(samples, root, weights, |block, live| {
            rows += live;
            triangular::matmul(
                products.as_mut(),
                BlockStructure::TriangularLower,
                Accum::Add,
                block.transpose(),
                BlockStructure::Rectangular,
                block,
                BlockStructure::Rectangular,
                1.0,
                Par::Seq,
            );
        });
        let symmetric = Mat::from_fn(width, width, |i, j| products[(i.max(j), i.min(j))]);
        Gram::from_products(symmetric, rows)
    }

    /// One column of one joint's rows, to be overwritten.
    pub(super) fn column_mut(&mut self, joint: usize, column: usize) -> &mut [f64] {
        self.joints[joint].col_as_slice_mut(column)
    }

    /// One column of one joint's rows.
    pub(super) fn column(&self, joint: usize, column: usize) -> &[f64] {
        self.joints[joint].col_as_slice(column)
    }
}

fn residual_of(rows: MatRef<'_, f64>, parameters: &[f64]) -> Vec<f64> {
    let p = parameters.len();
    let mut e: Vec<f64> = rows.col(p).iter().copied().collect();
    for (j, &x) in parameters.iter().enumerate() {
        if x == 0.0 {
            continue;
        }
        for (e, a) in std::iter::zip(&mut e, rows.col(j).iter()) {
            *e -= a * x;
        }
    }
    e
}
