//! Many right-hand sides on one fit: of a trial, what does not depend on the torque is done once.
//!
//! With X fitted, C added, W the joints' weights and A = XᵀWX + Λ on the rows that a part of the fit was made on:
//! V = CᵀWX A⁻¹, S = CᵀWC + Λ_C − V XᵀWC, γ = S⁻¹ CᵀW(y − Xβ), and the fitted coefficients move by −Vᵀγ. On the rows that the part is
//! scored on the squared error of joint j changes by γᵀQ_jγ − 2 γᵀ(C − XVᵀ)ᵀ(y − Xβ), where Q_j = (C − XVᵀ)ᵀ(C − XVᵀ) on its rows.

use crate::algebra::cholesky::Cholesky;
use crate::algebra::fit::{Fit, Part, Trial, Variable, penalty};
use ndarray::{Array1, Array2};
use rayon::prelude::*;

/// Products of the columns with one torque, and of that torque with itself, by fold, then joint.
#[derive(Clone, Debug)]
pub struct RightHand {
    /// Xᵀy over the joint's active columns.
    pub xy: Vec<Vec<Array1<f64>>>,
    /// yᵀy.
    pub yy: Vec<Vec<f64>>,
}

/// One part of a fit, all folds or all but one.
#[derive(Clone, Copy)]
struct Which<'a> {
    part: &'a Part,
    left_out: Option<usize>,
}

/// Columns added to one part.
struct Addition {
    factor: Cholesky,
    /// V, shape (added, fitted).
    moved: Array2<f64>,
    /// Q_j.
    change: Vec<Array2<f64>>,
}

/// Sets of columns that are tried on top of a fit.
pub struct Many<'a> {
    fit: &'a Fit<'a>,
    added: Vec<Vec<Variable>>,
    /// By set, then fold, then all.
    additions: Vec<Vec<Addition>>,
}

/// A part of the fit to one right-hand side.
struct State {
    beta: Array1<f64>,
    /// Xᵀ(y − Xβ) over all active columns by joint, on the rows that were fitted and on those that are scored.
    fitted: Vec<Array1<f64>>,
    scored: Vec<Array1<f64>>,
    error: Vec<f64>,
}

/// A fit to one right-hand side.
pub struct Fitted {
    states: Vec<State>,
    /// Leave-one-fold-out squared error by joint, (N·m)².
    pub error: Vec<f64>,
    /// Σ λ β².
    pub penalty: f64,
}

impl<'a> Many<'a> {
    /// Prepares sets of columns on top of a fit.
    pub fn new(fit: &'a Fit<'a>, added: Vec<Vec<Variable>>) -> Self {
        let parts = parts(fit);
        let additions = added
            .par_iter()
            .map(|set| parts.iter().map(|p| addition(fit, *p, set)).collect())
            .collect();
        Self {
            fit,
            added,
            additions,
        }
    }

    /// The fit to a right-hand side, weights kept.
    pub fn fitted(&self, y: &RightHand) -> Fitted {
        let states: Vec<State> = parts(self.fit)
            .iter()
            .map(|p| state(self.fit, *p, y))
            .collect();
        let folds = states.len() - 1;
        let dof = self.fit.weights.len();
        let error = |j: usize| states[..folds].iter().map(|s| s.error[j]).sum();
        Fitted {
            error: (0..dof).map(error).collect(),
            penalty: penalty(&self.fit.variables, &states[folds].beta),
            states,
        }
    }

