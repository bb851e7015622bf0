//! Values of the dictionary's columns on the fitted rows, and their sums of products.

use crate::algebra::folds::Fold;
use crate::algebra::gram::{Grams, JointGram, Layout};
use crate::motion::frame::Frame;
use crate::motion::scene::Scene;
use crate::search::dictionary::Dictionary;
use ndarray::{Array2, ArrayView1};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;

/// Sums of products of the columns with a fit's residual, for each stretch of time.
pub struct Stretches {
    /// Index of the fold to which each stretch belongs.
    pub fold: Vec<usize>,
    /// Σ w x r of each column x and residual r, by joint, shape (active columns, stretches).
    pub products: Vec<Array2<f64>>,
    /// Σ w r² of the residual, shape (stretches, joints).
    pub squares: Array2<f64>,
    /// Parts of stretches that are near another fold.
    pub near: Vec<Near>,
    /// Σ w x r over the parts in `near`, by joint, shape (active columns, parts).
    pub near_products: Vec<Array2<f64>>,
}

/// Part of a stretch that is so close in time to another fold that it is not fitted where that fold is scored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Near {
    /// Index of the fold near which the part lies.
    pub fold: usize,
    /// Index of the stretch that the part belongs to.
    pub stretch: usize,
}

/// Values of all columns on the fitted rows. They take most of a search's memory and time, and do not depend on the
/// rows' weights. Searches of one recording share the catalogue's columns; each adds those that it derived from the
/// torque.
pub struct Tables {
    /// Joints on which each column acts.
    layout: Layout,
    /// Number of shared columns, the first ones.
    common: usize,
    /// Values of the shared columns by joint, shape (columns that act on it, rows).
    shared: Arc<Vec<Array2<f64>>>,
    /// Values of this search's own columns by joint, shape (columns that act on it, rows).
    own: Vec<Array2<f64>>,
}

impl Tables {
    /// Values of all columns of a dictionary.
    pub fn new(dictionary: &Dictionary, scene: &Scene, frame: &Frame) -> Self {
        let layout = dictionary.layout(scene.dof());
        let shared = Arc::new(shown(dictionary, &layout, scene, frame, 0));
        let own = vec![Array2::zeros((0, frame.len())); scene.dof()];
        Self {
            layout,
            common: dictionary.len(),
            shared,
            own,
        }
    }

    /// Values of the columns of a larger dictionary that begins with the shared columns. Those are reused, and the
    /// others computed.
    pub fn further(&self, dictionary: &Dictionary, scene: &Scene, frame: &Frame) -> Self {
        let layout = dictionary.layout(scene.dof());
        Self {
            own: shown(dictionary, &layout, scene, frame, self.common),
            layout,
            shared: Arc::clone(&self.shared),
            ..*self
        }
    }

