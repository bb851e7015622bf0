//! A penalised least-squares fit with its leave-one-fold-out errors.
//!
//! With weights w_j (one per joint), prior means m and precisions λ the fit minimises
//! Σ_j w_j ‖y_j − X_j β‖² + Σ λ (β − m)².

use crate::algebra::cholesky::Cholesky;
use crate::algebra::folds::jackknife;
use crate::algebra::gram::{Grams, JointGram, Symmetric};
use ndarray::{Array1, Array2, ArrayView1, Axis};
use rayon::prelude::*;

/// Variable of a fit: a column of the dictionary with mean and precision (1/variance) of its prior. The same
/// column may be fitted twice; the two then share its prior variances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Variable {
    /// Column number in the dictionary.
    pub column: usize,
    /// 1/variance of the prior, in 1/unit².
    pub precision: f64,
    /// Mean of the prior, zero for nearly all.
    pub mean: f64,
}

impl Variable {
    /// Variable with a prior about zero.
    pub fn about_zero(column: usize, precision: f64) -> Self {
        Self {
            column,
            precision,
            mean: 0.0,
        }
    }

    /// Penalty λ (β − m)² of a coefficient.
    pub fn penalty(&self, beta: f64) -> f64 {
        self.precision * (beta - self.mean).powi(2)
    }
}

/// Fit to all folds but one, scored on that fold; or fit to all folds, scored on all.
#[derive(Clone, Debug)]
pub(super) struct Part {
    pub(super) factor: Cholesky,
    pub(super) beta: Array1<f64>,
    /// Sums of products of the fitted columns on the scored rows, by joint, in the order of [`Fit::places`].
    pub(super) own: Vec<Own>,
    /// Xᵀ(y − Xβ) of these columns on the scored rows, by joint.
    pub(super) correlation: Vec<Array1<f64>>,
    /// ‖y − Xβ‖² on the scored rows, by joint.
    pub(super) error: Vec<f64>,
}

/// A fit on all folds and one with each fold left out.
#[derive(Clone, Debug)]
pub struct Fit<'a> {
    pub(super) grams: &'a Grams,
    /// Variables of the fit, in the order of its coefficients.
    pub variables: Vec<Variable>,
    /// Weight of each joint's squared torque error, 1/(N·m)².
    pub weights: Vec<f64>,
    pub(super) parts: Vec<Part>,
    pub(super) all: Part,
    /// Fitted variables that touch each joint: (variable, place among the joint's active columns).
    pub(super) places: Vec<Vec<(usize, usize)>>,
}

impl<'a> Fit<'a> {
    /// Fit of `variables`. `weights` holds one number per joint, 1/(N·m)².
    pub fn new(grams: &'a Grams, variables: Vec<Variable>, weights: Vec<f64>) -> Self {
        let few = Few::new(grams, &variables);
        Self::of_few(grams, few, variables, weights)
    }

    /// Fit whose weights follow from its own leave-one-fold-out squared error by joint, (N·m)², in so many `passes`. They
    /// start from the squares of the targets.
    pub fn weighted(
        grams: &'a Grams,
        variables: Vec<Variable>,
        weights: impl Fn(&[f64]) -> Vec<f64>,
        passes: usize,
    ) -> Self {
        let few = Few::new(grams, &variables);
        let mut error: Vec<f64> = grams.total.iter().map(|g| g.yy).collect();
        for _ in 0..passes {
            error = few.left_out_error(&variables, &weights(&error));
        }
        Self::of_few(grams, few, variables, weights(&error))
    }

    fn of_few(grams: &'a Grams, few: Few, variables: Vec<Variable>, weights: Vec<f64>) -> Self {
        let all = part(
            few.solved(&variables, &weights, None),
            few.total.clone(),
            &few,
        );
        let parts = (0..few.folds.len()).into_par_iter().map(|f| {
            let solution = few.solved(&variables, &weights, Some(f));
            part(solution, few.folds[f].clone(), &few)
        });
        Self {
            grams,
            parts: parts.collect(),
            variables,
            weights,
            all,
            places: few.places,
        }
    }

    /// Coefficients of the fit on all folds.
    pub fn beta(&self) -> &Array1<f64> {
        &self.all.beta
    }

    /// Coefficients of the fits without each fold, in the order of the folds.
    pub fn betas(&self) -> impl Iterator<Item = &Array1<f64>> {
        self.parts.iter().map(|p| &p.beta)
    }

    /// Posterior standard deviations of the coefficients, given the weights.
    pub fn std(&self) -> Array1<f64> {
        self.all.factor.inverse_diagonal().mapv(f64::sqrt)
    }