    /// Set `index` tried on top of such a fit.
    pub fn trial(&self, index: usize, fitted: &Fitted) -> Trial {
        let (set, additions) = (&self.added[index], &self.additions[index]);
        let grams = self.fit.grams;
        let dof = self.fit.weights.len();
        let folds = additions.len() - 1;
        let mut error = fitted.error.clone();
        for (addition, state) in additions[..folds].iter().zip(&fitted.states) {
            let gamma = self.coefficients(set, addition, state);
            for (j, e) in error.iter_mut().enumerate().take(dof) {
                let mut slope = Array1::<f64>::zeros(set.len());
                for (a, v) in set.iter().enumerate() {
                    let own = grams.layout.position(j, v.column);
                    let own = own.map_or(0.0, |p| state.scored[j][p]);
                    let old = self.fit.places[j].iter();
                    let old = old.map(|&(i, p)| addition.moved[[a, i]] * state.scored[j][p]);
                    slope[a] = own - old.sum::<f64>();
                }
                *e += gamma.dot(&addition.change[j].dot(&gamma)) - 2.0 * gamma.dot(&slope);
            }
        }
        let (all, state) = (&additions[folds], &fitted.states[folds]);
        let gamma = self.coefficients(set, all, state);
        let beta = &state.beta - &all.moved.t().dot(&gamma);
        let extra: f64 = set
            .iter()
            .zip(&gamma)
            .map(|(v, g)| v.precision * g * g)
            .sum();
        Trial {
            error,
            penalty: penalty(&self.fit.variables, &beta) + extra,
            gamma: gamma.to_vec(),
        }
    }

    fn coefficients(&self, set: &[Variable], addition: &Addition, state: &State) -> Array1<f64> {
        let right = set.iter().map(|v| {
            let of = |(j, w): (usize, &f64)| {
                let p = self.fit.grams.layout.position(j, v.column);
                p.map_or(0.0, |p| w * state.fitted[j][p])
            };
            self.fit.weights.iter().enumerate().map(of).sum::<f64>()
        });
        addition.factor.solve(right.collect::<Array1<f64>>().view())
    }
}

/// Folds left out, then all.
fn parts<'a>(fit: &'a Fit) -> Vec<Which<'a>> {
    let folds = fit.parts.iter().enumerate().map(|(f, part)| Which {
        part,
        left_out: Some(f),
    });
    let all = Which {
        part: &fit.all,
        left_out: None,
    };
    folds.chain([all]).collect()
}

