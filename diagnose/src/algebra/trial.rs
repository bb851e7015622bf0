//! What adding columns to a fit gives, without touching a sample.
//!
//! Adding the columns C to fitted columns X uses V = CᵀWX (XᵀWX + Λ)⁻¹ and the Schur complement S = CᵀWC + Λ_C − V XᵀWC. The
//! rows of V belong to single columns: they are found once for all that is tried beside a fit, in one solve with many right-hand sides.

use crate::algebra::cholesky::Cholesky;
use crate::algebra::fit::{Fit, Part, Variable, penalty};
use ndarray::{Array1, Array2, Axis};
use rayon::prelude::*;
use std::collections::HashMap;

/// What adding columns to a fit would give.
#[derive(Clone, Debug)]
pub struct Trial {
    /// Squared error, by joint, (N·m)².
    pub error: Vec<f64>,
    /// Σ λ β² of the fit on all folds.
    pub penalty: f64,
    /// Coefficients of the added columns.
    pub gamma: Vec<f64>,
}

/// The rows whose error a trial gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scored {
    /// Each fold's, by the fit to the others.
    LeftOut,
    /// Those that were fitted, at a fraction of the price.
    Fitted,
}

/// Columns that may be added to a fit.
pub struct Beside<'f, 'a> {
    fit: &'f Fit<'a>,
    /// Row of each column in the tables of [`Common`].
    row: HashMap<usize, usize>,
    scored: Vec<Common<'f>>,
    all: Common<'f>,
}

/// What the columns have in common with one part of the fit.
struct Common<'f> {
    part: &'f Part,
    left_out: Option<usize>,
    /// CᵀWX, shape (columns, fitted).
    cross: Array2<f64>,
    /// V, shape (columns, fitted).
    moved: Array2<f64>,
    /// By joint, where the part is scored: the places of V that touch it, and their product with XᵀX of the scored rows.
    onto: Vec<[Array2<f64>; 2]>,
}

impl<'f, 'a> Beside<'f, 'a> {
    /// Prepares trials of sets of `columns`.
    pub fn new(fit: &'f Fit<'a>, columns: &[usize], scored: Scored) -> Self {
        let mut columns = columns.to_vec();
        columns.sort_unstable();
        columns.dedup();
        let (left_out, all) = match scored {
            Scored::LeftOut => (&fit.parts[..], Common::new(fit, &fit.all, None, &columns)),
            Scored::Fitted => (
                &[][..],
                Common::new(fit, &fit.all, None, &columns).onto(fit),
            ),
        };
        let scored = left_out
            .par_iter()
            .enumerate()
            .map(|(f, part)| Common::new(fit, part, Some(f), &columns).onto(fit))
            .collect();
        let row = columns.into_iter().enumerate().map(|(r, c)| (c, r));
        Self {
            fit,
            row: row.collect(),
            scored,
            all,
        }
    }

    /// The same fit with `added` columns, of those that were prepared, as well.
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

    /// Squared error by scored part, then joint, (N·m)², with `added` columns, of those that were prepared, as well.
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

    /// ‖y − Xβ‖² of one joint on the scored rows.
    fn error(
        &self,
        common: &Common,
        joint: usize,
        added: &[Variable],
        rows: &[usize],
        gamma: &Array1<f64>,
    ) -> f64 {
        common.part.error[joint] + self.change(common, joint, added, rows, gamma)
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
                let out = common.left_out.map(|f| &grams.folds[f][j]);
                for (b, x) in added.iter().enumerate().take(a + 1) {
                    if let Some(p) = grams.layout.position(j, x.column) {
                        own[[a, b]] +=
                            w * (total.xx[[row, p]] - out.map_or(0.0, |g| g.xx[[row, p]]));
                    }
                }
                right[a] += w * (total.xy[row] - out.map_or(0.0, |g| g.xy[row]));
            }
            own[[a, a]] += v.precision;
            let cross = common.cross.row(rows[a]);
            right[a] -= cross.dot(&common.part.beta);
            for (b, &r) in rows.iter().enumerate().take(a + 1) {
                own[[a, b]] -= cross.dot(&common.moved.row(r));
            }
        }
        Cholesky::new(&own).solve(right.view())
    }

    /// Change of ‖y − Xβ‖² of one joint on the scored rows.
    fn change(
        &self,
        common: &Common,
        joint: usize,
        added: &[Variable],
        rows: &[usize],
        gamma: &Array1<f64>,
    ) -> f64 {
        let grams = self.fit.grams;
        let gram = &common.left_out.map_or(&grams.total, |f| &grams.folds[f])[joint];
        let (places, correlation) = (&self.fit.places[joint], &common.part.correlation[joint]);
        let [moved, product] = &common.onto[joint];
        let mut old = Array1::<f64>::zeros(places.len());
        let mut square = Array1::<f64>::zeros(places.len());
        for (&r, &g) in rows.iter().zip(gamma) {
            old.scaled_add(-g, &moved.row(r));
            square.scaled_add(-g, &product.row(r));
        }
        let slope: f64 = places
            .iter()
            .zip(&old)
            .map(|(&(_, p), d)| d * correlation[p])
            .sum();
        let mut change = old.dot(&square) - 2.0 * slope;
        let place = |(v, &g): (&Variable, &f64)| Some((grams.layout.position(joint, v.column)?, g));
        let new: Vec<(usize, f64)> = added.iter().zip(gamma).filter_map(place).collect();
        for &(p, g) in &new {
            let row = gram.xx.row(p);
            let with_old: f64 = places.iter().zip(&old).map(|(&(_, r), d)| row[r] * d).sum();
            let with_new: f64 = new.iter().map(|&(r, h)| row[r] * h).sum();
            change += g * (2.0 * with_old + with_new - 2.0 * correlation[p]);
        }
        change
    }
}

