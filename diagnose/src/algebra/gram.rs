//! Sums of products: all information on the samples that forward selection needs.
//!
//! Every column of the dictionary is a torque per unit of its parameter, on the rows of some
//! joints. For each fold (a group of whole trajectories) and each joint the products of the
//! columns that touch that joint are formed once; every fit, leave-one-fold-out error and share
//! afterwards is algebra on them, independent of the number of samples.

use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::{Accum, MatMut, MatRef, Par};
use ndarray::{Array1, Array2, ArrayView1, ArrayView2};
use std::ops::Range;

/// Sums of products of one joint's rows in one fold: XᵀX, Xᵀy, yᵀy with X (samples, active columns of the
/// joint) and y the torque to explain.
#[derive(Clone, Debug)]
pub struct JointGram {
    /// Matrix XᵀX, shape (active columns, active columns).
    pub xx: Array2<f64>,
    /// Vector Xᵀy, by active column.
    pub xy: Array1<f64>,
    /// Sum of squares of the target, yᵀy.
    pub yy: f64,
    /// Sum of the row weights; the number of samples where all weigh one.
    pub samples: f64,
}

impl JointGram {
    /// Sums of products of the rows `x` and `y`, each row multiplied by its weight.
    pub fn new(x: ArrayView2<f64>, y: ArrayView1<f64>, weight: ArrayView1<f64>) -> Self {
        let all = 0..x.nrows();
        Self::of_rows(x.columns().into_iter(), &[all], y, weight)
    }

    /// Sums of products of columns and `y` on some `rows`, each row multiplied by its weight.
    pub fn of_rows<'x>(
        columns: impl ExactSizeIterator<Item = ArrayView1<'x, f64>>,
        rows: &[Range<usize>],
        y: ArrayView1<f64>,
        weight: ArrayView1<f64>,
    ) -> Self {
        let picked: Vec<usize> = rows.iter().cloned().flatten().collect();
        let root: Vec<f64> = picked.iter().map(|&i| weight[i].sqrt()).collect();
        let (k, n) = (columns.len(), picked.len());
        let mut x = Vec::with_capacity(k * n);
        for column in columns {
            let own = rows.iter().cloned().flatten().map(|i| column[i]);
            x.extend(own.zip(&root).map(|(x, r)| x * r));
        }
        let yw: Array1<f64> = picked.iter().zip(&root).map(|(&i, r)| y[i] * r).collect();
        let x = Array2::from_shape_vec((k, n), x).expect("every column has its rows");
        Self {
            xy: x.dot(&yw),
            yy: yw.dot(&yw),
            samples: picked.iter().map(|&i| weight[i]).sum(),
            xx: outer(&x),
        }
    }

    fn add(&mut self, other: &Self) {
        self.xx += &other.xx;
        self.xy += &other.xy;
        self.yy += other.yy;
        self.samples += other.samples;
    }
}

/// X·Xᵀ, of which the lower half is computed and mirrored.
fn outer(x: &Array2<f64>) -> Array2<f64> {
    let (k, n) = x.dim();
    let mut out = Array2::zeros((k, k));
    let values = x.as_slice().expect("a new table is in standard layout");
    let x = MatRef::from_row_major_slice(values, k, n);
    let product = out
        .as_slice_mut()
        .expect("a new table is in standard layout");
    triangular::matmul(
        MatMut::from_row_major_slice_mut(product, k, k),
        BlockStructure::TriangularLower,
        Accum::Replace,
        x,
        BlockStructure::Rectangular,
        x.transpose(),
        BlockStructure::Rectangular,
        1.0,
        Par::Seq,
    );
    for i in 0..k {
        for j in 0..i {
            product[j * k + i] = product[i * k + j];
        }
    }
    out
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
    apart: Option<Vec<Vec<JointGram>>>,
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
    pub fn with_near(self, near: Vec<Vec<JointGram>>) -> Self {
        let mut apart = self.folds.clone();
        for (fold, near) in apart.iter_mut().zip(&near) {
            for (sum, joint) in fold.iter_mut().zip(near) {
                sum.add(joint);
            }
        }
        Self {
            apart: Some(apart),
            ..self
        }
    }

    /// Sums of products of one joint's rows that are not fitted where a fold is scored.
    pub fn apart(&self, fold: usize, joint: usize) -> &JointGram {
        &self.apart.as_ref().unwrap_or(&self.folds)[fold][joint]
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
