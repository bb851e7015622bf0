//! Trials for many right-hand sides (torques) on one fit: all that does not depend on the torque is computed once.
//!
//! With X fitted, C added, W the joints' weights and A = XᵀWX + Λ on the rows that a part of the fit was made
//! on: V = CᵀWX A⁻¹, S = CᵀWC + Λ_C − V XᵀWC, γ = S⁻¹ (CᵀW(y − Xβ) + Λ_C m), and the fitted coefficients move
//! by −Vᵀγ. On the rows that the part is scored on the squared error of joint j changes by γᵀQ_jγ − 2 γᵀ(C −
//! XVᵀ)ᵀ(y − Xβ), where Q_j = (C − XVᵀ)ᵀ(C − XVᵀ) on its rows.

use crate::algebra::cholesky::Cholesky;
use crate::algebra::fit::{Fit, Part, Variable};
use crate::algebra::gram::Symmetric;
use crate::algebra::trial::Trial;
use ndarray::{Array1, Array2, ArrayView1, Axis, Zip};
use rayon::prelude::*;

/// Sums of products of the columns with several torques, and of each torque with itself, by fold and joint.
#[derive(Clone, Debug)]
pub struct RightHands {
    /// Xᵀy, shape (active columns of the joint, torques).
    pub xy: Vec<Vec<Array2<f64>>>,
    /// Sum of squares yᵀy of each torque.
    pub yy: Vec<Vec<Array1<f64>>>,
    /// Xᵀy on the rows that are not fitted where a fold is scored; none where these are the rows of the fold.
    pub apart: Option<Vec<Vec<Array2<f64>>>>,
}

impl RightHands {
    fn apart(&self, fold: usize, joint: usize) -> &Array2<f64> {
        &self.apart.as_ref().unwrap_or(&self.xy)[fold][joint]
    }
}

/// One part of a fit, all folds or all but one.
#[derive(Clone, Copy)]
struct FitPart<'a> {
    part: &'a Part,
    left_out: Option<usize>,
}

/// A part of the fit to each right-hand side. Tables by joint over all active columns, shape (columns, torques).
struct State {
    beta: Array2<f64>,
    /// Xᵀ(y − Xβ) on the rows that were fitted.
    fitted: Vec<Array2<f64>>,
    /// Xᵀ(y − Xβ) on the rows that are scored.
    scored: Vec<Array2<f64>>,
    /// Rows of `scored` that belong to fitted columns.
    old: Vec<Array2<f64>>,
    error: Vec<Array1<f64>>,
}

/// A fit to each of several torques, with the weights of one fit.
pub struct Fitted<'a> {
    fit: &'a Fit<'a>,
    /// States with each fold left out, then on all folds.
    states: Vec<State>,
    /// Leave-one-fold-out squared error, (N·m)², shape (joints, torques).
    pub error: Array2<f64>,
    /// Penalty Σ λ (β − m)² of each fit.
    pub penalty: Array1<f64>,
}

/// Columns added to one part.
struct Addition {
    factor: Cholesky,
    /// V, shape (added, fitted) columns.
    moved: Array2<f64>,
    /// Matrix Q_j of each joint j.
    change: Vec<Array2<f64>>,
}

impl<'a> Fitted<'a> {
    /// Fits the variables of `fit` to other torques.
    pub fn new(fit: &'a Fit<'a>, y: &RightHands) -> Self {
        let states: Vec<State> = parts(fit)
            .into_par_iter()
            .map(|p| state(fit, p, y))
            .collect();
        let (folds, dof) = (states.len() - 1, fit.weights.len());
        let torques = states[folds].beta.ncols();
        let mut error = Array2::zeros((dof, torques));
        for state in &states[..folds] {
            for (mut sum, e) in error.rows_mut().into_iter().zip(&state.error) {
                sum += e;
            }
        }
        let penalty = penalties(&fit.variables, &states[folds].beta);
        Self {
            fit,
            states,
            error,
            penalty,
        }
    }

