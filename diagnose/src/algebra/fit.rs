//! A penalised least-squares fit with its leave-one-fold-out errors.
//!
//! With weights w_j (one per joint), prior means m and precisions λ the fit minimises
//! Σ_j w_j ‖y_j − X_j β‖² + Σ λ (β − m)².

use crate::algebra::cholesky::Cholesky;
use crate::algebra::folds::jackknife;
use crate::algebra::gram::Grams;
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
    /// Xᵀ(y − Xβ) on the scored rows, over all active columns, by joint.
    pub(super) correlation: Vec<Array1<f64>>,
    /// ‖y − Xβ‖² on the scored rows, by joint.
    pub(super) error: Vec<f64>,
    /// XᵀX of the fitted columns on the scored rows, by joint, in the order of [`Fit::places`].
    pub(super) products: Vec<Array2<f64>>,
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
        let places = places(grams, &variables);
        let all = part(grams, &variables, &weights, &places, None);
        let folds: Vec<usize> = (0..grams.folds.len()).collect();
        let parts = folds
            .into_par_iter()
            .map(|f| part(grams, &variables, &weights, &places, Some(f)))
            .collect();
        Self {
            grams,
            variables,
            weights,
            parts,
            all,
            places,
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
    pub fn products(&self, fold: usize, joint: usize) -> &Array2<f64> {
        &self.grams.folds[fold][joint].xx
    }

    /// XᵀX of one joint on the rows that are not fitted where a fold is scored.
    pub fn products_apart(&self, fold: usize, joint: usize) -> &Array2<f64> {
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
        let each = self.grams.total.iter().zip(&self.places);
        each.map(|(gram, place)| {
            let mut x = Array1::<f64>::zeros(gram.xy.len());
            for &(i, p) in place {
                x[p] += beta[i];
            }
            gram.yy - 2.0 * x.dot(&gram.xy) + x.dot(&fitted(&gram.xx, &x))
        })
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

/// XᵀXβ for coefficients that are mostly zero: a joint has many columns, and few are fitted.
fn fitted(xx: &Array2<f64>, x: &Array1<f64>) -> Array1<f64> {
    let mut out = Array1::zeros(x.len());
    for (row, &b) in xx.rows().into_iter().zip(x).filter(|(_, b)| **b != 0.0) {
        out.scaled_add(b, &row);
    }
    out
}

/// Places of the variables among the active columns of each joint: (variable, place).
fn places(grams: &Grams, variables: &[Variable]) -> Vec<Vec<(usize, usize)>> {
    let of = |j: usize| {
        let place = |(i, v): (usize, &Variable)| Some((i, grams.layout.position(j, v.column)?));
        variables.iter().enumerate().filter_map(place).collect()
    };
    (0..grams.dof()).map(of).collect()
}

/// Leave-one-fold-out squared error by joint, (N·m)²: that of [`Fit::error`], without the other results of a fit.
pub fn left_out_error(grams: &Grams, variables: &[Variable], weights: &[f64]) -> Vec<f64> {
    let places = places(grams, variables);
    let of = |f: usize| -> Vec<f64> {
        let (_, beta) = solved(grams, variables, weights, &places, Some(f));
        let each = grams.folds[f].iter().zip(&places);
        each.map(|(gram, place)| {
            let mut error = gram.yy;
            for &(i, p) in place {
                let row = gram.xx.row(p);
                let fitted: f64 = place.iter().map(|&(k, r)| row[r] * beta[k]).sum();
                error += beta[i] * (fitted - 2.0 * gram.xy[p]);
            }
            error.max(0.0)
        })
        .collect()
    };
    let folds: Vec<Vec<f64>> = (0..grams.folds.len()).into_par_iter().map(of).collect();
    (0..grams.dof())
        .map(|j| folds.iter().map(|e| e[j]).sum())
        .collect()
}

/// Cholesky factor of the normal equations, and the coefficients.
fn solved(
    grams: &Grams,
    variables: &[Variable],
    weights: &[f64],
    places: &[Vec<(usize, usize)>],
    left_out: Option<usize>,
) -> (Cholesky, Array1<f64>) {
    let m = variables.len();
    let mut a = Array2::<f64>::zeros((m, m));
    let mut b = Array1::<f64>::zeros(m);
    for (j, (&w, place)) in weights.iter().zip(places).enumerate() {
        let total = &grams.total[j];
        let out = left_out.map(|f| grams.apart(f, j));
        for &(i, p) in place {
            for &(k, r) in place.iter().take_while(|&&(k, _)| k <= i) {
                a[[i, k]] += w * (total.xx[[p, r]] - out.map_or(0.0, |g| g.xx[[p, r]]));
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

fn part(
    grams: &Grams,
    variables: &[Variable],
    weights: &[f64],
    places: &[Vec<(usize, usize)>],
    left_out: Option<usize>,
) -> Part {
    let (factor, beta) = solved(grams, variables, weights, places, left_out);
    let scored = left_out.map_or(&grams.total, |f| &grams.folds[f]);
    let mut correlation = Vec::with_capacity(grams.dof());
    let mut error = Vec::with_capacity(grams.dof());
    let mut products = Vec::with_capacity(grams.dof());
    for (gram, place) in scored.iter().zip(places) {
        let mut x = Array1::<f64>::zeros(gram.xy.len());
        for &(i, p) in place {
            x[p] += beta[i];
        }
        let fitted = fitted(&gram.xx, &x);
        error.push((gram.yy - 2.0 * x.dot(&gram.xy) + x.dot(&fitted)).max(0.0));
        correlation.push(&gram.xy - &fitted);
        products.push(Array2::from_shape_fn(
            (place.len(), place.len()),
            |(a, b)| gram.xx[[place[a].1, place[b].1]],
        ));
    }
    Part {
        factor,
        beta,
        correlation,
        error,
        products,
    }
}
