//! Trial: the fit with added columns, computed from sums of products without touching a sample.
//!
//! Adding the columns C to fitted columns X uses V = CᵀWX (XᵀWX + Λ)⁻¹ and the Schur complement S = CᵀWC + Λ_C
//! − V XᵀWC. The rows of V belong to single columns: they are computed once for all trials beside a fit, in one
//! solve with many right-hand sides.

use crate::algebra::cholesky::Cholesky;
use crate::algebra::fit::{Fit, Part, Variable, penalty};
use crate::algebra::gram::JointGram;
use ndarray::{Array1, Array2, ArrayView1, Axis};
use rayon::prelude::*;
use std::collections::HashMap;

/// Result of adding columns to a fit.
#[derive(Clone, Debug)]
pub struct Trial {
    /// Squared error, by joint, (N·m)².
    pub error: Vec<f64>,
    /// Penalty Σ λ (β − m)² of the fit on all folds.
    pub penalty: f64,
    /// Coefficients of the added columns.
    pub gamma: Vec<f64>,
}

/// Rows whose squared error a trial gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scored {
    /// Rows of each fold, by the fit to the other folds.
    LeftOut,
    /// The fitted rows, which takes a fraction of the time.
    Fitted,
}

/// Number of columns that are prepared in one block.
const TOGETHER: usize = 256;

/// Columns that may be added to a fit.
pub struct SharedColumns<'f, 'a> {
    fit: &'f Fit<'a>,
    /// Row of each column in the tables of [`Common`].
    row: HashMap<usize, usize>,
    scored: Vec<Common<'f>>,
    all: Common<'f>,
}

/// Prepared columns for one part of the fit.
struct Common<'f> {
    part: &'f Part,
    left_out: Option<usize>,
    /// Blocks of [`TOGETHER`] columns.
    blocks: Vec<Block>,
}

/// Prepared columns of one block.
struct Block {
    /// CᵀWX, shape (columns, fitted).
    cross: Array2<f64>,
    /// V, shape (columns, fitted).
    moved: Array2<f64>,
    /// Error terms by joint, where the part is scored.
    scored: Vec<OnJoint>,
}

/// Terms of the change of ‖y − Xβ‖² on one joint's scored rows by added columns. With coefficients γ the change
/// is γᵀQγ + 2sᵀγ, Q = (C − XVᵀ)ᵀ(C − XVᵀ) and s = −(C − XVᵀ)ᵀ(y − Xβ).
struct OnJoint {
    /// Columns of V that touch the joint, shape (columns, places).
    moved: Array2<f64>,
    /// Product of these columns of V with XᵀX.
    product: Array2<f64>,
    /// Diagonal of Q, by added column.
    square: Vec<f64>,
    /// Slope s of each added column.
    slope: Vec<f64>,
}

/// A column of a trial: its number, and its place among the prepared ones.
#[derive(Clone, Copy)]
struct Place<'b> {
    column: usize,
    block: &'b Block,
    row: usize,
}

impl<'f, 'a> SharedColumns<'f, 'a> {
    /// Prepares trials of sets of `columns`.
    pub fn new(fit: &'f Fit<'a>, columns: &[usize], scored: Scored) -> Self {
        let mut columns = columns.to_vec();
        columns.sort_unstable();
        columns.dedup();
        let left_out = match scored {
            Scored::LeftOut => &fit.parts[..],
            Scored::Fitted => &[],
        };
        let all = || Common::new(fit, &fit.all, None, &columns, left_out.is_empty());
        let folds = || {
            let folds = left_out.par_iter().enumerate();
            let each = folds.map(|(f, part)| Common::new(fit, part, Some(f), &columns, true));
            each.collect()
        };
        let (all, scored) = rayon::join(all, folds);
        let row = columns.into_iter().enumerate().map(|(r, c)| (c, r));
        Self {
            fit,
            row: row.collect(),
            scored,
            all,
        }
    }

    /// Result of the fit with `added` columns, which must be prepared ones.
    pub fn trial(&self, added: &[Variable]) -> Trial {
        let rows: Vec<usize> = added.iter().map(|v| self.row[&v.column]).collect();
        let gamma = self.gamma(&self.all, added, &rows);
        let mut beta = self.fit.all.beta.clone();
        for (&r, &g) in rows.iter().zip(&gamma) {
            let (block, i) = self.all.place(r);
            beta.scaled_add(-g, &block.moved.row(i));
        }
        let mut error = vec![0.0; self.fit.grams.dof()];
        let mut score = |common: &Common, gamma: &Array1<f64>| {
            for (j, e) in error.iter_mut().enumerate() {
                *e += self.error(common, j, added, &rows, gamma);
            }
        };
        if self.scored.is_empty() {
            score(&self.all, &gamma);
        }
        for common in &self.scored {
            score(common, &self.gamma(common, added, &rows));
        }
        Trial {
            error,
            penalty: penalty(&self.fit.variables, &beta) + penalty(added, &gamma),
            gamma: gamma.to_vec(),
        }
    }