    /// Number of right-hand sides.
    pub fn torques(&self) -> usize {
        self.penalty.len()
    }

    /// Trials of the columns `set` on top of the fit, one for each right-hand side.
    pub fn trials(&self, set: &[Variable]) -> Vec<Trial> {
        let fit = self.fit;
        let mut error = self.error.clone();
        let (mut gamma, mut penalty) = (Array2::zeros((0, 0)), self.penalty.clone());
        for (which, state) in parts(fit).into_iter().zip(&self.states) {
            let addition = addition(fit, which, set);
            gamma = self.coefficients(set, &addition, state);
            if which.left_out.is_none() {
                let beta = &state.beta - &addition.moved.t().dot(&gamma);
                penalty = penalties(&fit.variables, &beta) + penalties(set, &gamma);
                continue;
            }
            for (j, mut sum) in error.rows_mut().into_iter().enumerate() {
                let places = fit.places[j].iter().map(|&(i, _)| i).collect::<Vec<_>>();
                let mut slope = -addition.moved.select(Axis(1), &places).dot(&state.old[j]);
                for (mut row, v) in slope.rows_mut().into_iter().zip(set) {
                    if let Some(p) = fit.grams.layout.position(j, v.column) {
                        row += &state.scored[j].row(p);
                    }
                }
                let square = addition.change[j].dot(&gamma);
                for ((g, q), s) in gamma
                    .rows()
                    .into_iter()
                    .zip(square.rows())
                    .zip(slope.rows())
                {
                    Zip::from(&mut sum)
                        .and(g)
                        .and(q)
                        .and(s)
                        .for_each(|e, g, q, s| *e += g * (q - 2.0 * s));
                }
            }
        }
        let each = error
            .columns()
            .into_iter()
            .zip(gamma.columns())
            .zip(&penalty);
        each.map(|((error, gamma), &penalty)| Trial {
            error: error.to_vec(),
            penalty,
            gamma: gamma.to_vec(),
        })
        .collect()
    }

    fn coefficients(&self, set: &[Variable], addition: &Addition, state: &State) -> Array2<f64> {
        let mut right = Array2::zeros((self.torques(), set.len()));
        for (mut column, v) in right.columns_mut().into_iter().zip(set) {
            column += v.precision * v.mean;
            for (j, &w) in self.fit.weights.iter().enumerate() {
                if let Some(p) = self.fit.grams.layout.position(j, v.column) {
                    column.scaled_add(w, &state.fitted[j].row(p));
                }
            }
        }
        addition.factor.solve_rows(&right).reversed_axes()
    }
}

/// Parts with each fold left out, then on all folds.
fn parts<'a>(fit: &'a Fit) -> Vec<FitPart<'a>> {
    let folds = fit.parts.iter().enumerate().map(|(f, part)| FitPart {
        part,
        left_out: Some(f),
    });
    let all = FitPart {
        part: &fit.all,
        left_out: None,
    };
    folds.chain([all]).collect()
}

/// Penalty Σ λ (β − m)² of each column of coefficients.
fn penalties(variables: &[Variable], beta: &Array2<f64>) -> Array1<f64> {
    let of = |beta: ArrayView1<f64>| {
        let each = variables.iter().zip(beta);
        each.map(|(v, b)| v.penalty(*b)).sum()
    };
    beta.columns().into_iter().map(of).collect()
}

