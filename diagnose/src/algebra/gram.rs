//! Sums of products: all information on the samples that forward selection needs.
//!
//! Every column of the dictionary is a torque per unit of its parameter, on the rows of some
//! joints. For each fold (a group of whole trajectories) and each joint the products of the
//! columns that touch that joint are formed once; every fit, leave-one-fold-out error and share
//! afterwards is algebra on them, independent of the number of samples.

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};
use ndarray::{Array1, Array2, ArrayView1, ArrayView2, Axis};
use std::ops::Index;

/// Symmetric matrix, of which the lower triangle is stored, row by row.
#[derive(Clone, Debug)]
pub struct Symmetric {
    /// Number of rows.
    size: usize,
    values: Vec<f64>,
}

/// Number of rows of a product that are computed at once, and of samples that are summed at once.
const BLOCK: usize = 64;
const SAMPLES: usize = 512;

impl Symmetric {
    /// Matrix of zeros.
    pub fn zeros(size: usize) -> Self {
        Self {
            size,
            values: vec![0.0; size * (size + 1) / 2],
        }
    }

    /// Matrix with the elements `of` row and column, which is not less than the column.
    pub fn from_fn(size: usize, mut of: impl FnMut(usize, usize) -> f64) -> Self {
        let rows = (0..size).flat_map(|i| (0..=i).map(move |k| (i, k)));
        Self {
            size,
            values: rows.map(|(i, k)| of(i, k)).collect(),
        }
    }

    /// Elements of a row up to the diagonal.
    pub fn row(&self, row: usize) -> &[f64] {
        &self.values[row * (row + 1) / 2..][..=row]
    }

    /// Some of its columns, shape (rows, places).
    pub fn columns(&self, places: &[usize]) -> Array2<f64> {
        Array2::from_shape_fn((self.size, places.len()), |(i, k)| self[[i, places[k]]])
    }

    fn add(&mut self, other: &Self) {
        let each = self.values.iter_mut().zip(&other.values);
        each.for_each(|(sum, x)| *sum += x);
    }

    /// Adds X·Xᵀ of a table X in standard layout.
    fn add_outer(&mut self, x: &Array2<f64>) {
        let n = x.ncols();
        let values = x.as_slice().expect("a new table is in standard layout");
        let mut product = Vec::new();
        let mut rest = &mut self.values[..];
        for first in (0..self.size).step_by(BLOCK) {
            let end = (first + BLOCK).min(self.size);
            product.resize((end - first) * end, 0.0);
            matmul(
                MatMut::from_row_major_slice_mut(&mut product, end - first, end),
                Accum::Replace,
                MatRef::from_row_major_slice(&values[first * n..end * n], end - first, n),
                MatRef::from_row_major_slice(&values[..end * n], end, n).transpose(),
                1.0,
                Par::Seq,
            );
            for (row, product) in (first..end).zip(product.chunks_exact(end)) {
                let (own, further) = rest.split_at_mut(row + 1);
                own.iter_mut().zip(product).for_each(|(sum, x)| *sum += x);
                rest = further;
            }
        }
    }
}

impl Index<[usize; 2]> for Symmetric {
    type Output = f64;

    fn index(&self, [i, k]: [usize; 2]) -> &f64 {
        let (row, column) = if i < k { (k, i) } else { (i, k) };
        &self.values[row * (row + 1) / 2 + column]
    }
}

/// Sums of products of one joint's rows in one fold: XᵀX, Xᵀy, yᵀy with X (samples, active columns of the
/// joint) and y the torque to explain.
#[derive(Clone, Debug)]
pub struct JointGram {
    /// Matrix XᵀX, shape (active columns, active columns).
    pub xx: Symmetric,
    /// Vector Xᵀy, by active column.
    pub xy: Array1<f64>,
    /// Sum of squares of the target, yᵀy.
    pub yy: f64,
    /// Sum of the row weights; the number of samples where all weigh one.
    pub samples: f64,
}

impl JointGram {
    /// Sums over no rows.
    pub fn zeros(columns: usize) -> Self {
        Self {
            xx: Symmetric::zeros(columns),
            xy: Array1::zeros(columns),
            yy: 0.0,
            samples: 0.0,
        }
    }

    /// Sums of products of the rows `x` and `y`, each row multiplied by its weight.
    pub fn new(x: ArrayView2<f64>, y: ArrayView1<f64>, weight: ArrayView1<f64>) -> Self {
        let mut out = Self::zeros(x.ncols());
        out.add_rows(x.t(), y, weight);
        out
    }

    /// Adds the products of further rows: of columns `x`, shape (columns, rows), and the target `y`, each row multiplied
    /// by its weight.
    pub fn add_rows(&mut self, x: ArrayView2<f64>, y: ArrayView1<f64>, weight: ArrayView1<f64>) {
        for start in (0..y.len()).step_by(SAMPLES) {
            let some = start..(start + SAMPLES).min(y.len());
            let cut = |x: ArrayView1<f64>| x.slice_axis(Axis(0), some.clone().into()).to_owned();
            let (y, weight) = (cut(y), cut(weight));
            let root = weight.mapv(f64::sqrt);
            let x = Array2::from_shape_vec(
                (x.nrows(), some.len()),
                x.slice_axis(Axis(1), some.clone().into())
                    .rows()
                    .into_iter()
                    .flat_map(|row| row.into_iter().zip(&root).map(|(x, r)| x * r))
                    .collect(),
            )
            .expect("every column has its rows");
            let y = &y * &root;
            self.xy += &x.dot(&y);
            self.yy += y.dot(&y);
            self.samples += weight.sum();
            self.xx.add_outer(&x);
        }
    }