    /// Values of the columns that act on a joint, in the order of [`Layout::active`].
    fn columns(&self, joint: usize) -> impl ExactSizeIterator<Item = ArrayView1<'_, f64>> {
        let (shared, own) = (&self.shared[joint], &self.own[joint]);
        let first = shared.nrows();
        (0..first + own.nrows()).map(move |p| {
            if p < first {
                shared.row(p)
            } else {
                own.row(p - first)
            }
        })
    }

    /// Sums of products of all columns and the gap `y` (rows, joints), by fold.
    pub fn grams(&self, y: &Array2<f64>, weight: &Array2<f64>, folds: &[Fold]) -> Grams {
        let dof = self.layout.dof();
        let of = |rows: &[&[Range<usize>]]| -> Vec<Vec<JointGram>> {
            let cells: Vec<(usize, usize)> = (0..rows.len())
                .flat_map(|f| (0..dof).map(move |j| (f, j)))
                .collect();
            let grams: Vec<JointGram> = cells
                .into_par_iter()
                .map(|(f, j)| {
                    JointGram::of_rows(self.columns(j), rows[f], y.column(j), weight.column(j))
                })
                .collect();
            let mut grams = grams.into_iter();
            let folds = rows.iter().map(|_| grams.by_ref().take(dof).collect());
            folds.collect()
        };
        let scored: Vec<&[Range<usize>]> = folds.iter().map(|f| &f.scored[..]).collect();
        let near: Vec<&[Range<usize>]> = folds.iter().map(|f| &f.near[..]).collect();
        let grams = Grams::new(self.layout.clone(), of(&scored));
        if near.iter().all(|rows| rows.is_empty()) {
            return grams;
        }
        grams.with_near(of(&near))
    }

    /// Sums of products of all columns and the residual of a fit on the fitted rows, by stretch of time. Each
    /// stretch lies in one fold.
    pub fn by_stretch(
        &self,
        residual: &Array2<f64>,
        weight: &Array2<f64>,
        stretches: &[(usize, Range<usize>)],
        folds: &[Fold],
    ) -> Stretches {
        let weighted = residual * weight;
        let of_joint = |j: usize, parts: &[Range<usize>]| {
            let left: Vec<f64> = weighted.column(j).to_vec();
            let mut out = Array2::zeros((self.layout.active[j].len(), parts.len()));
            for (mut row, column) in out.rows_mut().into_iter().zip(self.columns(j)) {
                for (sum, rows) in row.iter_mut().zip(parts) {
                    let left = ArrayView1::from(&left[rows.clone()]);
                    *sum = column
                        .slice_axis(ndarray::Axis(0), rows.clone().into())
                        .dot(&left);
                }
            }
            out
        };
        let squares = Array2::from_shape_fn((stretches.len(), self.layout.dof()), |(b, j)| {
            let rows = stretches[b].1.clone();
            rows.map(|i| weighted[[i, j]] * residual[[i, j]]).sum()
        });
        let of = |parts: &[Range<usize>]| -> Vec<Array2<f64>> {
            let joints = (0..self.layout.dof()).into_par_iter();
            joints.map(|j| of_joint(j, parts)).collect()
        };
        let whole: Vec<Range<usize>> = stretches.iter().map(|s| s.1.clone()).collect();
        let parts: Vec<(Near, Range<usize>)> = near(stretches, folds).collect();
        let (near, parts): (Vec<Near>, Vec<Range<usize>>) = parts.into_iter().unzip();
        Stretches {
            fold: stretches.iter().map(|s| s.0).collect(),
            squares,
            products: of(&whole),
            near,
            near_products: of(&parts),
        }
    }
}

/// Parts of stretches that lie near a fold, with their rows.
fn near<'a>(
    stretches: &'a [(usize, Range<usize>)],
    folds: &'a [Fold],
) -> impl Iterator<Item = (Near, Range<usize>)> + 'a {
    let each = folds.iter().enumerate();
    let each = each.flat_map(|(fold, f)| f.near.iter().map(move |near| (fold, near)));
    each.flat_map(move |(fold, near)| {
        let part = move |(stretch, (_, rows)): (usize, &(usize, Range<usize>))| {
            let both = rows.start.max(near.start)..rows.end.min(near.end);
            (!both.is_empty()).then_some((Near { fold, stretch }, both))
        };
        stretches.iter().enumerate().filter_map(part)
    })
}

/// Values of the columns with numbers from `first` on, by joint, shape (columns that act on it, rows).
fn shown(
    dictionary: &Dictionary,
    layout: &Layout,
    scene: &Scene,
    frame: &Frame,
    first: usize,
) -> Vec<Array2<f64>> {
    let before: Vec<usize> = layout
        .active
        .iter()
        .map(|active| active.partition_point(|&c| c < first))
        .collect();
    let mut out: Vec<Array2<f64>> = layout
        .active
        .iter()
        .zip(&before)
        .map(|(active, before)| Array2::zeros((active.len() - before, frame.len())))
        .collect();
    for batch in dictionary.batches(scene.dof(), first) {
        for (c, j, values) in dictionary.reduced(scene, frame, &batch) {
            let p = layout
                .position(j, c)
                .expect("a column touches the joints that it names");
            out[j].row_mut(p - before[j]).assign(&values);
        }
    }
    out
}