fn addition(fit: &Fit, which: FitPart, set: &[Variable]) -> Addition {
    let (k, m) = (set.len(), fit.variables.len());
    let grams = fit.grams;
    let rows: Vec<Vec<(usize, usize)>> = (0..fit.weights.len())
        .map(|j| {
            let place = |(a, v): (usize, &Variable)| Some((a, grams.layout.position(j, v.column)?));
            set.iter().enumerate().filter_map(place).collect()
        })
        .collect();
    let mut cross = Array2::<f64>::zeros((k, m));
    let mut own = Array2::<f64>::zeros((k, k));
    for (j, &w) in fit.weights.iter().enumerate() {
        let total = &grams.total[j].xx;
        let out = which.left_out.map(|f| &grams.apart(f, j).xx);
        for &(a, row) in &rows[j] {
            let product = |p: usize| w * (total[[row, p]] - out.map_or(0.0, |x| x[[row, p]]));
            for &(i, p) in &fit.places[j] {
                cross[[a, i]] += product(p);
            }
            for &(b, p) in &rows[j] {
                own[[a, b]] += product(p);
            }
        }
    }
    for (a, v) in set.iter().enumerate() {
        own[[a, a]] += v.precision;
    }
    let moved = which.part.factor.solve_rows(&cross);
    let schur = own - cross.dot(&moved.t());
    let change = (0..fit.weights.len()).map(|j| {
        let xx = which
            .left_out
            .map_or(&grams.total[j].xx, |f| &grams.folds[f][j].xx);
        let places = &fit.places[j];
        let variables: Vec<usize> = places.iter().map(|p| p.0).collect();
        let old = moved.select(Axis(1), &variables);
        let mut q = old.dot(&which.part.own[j].xx).dot(&old.t());
        for &(b, p) in &rows[j] {
            let mixed: Array1<f64> = places.iter().map(|&(_, r)| xx[[p, r]]).collect();
            let one = old.dot(&mixed);
            for (a, x) in one.iter().enumerate() {
                q[[a, b]] -= x;
                q[[b, a]] -= x;
            }
            for &(a, r) in &rows[j] {
                q[[a, b]] += xx[[p, r]];
            }
        }
        q
    });
    Addition {
        change: change.collect(),
        factor: Cholesky::new(&schur),
        moved,
    }
}

