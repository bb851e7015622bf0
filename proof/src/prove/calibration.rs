//! Weights of the evidence for a name, by logistic regression over cases with known truth.

use super::named::Named;
use super::score::Score;
use diagnose::confidence::{TERMS, WEIGHTS, probability};
use nalgebra::{SMatrix, SVector};
use report::{Cell, Column, Table};

/// Prior standard deviation of a weight, per unit of its term's spread: a weight that few cases determine stays small.
const PRIOR: f64 = 1.0;
/// Least precision of a weight: a term that is equal in all cases adds nothing to the constant.
const LEAST: f64 = 1e-6;
/// Number of steps of Newton's method; it converges in a few.
const STEPS: usize = 50;

type Terms = SVector<f64, WEIGHTS>;

/// Weights, in the order of [`TERMS`], with which names are right as often as their confidence states.
fn fit<'a>(named: impl Iterator<Item = &'a Named>) -> [f64; WEIGHTS] {
    let named: Vec<(Terms, bool)> = named.map(|n| (n.support.terms().into(), n.right)).collect();
    let count = named.len().max(1) as f64;
    let mean = named.iter().map(|n| n.0).sum::<Terms>() / count;
    let squares = named
        .iter()
        .map(|n| (n.0 - mean).component_mul(&(n.0 - mean)));
    let spread = squares.sum::<Terms>() / count;
    let precision = (spread / PRIOR.powi(2)).add_scalar(LEAST);
    let prior = SMatrix::<f64, WEIGHTS, WEIGHTS>::from_diagonal(&precision);
    let mut weights = Terms::zeros();
    for _ in 0..STEPS {
        let mut slope = -prior * weights;
        let mut curvature = prior;
        for (terms, right) in &named {
            let p = probability(&(*terms).into(), &weights.into());
            slope += terms * (f64::from(u8::from(*right)) - p);
            curvature += terms * terms.transpose() * (p * (1.0 - p));
        }
        let Some(step) = curvature.cholesky().map(|c| c.solve(&slope)) else {
            break;
        };
        // Where the curve is flat, a whole step would overshoot.
        weights += step * (1.0 / step.norm()).min(1.0);
    }
    weights.into()
}

/// Confidence of each structural cause by the weights that all other cases give, and whether effect and joint are right.
pub fn left_out(cases: &[Score]) -> Vec<(f64, bool)> {
    let one = |left_out: usize| {
        let others = cases.iter().enumerate().filter(move |c| c.0 != left_out);
        let weights = fit(others.flat_map(|c| &c.1.named));
        let own = cases[left_out].named.iter();
        own.map(move |n| (probability(&n.support.terms(), &weights), n.right))
    };
    let with_names = (0..cases.len()).filter(|&c| !cases[c].named.is_empty());
    with_names.flat_map(one).collect()
}

/// The weights that these cases give, for the settings.
pub fn table(cases: &[Score]) -> Table {
    let table = Table::new([Column::text("weight of"), Column::number("fitted")]);
    let weights = fit(cases.iter().flat_map(|c| &c.named));
    TERMS.into_iter().zip(weights).fold(table, |t, (of, w)| {
        t.row([Cell::text(of), Cell::number(w, 3)])
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use diagnose::schema::Support;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    const TRUTH: [f64; WEIGHTS] = [-1.5, 0.8, -0.5];

    /// Cases of one name each, drawn with the true weights.
    fn cases(count: usize) -> Vec<Score> {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let mut one = || {
            let support = Support {
                lead: rng.random_range(0.0..100.0),
                left: rng.random_range(0.0..0.2),
            };
            let right = rng.random_bool(probability(&support.terms(), &TRUTH));
            Score {
                named: vec![Named { support, right }],
                ..Score::default()
            }
        };
        (0..count).map(|_| one()).collect()
    }

    #[test]
    fn confidences_come_back_from_names_drawn_with_them() {
        let cases = cases(20_000);
        let weights = fit(cases.iter().flat_map(|c| &c.named));
        let by = |support: &Support, weights| probability(&support.terms(), weights);
        for named in cases.iter().flat_map(|c| &c.named) {
            let (found, truth) = (by(&named.support, &weights), by(&named.support, &TRUTH));
            assert!((found - truth).abs() < 0.06, "{found} for {truth}");
        }
    }

    #[test]
    fn a_case_left_out_has_no_say_in_its_own_confidence() {
        let mut cases = cases(40);
        let before = left_out(&cases);
        cases[0].named[0].right = !cases[0].named[0].right;
        let after = left_out(&cases);
        assert_eq!(before[0].0, after[0].0);
        assert_ne!(before[1].0, after[1].0);
    }

    #[test]
    fn names_that_are_all_right_give_finite_weights() {
        let mut cases = cases(20);
        cases.iter_mut().for_each(|c| c.named[0].right = true);
        let weights = fit(cases.iter().flat_map(|c| &c.named));
        assert!(weights.iter().all(|w| w.is_finite()), "{weights:?}");
    }
}