impl<'f> Common<'f> {
    fn new(fit: &Fit, part: &'f Part, left_out: Option<usize>, columns: &[usize]) -> Self {
        let grams = fit.grams;
        let mut cross = Array2::<f64>::zeros((columns.len(), fit.variables.len()));
        for (mut cross, &column) in cross.rows_mut().into_iter().zip(columns) {
            for (j, &w) in fit.weights.iter().enumerate() {
                let Some(row) = grams.layout.position(j, column) else {
                    continue;
                };
                let total = grams.total[j].xx.row(row);
                let out = left_out.map(|f| grams.folds[f][j].xx.row(row));
                for &(i, p) in &fit.places[j] {
                    cross[i] += w * (total[p] - out.map_or(0.0, |x| x[p]));
                }
            }
        }
        Self {
            moved: part.factor.solve_rows(&cross),
            part,
            left_out,
            cross,
            onto: Vec::new(),
        }
    }

    /// The same, with what the error of its scored rows needs.
    fn onto(self, fit: &Fit) -> Self {
        let each = fit.places.iter().zip(&self.part.products);
        let onto = each.map(|(places, products)| {
            let variables: Vec<usize> = places.iter().map(|&(i, _)| i).collect();
            let moved = self.moved.select(Axis(1), &variables);
            let product = moved.dot(products);
            [moved, product]
        });
        let onto = onto.collect();
        Self { onto, ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::gram::{Grams, JointGram, Layout};
    use proptest::prelude::*;

    fn grams(values: &[f64]) -> Grams {
        // Two joints; column 0 on both, 1 on the first, 2 on the second, 3 on both.
        let layout = Layout::new(2, &[vec![0, 1], vec![0], vec![1], vec![0, 1]]);
        let folds = values
            .chunks(64)
            .map(|c| {
                let half = |x: &[f64]| {
                    let rows = Array2::from_shape_vec((8, 4), x.to_vec()).expect("32 values");
                    let ones = Array1::ones(8);
                    JointGram::new(
                        rows.slice_axis(ndarray::Axis(1), (0..3).into()),
                        rows.column(3),
                        ones.view(),
                    )
                };
                vec![half(&c[..32]), half(&c[32..])]
            })
            .collect();
        Grams::new(layout, folds)
    }

    proptest! {
        #[test]
        fn a_trial_is_the_fit_with_the_columns(values in prop::collection::vec(-1.0..1.0f64, 192)) {
            let grams = grams(&values);
            let v = |column| Variable { column, precision: 0.1 };
            let fit = Fit::new(&grams, vec![v(0), v(1)], vec![1.0, 2.0]);
            let trial = Beside::new(&fit, &[3, 2], Scored::LeftOut).trial(&[v(2), v(3)]);
            let full = Fit::new(&grams, vec![v(0), v(1), v(2), v(3)], vec![1.0, 2.0]);
            for (a, b) in trial.error.iter().zip(full.error()) {
                prop_assert!((a - b).abs() < 1e-9);
            }
            prop_assert!((trial.penalty - full.penalty()).abs() < 1e-9);
            prop_assert!((trial.gamma[1] - full.beta()[3]).abs() < 1e-9);
            let parts = Beside::new(&fit, &[3, 2], Scored::LeftOut).parts(&[v(2), v(3)]);
            for (a, b) in parts.iter().zip(full.errors()) {
                prop_assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9));
            }
            let glance = Beside::new(&fit, &[0, 2, 3], Scored::Fitted).trial(&[v(2), v(3)]);
            for (a, b) in glance.error.iter().zip(full.error_of(full.beta())) {
                prop_assert!((a - b).abs() < 1e-9);
            }
        }
    }
}