    /// Squared error by scored part and joint, (N·m)², with `added` columns, which must be prepared ones.
    pub fn parts(&self, added: &[Variable]) -> Vec<Vec<f64>> {
        let rows: Vec<usize> = added.iter().map(|v| self.row[&v.column]).collect();
        let of = |common: &Common| {
            let gamma = self.gamma(common, added, &rows);
            let joints = 0..self.fit.grams.dof();
            joints
                .map(|j| self.error(common, j, added, &rows, &gamma).max(0.0))
                .collect()
        };
        self.scored.iter().map(of).collect()
    }

    /// Coefficients of the added columns.
    fn gamma(&self, common: &Common, added: &[Variable], rows: &[usize]) -> Array1<f64> {
        let (k, grams) = (added.len(), self.fit.grams);
        let mut own = Array2::<f64>::zeros((k, k));
        let mut right = Array1::<f64>::zeros(k);
        for (a, v) in added.iter().enumerate() {
            for (j, &w) in self.fit.weights.iter().enumerate() {
                let Some(row) = grams.layout.position(j, v.column) else {
                    continue;
                };
                let total = &grams.total[j];
                let out = common.left_out.map(|f| grams.apart(f, j));
                for (b, x) in added.iter().enumerate().take(a + 1) {
                    if let Some(p) = grams.layout.position(j, x.column) {
                        own[[a, b]] +=
                            w * (total.xx[[row, p]] - out.map_or(0.0, |g| g.xx[[row, p]]));
                    }
                }
                right[a] += w * (total.xy[row] - out.map_or(0.0, |g| g.xy[row]));
            }
            own[[a, a]] += v.precision;
            right[a] += v.precision * v.mean;
            let (block, i) = common.place(rows[a]);
            let cross = block.cross.row(i);
            right[a] -= cross.dot(&common.part.beta);
            for (b, &r) in rows.iter().enumerate().take(a + 1) {
                let (block, i) = common.place(r);
                own[[a, b]] -= cross.dot(&block.moved.row(i));
            }
        }
        if k == 1 && own[[0, 0]] > f64::MIN_POSITIVE {
            return right / own[[0, 0]];
        }
        Cholesky::new(&own).solve(right.view())
    }

    /// ‖y − Xβ‖² of one joint on the scored rows with the added columns, (N·m)².
    fn error(
        &self,
        common: &Common,
        joint: usize,
        added: &[Variable],
        rows: &[usize],
        gamma: &Array1<f64>,
    ) -> f64 {
        let places = added.iter().zip(rows).map(|(v, &r)| {
            let (block, row) = common.place(r);
            Place {
                column: v.column,
                block,
                row,
            }
        });
        let places = places.zip(gamma);
        let mut change = 0.0;
        for (a, (one, &g)) in places.clone().enumerate() {
            let own = &one.block.scored[joint];
            change += g * (g * own.square[one.row] + 2.0 * own.slope[one.row]);
            for (other, &h) in places.clone().take(a) {
                change += 2.0 * g * h * self.between(common, joint, one, other);
            }
        }
        common.part.error[joint] + change
    }

    /// Element of Q for two columns.
    fn between(&self, common: &Common, joint: usize, one: Place, other: Place) -> f64 {
        let grams = self.fit.grams;
        let gram = &common.left_out.map_or(&grams.total, |f| &grams.folds[f])[joint];
        let place = |of: Place| grams.layout.position(joint, of.column);
        let [a, b] = [one, other].map(|of| &of.block.scored[joint]);
        let onto = |p: Option<usize>, moved: ArrayView1<f64>| {
            p.map_or(0.0, |p| onto(gram, p, &self.fit.places[joint], moved))
        };
        let (p, q) = (place(one), place(other));
        let both = p.zip(q).map_or(0.0, |(p, q)| gram.xx[[p, q]]);
        a.moved.row(one.row).dot(&b.product.row(other.row))
            - onto(p, b.moved.row(other.row))
            - onto(q, a.moved.row(one.row))
            + both
    }
}

/// Product of the column at place `p` of a joint with a change `moved` of the fitted columns that touch it.
fn onto(gram: &JointGram, p: usize, places: &[(usize, usize)], moved: ArrayView1<f64>) -> f64 {
    let row = gram.xx.row(p);
    places
        .iter()
        .zip(moved)
        .map(|(&(_, r), m)| row[r] * m)
        .sum()
}

impl<'f> Common<'f> {
    /// Prepares the columns; with `scored` also the error terms of the part's rows.
    fn new(
        fit: &Fit,
        part: &'f Part,
        left_out: Option<usize>,
        columns: &[usize],
        scored: bool,
    ) -> Self {
        let blocks = columns.par_chunks(TOGETHER);
        let blocks = blocks.map(|some| Block::new(fit, part, left_out, some, scored));
        Self {
            part,
            left_out,
            blocks: blocks.collect(),
        }
    }

    /// Block of a prepared column, and its row there.
    fn place(&self, row: usize) -> (&Block, usize) {
        (&self.blocks[row / TOGETHER], row % TOGETHER)
    }
}