    /// Standard deviations of the coefficients: posterior, or jackknife over the fits without each fold where that is
    /// more. The posterior takes mechanisms outside the model for noise, but another motion has more of them or less.
    pub fn deviations(&self) -> Array1<f64> {
        let mut out = self.std();
        for (i, std) in out.iter_mut().enumerate() {
            let without: Vec<f64> = self.parts.iter().map(|p| p.beta[i]).collect();
            *std = jackknife(&without).map_or(*std, |j| j.max(*std));
        }
        out
    }

    /// Posterior covariance of the coefficients, given the weights.
    pub fn covariance(&self) -> Array2<f64> {
        self.all
            .factor
            .solve_rows(&Array2::eye(self.variables.len()))
    }

    /// Coefficients drawn from their posterior; `noise` are as many independent unit normals.
    pub fn draw(&self, noise: ArrayView1<f64>) -> Array1<f64> {
        &self.all.beta + &self.all.factor.draw(noise)
    }

    /// Penalty of wide priors where the data are sharper, nats: ½ ln(|XᵀWX + Λ|/|Λ|).
    pub fn width(&self) -> f64 {
        let prior: f64 = self.variables.iter().map(|v| v.precision.ln()).sum();
        0.5 * (self.all.factor.log_determinant() - prior)
    }

    /// Number of folds of the fit.
    pub fn folds(&self) -> usize {
        self.grams.folds.len()
    }

    /// XᵀX of one joint in one fold.
    pub fn products(&self, fold: usize, joint: usize) -> &Symmetric {
        &self.grams.folds[fold][joint].xx
    }

    /// XᵀX of one joint on the rows that are not fitted where a fold is scored.
    pub fn products_apart(&self, fold: usize, joint: usize) -> &Symmetric {
        &self.grams.apart(fold, joint).xx
    }

    /// Places of a joint's fitted variables among its active columns, and their rows of `beta`, shape (variables, any).
    pub fn fitted_rows(&self, joint: usize, beta: &Array2<f64>) -> (Vec<usize>, Array2<f64>) {
        let (variables, columns): (Vec<usize>, Vec<usize>) =
            self.places[joint].iter().copied().unzip();
        (columns, beta.select(Axis(0), &variables))
    }

    /// Squared error of the coefficients `beta` on all rows, by joint, (N·m)².
    pub fn error_of(&self, beta: &Array1<f64>) -> Vec<f64> {
        let each = self.all.own.iter().zip(&self.places);
        each.map(|(own, place)| error_of(own, &picked(place, beta)).1)
            .collect()
    }

    /// Squared error of each fold left out, by joint, (N·m)².
    pub fn errors(&self) -> impl Iterator<Item = &[f64]> {
        self.parts.iter().map(|p| &p.error[..])
    }

    /// Leave-one-fold-out squared error by joint, (N·m)².
    pub fn error(&self) -> Vec<f64> {
        (0..self.grams.dof())
            .map(|j| self.parts.iter().map(|p| p.error[j]).sum())
            .collect()
    }

    /// Penalty Σ λ (β − m)² of the fit on all folds.
    pub fn penalty(&self) -> f64 {
        penalty(&self.variables, &self.all.beta)
    }
}

/// Penalty Σ λ (β − m)² of the coefficients `beta`.
pub(super) fn penalty(variables: &[Variable], beta: &Array1<f64>) -> f64 {
    variables.iter().zip(beta).map(|(v, b)| v.penalty(*b)).sum()
}

/// Coefficients of the fitted columns that touch a joint.
fn picked(places: &[(usize, usize)], beta: &Array1<f64>) -> Array1<f64> {
    places.iter().map(|&(i, _)| beta[i]).collect()
}

/// Xᵀ(y − Xβ) and ‖y − Xβ‖² of a joint's rows with the coefficients `beta` of its columns.
fn error_of(own: &Own, beta: &Array1<f64>) -> (Array1<f64>, f64) {
    let rest = &own.xy - &own.xx.dot(beta);
    let error = own.yy - beta.dot(&own.xy) - beta.dot(&rest);
    (rest, error)
}

/// Sums of products of the fitted columns on one joint's rows.
#[derive(Clone, Debug)]
pub(super) struct Own {
    /// Matrix XᵀX, shape (fitted columns, fitted columns).
    pub(super) xx: Array2<f64>,
    xy: Array1<f64>,
    yy: f64,
}

