//! Surrogate torques under the null hypothesis that no further effect is present.

use crate::algebra::batched_trials::RightHands;
use crate::algebra::fit::Fit;
use crate::search::products::Stretches;
use ndarray::{Array1, Array2, Axis};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::ops::Range;

/// Drawn surrogates: coefficients of the fit, shape (variables, surrogates), and the sign of each stretch,
/// shape (stretches, surrogates).
pub(super) struct Drawn {
    beta: Array2<f64>,
    pub(super) signs: Array2<f64>,
}

/// Draws the surrogates with the given numbers. Each has its own random stream, so that neither threads nor the
/// number drawn together changes any. Equal seed and recording give equal surrogates.
pub(super) fn draw(fit: &Fit, stretches: usize, seed: u64, numbers: Range<u64>) -> Drawn {
    let count = (numbers.end - numbers.start) as usize;
    let mut drawn = Drawn {
        beta: Array2::zeros((fit.variables.len(), count)),
        signs: Array2::zeros((stretches, count)),
    };
    for (s, number) in numbers.enumerate() {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(number);
        let noise: Array1<f64> = (0..fit.variables.len())
            .map(|_| StandardNormal.sample(&mut rng))
            .collect();
        drawn.beta.column_mut(s).assign(&fit.draw(noise.view()));
        let signs = drawn.signs.column_mut(s);
        signs
            .into_iter()
            .for_each(|x| *x = if rng.random_bool(0.5) { 1.0 } else { -1.0 });
    }
    drawn
}

impl Drawn {
    /// Sums of products of the columns with these torques.
    pub(super) fn products(&self, fit: &Fit, stretches: &Stretches) -> RightHands {
        let (folds, dof) = (fit.folds(), stretches.products.len());
        let mut out = RightHands {
            xy: Vec::with_capacity(folds),
            yy: Vec::with_capacity(folds),
            apart: None,
        };
        for f in 0..folds {
            let own: Vec<usize> = (0..stretches.fold.len())
                .filter(|&b| stretches.fold[b] == f)
                .collect();
            let signs = self.signs.select(Axis(0), &own);
            let (mut xy, mut yy) = (Vec::with_capacity(dof), Vec::with_capacity(dof));
            for j in 0..dof {
                let rest = stretches.products[j].select(Axis(1), &own).dot(&signs);
                let (columns, x) = fit.fitted_rows(j, &self.beta);
                let modelled = fit.products(f, j).columns(&columns).dot(&x);
                let squares: f64 = own.iter().map(|&b| stretches.squares[[b, j]]).sum();
                let cross = &modelled + &(2.0 * &rest);
                let cross = (&x * &cross.select(Axis(0), &columns)).sum_axis(Axis(0));
                yy.push(cross + squares);
                xy.push(modelled + rest);
            }
            out.xy.push(xy);
            out.yy.push(yy);
        }
        if !stretches.near.is_empty() {
            let apart = |f: usize| (0..dof).map(move |j| self.apart(fit, stretches, f, j));
            out.apart = Some((0..folds).map(|f| apart(f).collect()).collect());
        }
        out
    }

    /// Sums of products of a joint's columns with these torques, on the rows that are not fitted where a fold is scored.
    fn apart(&self, fit: &Fit, stretches: &Stretches, fold: usize, joint: usize) -> Array2<f64> {
        let own: Vec<usize> = (0..stretches.fold.len())
            .filter(|&b| stretches.fold[b] == fold)
            .collect();
        let near: Vec<usize> = (0..stretches.near.len())
            .filter(|&p| stretches.near[p].fold == fold)
            .collect();
        let of: Vec<usize> = near.iter().map(|&p| stretches.near[p].stretch).collect();
        let rest = |products: &Array2<f64>, parts: &[usize], signs: &[usize]| {
            let products = products.select(Axis(1), parts);
            products.dot(&self.signs.select(Axis(0), signs))
        };
        let (columns, x) = fit.fitted_rows(joint, &self.beta);
        let modelled = fit.products_apart(fold, joint).columns(&columns);
        modelled.dot(&x)
            + rest(&stretches.products[joint], &own, &own)
            + rest(&stretches.near_products[joint], &near, &of)
    }
}
