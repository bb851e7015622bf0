//! Search for causes by their posterior probability.
//!
//! A hypothesis is a candidate of the catalogue. Its coefficients have normal priors, so that the evidence of a set of
//! hypotheses has a closed form, given the noise. The noise of a joint is white, with a larger variance near reversals,
//! beside a slow discrepancy and a smooth torque of its state that nobody has named. Posterior odds are evidence times the
//! prior odds of the mechanism at its places. Each set has the tolerances of the description under which it is most probable.

mod material;
mod noise;
mod posterior;
mod priors;
mod rows;
mod search;
mod unknown;

use crate::motion::frame::Frame;
use crate::motion::scene::Scene;
use crate::search::model_comparison::{Answer, Simplest};
use ndarray::Array2;
use noise::{Shape, likeliest};
use priors::Size;
use rayon::prelude::*;
use search::ByEvidence;

pub(super) use material::Material;

/// Largest number of times that the noise's shape is found from the residual.
const ROUNDS: usize = 2;

/// Features of the unknown torque of each joint, shape (features, rows).
pub(super) fn features(scene: &Scene, frame: &Frame) -> Vec<Array2<f64>> {
    (0..scene.dof())
        .into_par_iter()
        .map(|j| unknown::features(scene, frame, j))
        .collect()
}

/// Most probable set of causes.
pub(super) fn answer<'a>(simplest: &'a Simplest<'a>, material: &Material) -> Answer<'a> {
    let dof = material.y.ncols();
    let mut shapes: Vec<Shape> = Vec::new();
    let mut residual = material.residual.clone();
    let mut found = None;
    for _ in 0..ROUNDS {
        let of = |j: usize| {
            let (left, weight) = (residual.column(j), material.weight.column(j));
            likeliest(left, weight, &material.frame.rows)
        };
        let next: Vec<Shape> = (0..dof).into_par_iter().map(of).collect();
        if next == shapes {
            break;
        }
        shapes = next;
        let search = ByEvidence::new(simplest, material, &shapes);
        let best = search.run(found.take());
        residual = material.left(&best.posterior);
        found = Some((best.set, best.freedom));
    }
    let (set, freedom) = found.expect("one round at least");
    let large = set.into_iter().filter(|m| m.1 == Size::Large);
    simplest.given(freedom, large.map(|m| m.0).collect())
}