fn state(fit: &Fit, which: FitPart, y: &RightHands) -> State {
    let grams = fit.grams;
    let dof = fit.weights.len();
    let whole: Vec<Array2<f64>> = (0..dof)
        .map(|j| {
            let sum = Array2::zeros(y.xy[0][j].dim());
            y.xy.iter().fold(sum, |sum, fold| sum + &fold[j])
        })
        .collect();
    let torques = y.yy[0][0].len();
    let mut right = Array2::<f64>::zeros((torques, fit.variables.len()));
    for (j, &w) in fit.weights.iter().enumerate() {
        for &(i, p) in &fit.places[j] {
            let mut column = right.column_mut(i);
            column.scaled_add(w, &whole[j].row(p));
            if let Some(f) = which.left_out {
                column.scaled_add(-w, &y.apart(f, j).row(p));
            }
        }
    }
    for (mut column, v) in right.columns_mut().into_iter().zip(&fit.variables) {
        column += v.precision * v.mean;
    }
    let beta = which.part.factor.solve_rows(&right).reversed_axes();
    let (mut fitted, mut scored, mut old, mut error) =
        (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (j, whole) in whole.iter().enumerate() {
        let variables: Vec<usize> = fit.places[j].iter().map(|p| p.0).collect();
        let columns: Vec<usize> = fit.places[j].iter().map(|p| p.1).collect();
        let x = beta.select(Axis(0), &variables);
        let left = |xx: &Symmetric, xy: &Array2<f64>| xy - &xx.columns(&columns).dot(&x);
        let squares = |yy: Array1<f64>, xy: &Array2<f64>, rest: &Array2<f64>| {
            let sum = xy.select(Axis(0), &columns) + rest.select(Axis(0), &columns);
            (yy - (&x * &sum).sum_axis(Axis(0))).mapv(|e| e.max(0.0))
        };
        let all = left(&grams.total[j].xx, whole);
        let (rest, e) = match which.left_out {
            Some(f) => {
                let rest = left(&grams.folds[f][j].xx, &y.xy[f][j]);
                let e = squares(y.yy[f][j].clone(), &y.xy[f][j], &rest);
                (rest, e)
            }
            None => {
                let yy = y.yy.iter().fold(Array1::zeros(torques), |s, f| s + &f[j]);
                let e = squares(yy, whole, &all);
                (all.clone(), e)
            }
        };
        error.push(e);
        old.push(rest.select(Axis(0), &columns));
        fitted.push(match which.left_out {
            Some(f) => all - left(&grams.apart(f, j).xx, y.apart(f, j)),
            None => all,
        });
        scored.push(rest);
    }
    State {
        beta,
        fitted,
        scored,
        old,
        error,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::gram::{Grams, JointGram, Layout};
    use crate::algebra::trial::{Scored, SharedColumns};
    use proptest::prelude::*;
    use std::ops::Range;

    /// Three folds of two joints; the torque and a second one, three times as large, with the products of both.
    fn case(values: &[f64]) -> (Grams, RightHands) {
        let layout = Layout::new(2, &[vec![0, 1], vec![0], vec![1], vec![0, 1]]);
        let of = |rows: Range<usize>| -> Vec<Vec<JointGram>> {
            let joint = |x: &[f64]| {
                let all = Array2::from_shape_vec((10, 4), x.to_vec()).expect("40 values");
                let some = all.slice_axis(Axis(0), rows.clone().into());
                JointGram::new(
                    some.slice_axis(Axis(1), (0..3).into()),
                    some.column(3),
                    Array1::ones(rows.len()).view(),
                )
            };
            let fold = |c: &[f64]| vec![joint(&c[..40]), joint(&c[40..])];
            values.chunks(80).map(fold).collect()
        };
        let folds = of(0..10);
        // The first rows of each fold lie near the one before it.
        let mut near = of(0..2);
        near.rotate_left(1);
        let grams = Grams::new(layout, folds.clone()).with_near(near);
        let twice = |x: &Array1<f64>, factor: f64| {
            let mut out = Array2::zeros((x.len(), 2));
            out.column_mut(0).assign(x);
            out.column_mut(1).assign(&(x * factor));
            out
        };
        let apart = |f: usize| (0..2).map(|j| twice(&grams.apart(f, j).xy, 3.0)).collect();
        let right = RightHands {
            apart: Some((0..folds.len()).map(apart).collect()),
            xy: folds
                .iter()
                .map(|f| f.iter().map(|g| twice(&g.xy, 3.0)).collect())
                .collect(),
            yy: folds
                .iter()
                .map(|f| {
                    f.iter()
                        .map(|g| Array1::from(vec![g.yy, 9.0 * g.yy]))
                        .collect()
                })
                .collect(),
        };
        (grams, right)
    }

    proptest! {
        /// The products' own torque as one of many gives the fit's own trial, and what is three times as large nine times its error
        /// where nothing is known beforehand.
        #[test]
        fn one_of_many_is_the_trial_itself(values in prop::collection::vec(-1.0..1.0f64, 240)) {
            let (grams, right) = case(&values);
            for mean in [0.0, 0.3] {
                let v = |column| Variable { column, precision: 0.1, mean: mean * column as f64 };
                let fit = Fit::new(&grams, vec![v(0), v(1)], vec![1.0, 2.0]);
                let fitted = Fitted::new(&fit, &right);
                for (a, b) in fitted.error.column(0).iter().zip(fit.error()) {
                    prop_assert!((a - b).abs() < 1e-9);
                }
                for set in [vec![v(2), v(3)], vec![v(2)]] {
                    let own = SharedColumns::new(&fit, &[2, 3], Scored::LeftOut).trial(&set);
                    let many = fitted.trials(&set);
                    for ((a, c), b) in many[0].error.iter().zip(&many[1].error).zip(&own.error) {
                        prop_assert!((a - b).abs() < 1e-9, "{} {}", a, b);
                        prop_assert!(mean > 0.0 || (c - 9.0 * b).abs() < 1e-8, "{} {}", c, b);
                    }
                    prop_assert!((many[0].penalty - own.penalty).abs() < 1e-9);
                    for (a, b) in many[0].gamma.iter().zip(&own.gamma) {
                        prop_assert!((a - b).abs() < 1e-9);
                    }
                }
            }
        }
    }
}
