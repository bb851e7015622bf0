//! Trial: the fit with added columns, computed from sums of products without touching a sample.
//!
//! Adding the columns C to fitted columns X uses V = CᵀWX (XᵀWX + Λ)⁻¹ and the Schur complement S = CᵀWC + Λ_C
//! − V XᵀWC. The rows of V belong to single columns: they are computed once for all trials beside a fit, in one
//! solve with many right-hand sides.

use crate::algebra::cholesky::Cholesky;
use crate::algebra::fit::{Fit, Part, Variable, penalty};
use crate::algebra::gram::JointGram;
use ndarray::{Array1, Array2};
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
    /// CᵀWX, shape (columns, fitted).
    cross: Array2<f64>,
    /// V, shape (columns, fitted).
    moved: Array2<f64>,
    /// Error terms by joint, where the part is scored.
    scored: Vec<OnJoint>,
}

/// Terms of the change of ‖y − Xβ‖² on one joint's scored rows by added columns. With coefficients γ the change
/// is γᵀQγ + 2sᵀγ, Q = (C − XVᵀ)ᵀ(C − XVᵀ) and s = −(C − XVᵀ)ᵀ(y − Xβ). Tables have shape (columns, fitted columns
/// that touch the joint).
struct OnJoint {
    /// CᵀX.
    mixed: Array2<f64>,
    /// Columns of V that touch the joint.
    moved: Array2<f64>,
    /// Product of these columns of V with XᵀX.
    product: Array2<f64>,
    /// Diagonal of Q, by added column.
    square: Vec<f64>,
    /// Slope s of each added column.
    slope: Vec<f64>,
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
        let joints = 0..fit.grams.dof();
        let all: Vec<Array2<f64>> = joints
            .map(|j| mixed(fit, &fit.grams.total[j], j, &columns))
            .collect();
        let folds = left_out.par_iter().enumerate();
        let each = folds.map(|(f, part)| Common::new(fit, part, Some(f), &columns, &all, true));
        let scored: Vec<Common> = each.collect();
        let all = Common::new(fit, &fit.all, None, &columns, &all, scored.is_empty());
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
            beta.scaled_add(-g, &self.all.moved.row(r));
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
            let cross = common.cross.row(rows[a]);
            right[a] -= cross.dot(&common.part.beta);
            for (b, &r) in rows.iter().enumerate().take(a + 1) {
                own[[a, b]] -= cross.dot(&common.moved.row(r));
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
        let own = &common.scored[joint];
        let xx = &common.gram(self.fit, joint).xx;
        let each: Vec<(usize, Option<usize>, f64)> = added
            .iter()
            .zip(rows)
            .zip(gamma)
            .map(|((v, &r), &g)| (r, self.fit.grams.layout.position(joint, v.column), g))
            .collect();
        let mut change = 0.0;
        for (a, &(r, p, g)) in each.iter().enumerate() {
            change += g * (g * own.square[r] + 2.0 * own.slope[r]);
            for &(s, q, h) in &each[..a] {
                let both = p.zip(q).map_or(0.0, |(p, q)| xx[[p, q]]);
                change += 2.0 * g * h * (own.between(r, s) + both);
            }
        }
        common.part.error[joint] + change
    }
}

/// Products CᵀX of columns with the fitted ones that touch a joint, shape (columns, fitted).
fn mixed(fit: &Fit, gram: &JointGram, joint: usize, columns: &[usize]) -> Array2<f64> {
    let places = &fit.places[joint];
    let mut out = Array2::zeros((columns.len(), places.len()));
    let touching = columns.iter().enumerate();
    let touching =
        touching.filter_map(|(c, &column)| Some((c, fit.grams.layout.position(joint, column)?)));
    for (c, r) in touching {
        let stored = gram.xx.row(r);
        for (x, &(_, p)) in out.row_mut(c).into_iter().zip(places) {
            *x = *stored.get(p).unwrap_or_else(|| &gram.xx[[p, r]]);
        }
    }
    out
}