fn addition(fit: &Fit, which: Which, set: &[Variable]) -> Addition {
    let (k, m) = (set.len(), fit.variables.len());
    let grams = fit.grams;
    let place = |j: usize, v: &Variable| grams.layout.position(j, v.column);
    let mut cross = Array2::<f64>::zeros((k, m));
    let mut own = Array2::<f64>::zeros((k, k));
    for (j, &w) in fit.weights.iter().enumerate() {
        let total = &grams.total[j].xx;
        let out = which.left_out.map(|f| &grams.folds[f][j].xx);
        let product = |r: usize, p: usize| w * (total[[r, p]] - out.map_or(0.0, |x| x[[r, p]]));
        for (a, v) in set.iter().enumerate() {
            let Some(row) = place(j, v) else { continue };
            for &(i, p) in &fit.places[j] {
                cross[[a, i]] += product(row, p);
            }
            for (b, x) in set.iter().enumerate() {
                own[[a, b]] += place(j, x).map_or(0.0, |p| product(row, p));
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
        let old = Array2::from_shape_fn((k, places.len()), |(a, i)| moved[[a, places[i].0]]);
        let mixed = Array2::from_shape_fn((places.len(), k), |(i, b)| {
            place(j, &set[b]).map_or(0.0, |p| xx[[places[i].1, p]])
        });
        let new = Array2::from_shape_fn((k, k), |(a, b)| {
            match (place(j, &set[a]), place(j, &set[b])) {
                (Some(p), Some(r)) => xx[[p, r]],
                _ => 0.0,
            }
        });
        let one = old.dot(&mixed);
        old.dot(&which.part.products[j]).dot(&old.t()) - &one - one.t() + new
    });
    Addition {
        change: change.collect(),
        factor: Cholesky::new(&schur),
        moved,
    }
}

fn state(fit: &Fit, which: Which, y: &RightHand) -> State {
    let grams = fit.grams;
    let dof = fit.weights.len();
    let folds = y.xy.len();
    let total = |j: usize| {
        let sum = Array1::zeros(y.xy[0][j].len());
        y.xy.iter().fold(sum, |sum, fold| sum + &fold[j])
    };
    let whole: Vec<Array1<f64>> = (0..dof).map(total).collect();
    let out = |j: usize| which.left_out.map(|f| &y.xy[f][j]);
    let mut right = Array1::<f64>::zeros(fit.variables.len());
    for (j, &w) in fit.weights.iter().enumerate() {
        for &(i, p) in &fit.places[j] {
            right[i] += w * (whole[j][p] - out(j).map_or(0.0, |x| x[p]));
        }
    }
    let beta = which.part.factor.solve(right.view());
    let (mut fitted, mut scored, mut error) = (Vec::new(), Vec::new(), Vec::new());
    for (j, whole) in whole.iter().enumerate() {
        let mut x = Array1::<f64>::zeros(whole.len());
        for &(i, p) in &fit.places[j] {
            x[p] += beta[i];
        }
        let all = whole - &grams.total[j].xx.dot(&x);
        let Some(f) = which.left_out else {
            let yy: f64 = (0..folds).map(|f| y.yy[f][j]).sum();
            error.push(yy - x.dot(whole) - x.dot(&all));
            scored.push(all.clone());
            fitted.push(all);
            continue;
        };
        let own = &y.xy[f][j] - &grams.folds[f][j].xx.dot(&x);
        error.push((y.yy[f][j] - x.dot(&y.xy[f][j]) - x.dot(&own)).max(0.0));
        fitted.push(all - &own);
        scored.push(own);
    }
    State {
        beta,
        fitted,
        scored,
        error,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::gram::{Grams, JointGram, Layout};
    use ndarray::Axis;
    use proptest::prelude::*;

    proptest! {
        /// The products' own torque as one of many gives the fit's own trial.
        #[test]
        fn one_of_many_is_the_trial_itself(values in prop::collection::vec(-1.0..1.0f64, 240)) {
            let layout = Layout::new(2, &[vec![0, 1], vec![0], vec![1], vec![0, 1]]);
            let folds: Vec<Vec<JointGram>> = values
                .chunks(80)
                .map(|c| {
                    let half = |x: &[f64]| {
                        let rows = Array2::from_shape_vec((10, 4), x.to_vec()).expect("40 values");
                        let ones = Array1::ones(10);
                        JointGram::new(
                            rows.slice_axis(Axis(1), (0..3).into()),
                            rows.column(3),
                            ones.view(),
                        )
                    };
                    vec![half(&c[..40]), half(&c[40..])]
                })
                .collect();
            let right = RightHand {
                xy: folds.iter().map(|f| f.iter().map(|g| g.xy.clone()).collect()).collect(),
                yy: folds.iter().map(|f| f.iter().map(|g| g.yy).collect()).collect(),
            };
            let grams = Grams::new(layout, folds);
            let v = |column| Variable { column, precision: 0.1 };
            let fit = Fit::new(&grams, vec![v(0), v(1)], vec![1.0, 2.0]);
            let sets = vec![vec![v(2), v(3)], vec![v(2)]];
            let many = Many::new(&fit, sets.clone());
            let fitted = many.fitted(&right);
            for (a, b) in fitted.error.iter().zip(fit.error()) {
                prop_assert!((a - b).abs() < 1e-9);
            }
            for (i, set) in sets.iter().enumerate() {
                let (own, other) = (many.trial(i, &fitted), fit.trial(set));
                for (a, b) in own.error.iter().zip(&other.error) {
                    prop_assert!((a - b).abs() < 1e-9, "{} {}", a, b);
                }
                prop_assert!((own.penalty - other.penalty).abs() < 1e-9);
                for (a, b) in own.gamma.iter().zip(&other.gamma) {
                    prop_assert!((a - b).abs() < 1e-9);
                }
            }
        }
    }
}