impl Own {
    fn new(gram: &JointGram, places: &[(usize, usize)]) -> Self {
        let mut xx = Array2::zeros((places.len(), places.len()));
        for (mut row, &(_, p)) in xx.rows_mut().into_iter().zip(places) {
            let stored = gram.xx.row(p);
            for (x, &(_, r)) in row.iter_mut().zip(places) {
                *x = *stored.get(r).unwrap_or_else(|| &gram.xx[[r, p]]);
            }
        }
        Self {
            xx,
            xy: places.iter().map(|&(_, p)| gram.xy[p]).collect(),
            yy: gram.yy,
        }
    }
}

/// Sums of products of a fit's columns alone. They are picked once for all its parts.
struct Few {
    /// As [`Fit::places`].
    places: Vec<Vec<(usize, usize)>>,
    /// Sums of products by fold and joint, in the order of `places`.
    folds: Vec<Vec<Own>>,
    /// Those of the rows that are not fitted where a fold is scored; none where they are those of the fold.
    apart: Option<Vec<Vec<Own>>>,
    /// Sums over folds, by joint.
    total: Vec<Own>,
}

impl Few {
    fn new(grams: &Grams, variables: &[Variable]) -> Self {
        let of = |j: usize| {
            let place = |(i, v): (usize, &Variable)| Some((i, grams.layout.position(j, v.column)?));
            variables.iter().enumerate().filter_map(place).collect()
        };
        let places: Vec<Vec<(usize, usize)>> = (0..grams.dof()).map(of).collect();
        let pick = |all: &Vec<JointGram>| -> Vec<Own> {
            let each = all.iter().zip(&places);
            each.map(|(gram, places)| Own::new(gram, places)).collect()
        };
        Self {
            folds: grams.folds.par_iter().map(pick).collect(),
            apart: grams
                .apart
                .as_ref()
                .map(|a| a.par_iter().map(pick).collect()),
            total: pick(&grams.total),
            places,
        }
    }

    /// Leave-one-fold-out squared error by joint, (N·m)²: that of [`Fit::error`], without the other results of a fit.
    fn left_out_error(&self, variables: &[Variable], weights: &[f64]) -> Vec<f64> {
        let of = |f: usize| -> Vec<f64> {
            let (_, beta) = self.solved(variables, weights, Some(f));
            let each = self.folds[f].iter().zip(&self.places);
            each.map(|(own, place)| error_of(own, &picked(place, &beta)).1.max(0.0))
                .collect()
        };
        let folds: Vec<Vec<f64>> = (0..self.folds.len()).into_par_iter().map(of).collect();
        (0..self.total.len())
            .map(|j| folds.iter().map(|e| e[j]).sum())
            .collect()
    }

    /// Cholesky factor of the normal equations, and the coefficients.
    fn solved(
        &self,
        variables: &[Variable],
        weights: &[f64],
        left_out: Option<usize>,
    ) -> (Cholesky, Array1<f64>) {
        let m = variables.len();
        let mut a = Array2::<f64>::zeros((m, m));
        let mut b = Array1::<f64>::zeros(m);
        let apart = self.apart.as_ref().unwrap_or(&self.folds);
        for (j, (&w, place)) in weights.iter().zip(&self.places).enumerate() {
            let (total, out) = (&self.total[j], left_out.map(|f| &apart[f][j]));
            for (p, &(i, _)) in place.iter().enumerate() {
                let mut sums = a.row_mut(i);
                // Places are in the order of the variables: only the lower triangle is needed.
                let known = place.iter().zip(total.xx.row(p)).take(p + 1);
                match out {
                    Some(out) => {
                        for ((&(k, _), all), less) in known.zip(out.xx.row(p)) {
                            sums[k] += w * (all - less);
                        }
                    }
                    None => known.for_each(|(&(k, _), all)| sums[k] += w * all),
                }
                b[i] += w * (total.xy[p] - out.map_or(0.0, |g| g.xy[p]));
            }
        }
        for (i, v) in variables.iter().enumerate() {
            a[[i, i]] += v.precision;
            b[i] += v.precision * v.mean;
        }
        let factor = Cholesky::new(&a);
        let beta = factor.solve(b.view());
        (factor, beta)
    }
}

fn part((factor, beta): (Cholesky, Array1<f64>), own: Vec<Own>, few: &Few) -> Part {
    let each = own.iter().zip(&few.places);
    let (correlation, error) = each
        .map(|(own, place)| {
            let (rest, error) = error_of(own, &picked(place, &beta));
            (rest, error.max(0.0))
        })
        .unzip();
    Part {
        factor,
        beta,
        own,
        correlation,
        error,
    }
}