impl<'f> Common<'f> {
    /// Prepares the columns; with `scored` also the error terms of the part's rows. `all` has the products of the
    /// columns with the fitted ones on all rows, by joint.
    fn new(
        fit: &Fit,
        part: &'f Part,
        left_out: Option<usize>,
        columns: &[usize],
        all: &[Array2<f64>],
        scored: bool,
    ) -> Self {
        let mut cross = Array2::<f64>::zeros((columns.len(), fit.variables.len()));
        let mut own = Vec::with_capacity(all.len());
        for (j, (&w, all)) in fit.weights.iter().zip(all).enumerate() {
            let of = |gram: &JointGram| mixed(fit, gram, j, columns);
            let less = left_out.map(|f| of(fit.grams.apart(f, j)));
            let fitted = less.as_ref().map_or_else(|| all.clone(), |less| all - less);
            for (mut cross, fitted) in cross.rows_mut().into_iter().zip(fitted.rows()) {
                for (&(i, _), product) in fit.places[j].iter().zip(fitted) {
                    cross[i] += w * product;
                }
            }
            own.push(match left_out {
                Some(f) if fit.grams.has_near() => of(&fit.grams.folds[f][j]),
                _ => less.unwrap_or(fitted),
            });
        }
        let moved = part.factor.solve_rows(&cross);
        let mut out = Self {
            part,
            left_out,
            cross,
            moved,
            scored: Vec::new(),
        };
        if scored {
            let each = own.into_iter().enumerate();
            let each = each.map(|(j, mixed)| OnJoint::new(fit, &out, j, columns, mixed));
            out.scored = each.collect();
        }
        out
    }

    /// Sums of products of a joint's scored rows.
    fn gram<'g>(&self, fit: &Fit<'g>, joint: usize) -> &'g JointGram {
        &self
            .left_out
            .map_or(&fit.grams.total, |f| &fit.grams.folds[f])[joint]
    }
}

impl OnJoint {
    fn new(
        fit: &Fit,
        common: &Common,
        joint: usize,
        columns: &[usize],
        mixed: Array2<f64>,
    ) -> Self {
        let (part, gram) = (common.part, common.gram(fit, joint));
        let variables: Vec<usize> = fit.places[joint].iter().map(|p| p.0).collect();
        // In rows, unlike what `select` gives: products of rows read them in order.
        let mut moved = Array2::zeros((columns.len(), variables.len()));
        for (mut own, all) in moved.rows_mut().into_iter().zip(common.moved.rows()) {
            own.iter_mut()
                .zip(&variables)
                .for_each(|(x, &i)| *x = all[i]);
        }
        let product = moved.dot(&part.own[joint].xx);
        let beta: Array1<f64> = variables.iter().map(|&i| part.beta[i]).collect();
        let (known, fitted) = (moved.dot(&part.correlation[joint]), mixed.dot(&beta));
        let mut out = Self {
            mixed,
            moved,
            product,
            square: Vec::with_capacity(columns.len()),
            slope: Vec::with_capacity(columns.len()),
        };
        for (r, &column) in columns.iter().enumerate() {
            let place = fit.grams.layout.position(joint, column);
            let (square, left) =
                place.map_or((0.0, 0.0), |p| (gram.xx[[p, p]], gram.xy[p] - fitted[r]));
            out.square.push(out.between(r, r) + square);
            out.slope.push(known[r] - left);
        }
        out
    }

    /// Element of Q for the columns in two rows, without their own product.
    fn between(&self, r: usize, s: usize) -> f64 {
        let moved = |r: usize| self.moved.row(r);
        moved(r).dot(&self.product.row(s))
            - self.mixed.row(r).dot(&moved(s))
            - self.mixed.row(s).dot(&moved(r))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::gram::{Grams, JointGram, Layout};
    use ndarray::Axis;
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
            let weights = |_: &[f64]| vec![1.0, 2.0];
            let again = Fit::weighted(&grams, full.variables.clone(), weights, 1);
            for (a, b) in again.error().iter().zip(full.error()) {
                prop_assert!((a - b).abs() < 1e-12);
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