    fn add(&mut self, other: &Self) {
        self.xx.add(&other.xx);
        self.xy += &other.xy;
        self.yy += other.yy;
        self.samples += other.samples;
    }
}

/// Joints that each column touches.
#[derive(Clone, Debug)]
pub struct Layout {
    /// Columns with entries in a joint's rows, ascending, by joint.
    pub active: Vec<Vec<usize>>,
    position: Vec<Vec<Option<usize>>>,
}

impl Layout {
    /// Layout from the joints that each column touches.
    pub fn new(dof: usize, joints_of: &[Vec<usize>]) -> Self {
        let mut active = vec![Vec::new(); dof];
        let mut position = vec![vec![None; joints_of.len()]; dof];
        for (column, joints) in joints_of.iter().enumerate() {
            for &joint in joints {
                position[joint][column] = Some(active[joint].len());
                active[joint].push(column);
            }
        }
        Self { active, position }
    }

    /// Place of `column` among the active columns of `joint`.
    pub fn position(&self, joint: usize, column: usize) -> Option<usize> {
        self.position[joint][column]
    }

    /// Number of joints of the robot.
    pub fn dof(&self) -> usize {
        self.active.len()
    }
}

/// Sums of products of all folds, and their sum.
#[derive(Clone, Debug)]
pub struct Grams {
    /// Joints that each column touches.
    pub layout: Layout,
    /// Sums of products by fold and joint.
    pub folds: Vec<Vec<JointGram>>,
    /// Sums of products of the rows that are not fitted where a fold is scored, by fold and joint: the fold and
    /// the rows near it. None where no rows are near.
    pub(super) apart: Option<Vec<Vec<JointGram>>>,
    /// Sum over folds, by joint.
    pub total: Vec<JointGram>,
}

impl Grams {
    /// Sums over folds; there must be at least one fold.
    pub fn new(layout: Layout, folds: Vec<Vec<JointGram>>) -> Self {
        let mut total = folds[0].clone();
        for fold in &folds[1..] {
            for (sum, joint) in total.iter_mut().zip(fold) {
                sum.add(joint);
            }
        }
        Self {
            layout,
            folds,
            apart: None,
            total,
        }
    }

    /// Sums of products with those of the rows near each fold, which belong to other folds as well.
    pub fn with_near(self, mut near: Vec<Vec<JointGram>>) -> Self {
        for (near, fold) in near.iter_mut().zip(&self.folds) {
            for (sum, joint) in near.iter_mut().zip(fold) {
                sum.add(joint);
            }
        }
        Self {
            apart: Some(near),
            ..self
        }
    }

    /// Sums of products of one joint's rows that are not fitted where a fold is scored.
    pub fn apart(&self, fold: usize, joint: usize) -> &JointGram {
        &self.apart.as_ref().unwrap_or(&self.folds)[fold][joint]
    }

    /// Whether rows of other folds are near some fold.
    pub fn has_near(&self) -> bool {
        self.apart.is_some()
    }

    /// All sums of products; some rows are in several of them.
    pub fn each_mut(&mut self) -> impl Iterator<Item = &mut Vec<JointGram>> {
        let apart = self.apart.iter_mut().flatten();
        self.folds.iter_mut().chain([&mut self.total]).chain(apart)
    }

    /// Number of joints of the robot.
    pub fn dof(&self) -> usize {
        self.layout.dof()
    }

    /// Root mean square of a column over the rows of the joints it touches, in N·m per unit of its
    /// parameter; taken over its strongest joint relative to `scale` (N·m, one per joint).
    pub fn column_rms(&self, column: usize, scale: &[f64]) -> f64 {
        (0..self.dof())
            .filter_map(|j| {
                let p = self.layout.position(j, column)?;
                let joint = &self.total[j];
                Some((joint.xx[[p, p]] / joint.samples.max(1.0)).sqrt() / scale[j])
            })
            .fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_are_those_of_the_rows_whatever_the_blocks() {
        let (columns, rows) = (BLOCK + 7, SAMPLES + 90);
        let x = Array2::from_shape_fn((columns, rows), |(c, i)| (0.1 * (c * i) as f64).sin());
        let y = Array1::from_shape_fn(rows, |i| (0.3 * i as f64).cos());
        let weight = Array1::from_shape_fn(rows, |i| 0.5 * (i % 3) as f64);
        let mut sums = JointGram::zeros(columns);
        for rows in [0..40, 40..rows] {
            let cut = |x: &Array1<f64>| x.slice_axis(Axis(0), rows.clone().into()).to_owned();
            let x = x.slice_axis(Axis(1), rows.clone().into());
            sums.add_rows(x, cut(&y).view(), cut(&weight).view());
        }
        let weighted = &x * &weight;
        for (c, d) in [(0, 0), (3, BLOCK + 2), (BLOCK + 6, 5), (BLOCK, BLOCK - 1)] {
            let direct = weighted.row(c).dot(&x.row(d));
            assert!((sums.xx[[c, d]] - direct).abs() < 1e-10, "{c} {d}");
            assert_eq!(sums.xx[[c, d]], sums.xx[[d, c]]);
            assert_eq!(sums.xx.columns(&[d])[[c, 0]], sums.xx[[c, d]]);
        }
        assert!(
            (&sums.xy - &weighted.dot(&y))
                .iter()
                .all(|e| e.abs() < 1e-10)
        );
        assert!((sums.yy - (&y * &weight).dot(&y)).abs() < 1e-10);
        assert!((sums.samples - weight.sum()).abs() < 1e-10);
    }
}