impl Block {
    fn new(
        fit: &Fit,
        part: &Part,
        left_out: Option<usize>,
        columns: &[usize],
        scored: bool,
    ) -> Self {
        let grams = fit.grams;
        let mut cross = Array2::<f64>::zeros((columns.len(), fit.variables.len()));
        for (mut cross, &column) in cross.rows_mut().into_iter().zip(columns) {
            for (j, &w) in fit.weights.iter().enumerate() {
                let Some(row) = grams.layout.position(j, column) else {
                    continue;
                };
                let total = grams.total[j].xx.row(row);
                let out = left_out.map(|f| grams.apart(f, j).xx.row(row));
                for &(i, p) in &fit.places[j] {
                    cross[i] += w * (total[p] - out.map_or(0.0, |x| x[p]));
                }
            }
        }
        let moved = part.factor.solve_rows(&cross);
        let joints = 0..if scored { grams.dof() } else { 0 };
        let scored = joints
            .map(|j| {
                let gram = &left_out.map_or(&grams.total, |f| &grams.folds[f])[j];
                OnJoint::new(fit, part, gram, j, columns, &moved)
            })
            .collect();
        Self {
            cross,
            moved,
            scored,
        }
    }
}

impl OnJoint {
    fn new(
        fit: &Fit,
        part: &Part,
        gram: &JointGram,
        joint: usize,
        columns: &[usize],
        moved: &Array2<f64>,
    ) -> Self {
        let (places, correlation) = (&fit.places[joint], &part.correlation[joint]);
        let variables: Vec<usize> = places.iter().map(|p| p.0).collect();
        let moved = moved.select(Axis(1), &variables);
        let product = moved.dot(&part.products[joint]);
        let known: Array1<f64> = places.iter().map(|&(_, p)| correlation[p]).collect();
        let (mut square, mut slope) = (Vec::new(), moved.dot(&known).to_vec());
        let rows = moved.rows().into_iter().zip(product.rows());
        for (((moved, product), slope), &column) in rows.zip(&mut slope).zip(columns) {
            let mut own = moved.dot(&product);
            if let Some(p) = fit.grams.layout.position(joint, column) {
                own += gram.xx[[p, p]] - 2.0 * onto(gram, p, places, moved);
                *slope -= correlation[p];
            }
            square.push(own);
        }
        Self {
            moved,
            product,
            square,
            slope,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::fit::left_out_error;
    use crate::algebra::gram::{Grams, JointGram, Layout};
    use proptest::prelude::*;
    use std::ops::Range;

    fn grams(values: &[f64]) -> Grams {
        // Two joints; column 0 on both, 1 on the first, 2 on the second, 3 on both.
        let layout = Layout::new(2, &[vec![0, 1], vec![0], vec![1], vec![0, 1]]);
        let of = |rows: Range<usize>| -> Vec<Vec<JointGram>> {
            let joint = |x: &[f64]| {
                let all = Array2::from_shape_vec((8, 4), x.to_vec()).expect("32 values");
                let some = all.slice_axis(Axis(0), rows.clone().into());
                JointGram::new(
                    some.slice_axis(Axis(1), (0..3).into()),
                    some.column(3),
                    Array1::ones(rows.len()).view(),
                )
            };
            let fold = |c: &[f64]| vec![joint(&c[..32]), joint(&c[32..])];
            values.chunks(64).map(fold).collect()
        };
        // The first rows of each fold lie near the one before it.
        let mut near = of(0..2);
        near.rotate_left(1);
        Grams::new(layout, of(0..8)).with_near(near)
    }

    proptest! {
        #[test]
        fn a_trial_is_the_fit_with_the_columns(values in prop::collection::vec(-1.0..1.0f64, 192)) {
            let grams = grams(&values);
            let v = |column| Variable { column, precision: 0.1, mean: 0.3 * column as f64 };
            let fit = Fit::new(&grams, vec![v(0), v(1)], vec![1.0, 2.0]);
            let trial = SharedColumns::new(&fit, &[3, 2], Scored::LeftOut).trial(&[v(2), v(3)]);
            let full = Fit::new(&grams, vec![v(0), v(1), v(2), v(3)], vec![1.0, 2.0]);
            for (a, b) in trial.error.iter().zip(full.error()) {
                prop_assert!((a - b).abs() < 1e-9);
            }
            let alone = left_out_error(&grams, &full.variables, &full.weights);
            for (a, b) in alone.iter().zip(full.error()) {
                prop_assert!((a - b).abs() < 1e-9);
            }
            prop_assert!((trial.penalty - full.penalty()).abs() < 1e-9);
            prop_assert!((trial.gamma[1] - full.beta()[3]).abs() < 1e-9);
            let parts = SharedColumns::new(&fit, &[3, 2], Scored::LeftOut).parts(&[v(2), v(3)]);
            for (a, b) in parts.iter().zip(full.errors()) {
                prop_assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9));
            }
            let glance = SharedColumns::new(&fit, &[0, 2, 3], Scored::Fitted).trial(&[v(2), v(3)]);
            for (a, b) in glance.error.iter().zip(full.error_of(full.beta())) {
                prop_assert!((a - b).abs() < 1e-9);
            }
        }
    }
}
