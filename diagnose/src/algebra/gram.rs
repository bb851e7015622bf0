//! Sums of products: all that forward selection needs to know of the samples.
//!
//! Every column of the dictionary is a torque per unit of its parameter, on the rows of some
//! joints. For each fold (a group of whole trajectories) and each joint the products of the
//! columns that touch that joint are formed once; every fit, leave-one-fold-out error and share
//! afterwards is algebra on them, independent of the number of samples.

use ndarray::{Array1, Array2, ArrayView1, ArrayView2};

/// Products of one joint's rows in one fold. With X (samples, active columns of the joint) and y
/// the torque to explain: XᵀX, Xᵀy, yᵀy.
#[derive(Clone, Debug)]
pub struct JointGram {
    /// XᵀX
    pub xx: Array2<f64>,
    /// Xᵀy
    pub xy: Array1<f64>,
    /// yᵀy
    pub yy: f64,
    /// Sum of the row weights; the number of samples where all weigh one.
    pub samples: f64,
}

impl JointGram {
    /// Products of the rows `x` and `y`, each multiplied by its weight.
    pub fn new(x: ArrayView2<f64>, y: ArrayView1<f64>, weight: ArrayView1<f64>) -> Self {
        let root = weight.mapv(f64::sqrt);
        let mut xw = x.to_owned();
        for (mut row, &r) in xw.rows_mut().into_iter().zip(&root) {
            row *= r;
        }
        let yw = &y * &root;
        Self {
            xx: xw.t().dot(&xw),
            xy: xw.t().dot(&yw),
            yy: yw.dot(&yw),
            samples: weight.sum(),
        }
    }

    fn add(&mut self, other: &Self) {
        self.xx += &other.xx;
        self.xy += &other.xy;
        self.yy += other.yy;
        self.samples += other.samples;
    }
}

/// Which columns touch which joint.
#[derive(Clone, Debug)]
pub struct Layout {
    /// For each joint the columns with entries in its rows, ascending.
    pub active: Vec<Vec<usize>>,
    position: Vec<Vec<Option<usize>>>,
}

impl Layout {
    /// From the joints that each column touches.
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

    /// Number of joints.
    pub fn dof(&self) -> usize {
        self.active.len()
    }
}

/// Products of all folds and their sum.
#[derive(Clone, Debug)]
pub struct Grams {
    /// Which columns touch which joint.
    pub layout: Layout,
    /// By fold, then joint.
    pub folds: Vec<Vec<JointGram>>,
    /// Sum over folds, by joint.
    pub total: Vec<JointGram>,
}

impl Grams {
    /// Adds the folds up; there must be at least one.
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
            total,
        }
    }

    /// Number of joints.
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
