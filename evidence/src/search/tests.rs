//! Decisions on made-up data, with numbers by hand.

use super::*;
use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;

fn simple(estimates: &[f64]) -> Problem {
    let p = estimates.len();
    let quadratic = Quadratic {
        at: estimates.to_vec(),
        gradient: DVector::zeros(p),
        information: DMatrix::identity(p, p),
    };
    let priors = vec![
        Prior {
            mean: 0.0,
            deviation: 10.0,
            positive: false
        };
        p
    ];
    let hypotheses = (0..p)
        .map(|i| Hypothesis {
            parameters: vec![i],
            family: i,
        })
        .collect();
    let alone = Family {
        odds: 0.1,
        places: 1,
        independent: false,
    };
    Problem::new(quadratic, priors, Vec::new(), hypotheses, vec![alone; p])
}

#[test]
fn what_is_many_deviations_away_is_named() {
    let problem = simple(&[8.0, 0.5, -6.0]);
    let decision = problem.decide(&[]);
    assert_eq!(decision.set, [0, 2]);
    assert!(decision.inclusion[0] > 0.99 && decision.inclusion[1] < 0.05);
    // Odds of the second parameter by hand: prior 0.1, evidence ratio of N(0.5; 0, 101) to N(0.5; 0, 1).
    let log = -0.125 / 101.0 - 0.5 * (101.0f64).ln() + 0.125;
    let odds = 0.1 * log.exp();
    assert!((decision.inclusion[1] - odds / (1.0 + odds)).abs() < 1e-3);
}

#[test]
fn what_cannot_be_told_apart_stands_in_its_place() {
    // Two parameters with the same effect on the data.
    let quadratic = Quadratic {
        at: vec![6.0, 0.0],
        gradient: DVector::zeros(2),
        information: DMatrix::from_element(2, 2, 1.0),
    };
    let problem = Problem {
        quadratic,
        ..simple(&[1.0, 1.0])
    };
    let decision = problem.decide(&[]);
    assert_eq!(decision.set.len(), 1);
    assert!((decision.swaps[0][0].weight - 1.0).abs() < 1e-9);
    assert!(decision.inclusion.iter().all(|p| (p - 0.5).abs() < 0.05));
}

#[test]
fn a_set_weighs_what_the_search_says_of_it() {
    let problem = simple(&[8.0, 0.5, -6.0]);
    let decision = problem.decide(&[]);
    let sets = [vec![0, 2], vec![0], vec![0, 1, 2]];
    let weights = problem.weigh(&sets);
    assert!((weights[0] - decision.log_posterior).abs() < 1e-12);
    assert!(weights[0] > weights[1] && weights[0] > weights[2]);
}

#[test]
fn what_acts_everywhere_costs_less_than_as_many_accidents() {
    let shared = Family {
        odds: 0.1,
        places: 4,
        independent: false,
    };
    // Four numbers of places with 1 + 1/2 + 1/3 + 1/4 = 25/12. One of four places, two (six sets), all.
    let of = |k: usize, share: f64| (shared.log_prior(k) - (0.1 * share * 12.0 / 25.0).ln()).abs();
    assert!(of(1, 1.0 / 4.0) < 1e-12);
    assert!(of(2, 1.0 / 12.0) < 1e-12);
    assert!(of(4, 1.0 / 4.0) < 1e-12);
    let all: f64 = [(1, 4.0), (2, 6.0), (3, 4.0), (4, 1.0)]
        .map(|(k, sets)| sets * shared.log_prior(k).exp())
        .iter()
        .sum();
    assert!((all - 0.1).abs() < 1e-12);
    let apart = Family {
        independent: true,
        ..shared
    };
    assert!((apart.log_prior(4) - 4.0 * (0.1f64).ln()).abs() < 1e-12);
}

#[test]
fn what_the_data_do_not_bear_on_is_not_listed() {
    // One place is shown to act. The prior alone would have all four act.
    let shared = Family {
        odds: 0.1,
        places: 4,
        independent: false,
    };
    let mut own = simple(&[9.0, 0.0, 0.0, 0.0]);
    own.hypotheses.iter_mut().for_each(|h| h.family = 0);
    for i in 1..4 {
        own.quadratic.information[(i, i)] = 0.0;
    }
    let problem = Problem::new(
        own.quadratic,
        own.priors,
        Vec::new(),
        own.hypotheses,
        vec![shared],
    );
    let decision = problem.decide(&[1]);
    assert_eq!(decision.set, [0]);
    assert_eq!(decision.inclusion[1], 0.0);
}

#[test]
fn what_cannot_be_negative_is_no_explanation_below_zero() {
    let mut problem = simple(&[-8.0]);
    let free = problem.decide(&[]);
    assert_eq!(free.set, [0]);
    problem.priors[0].positive = true;
    let bounded = problem.decide(&[]);
    assert!(bounded.set.is_empty() && bounded.inclusion[0] == 0.0);
    // Two such at the start do not stand in the way of a third.
    let mut problem = simple(&[-8.0, -7.0, 9.0]);
    problem.priors.iter_mut().for_each(|p| p.positive = true);
    let all = problem.decide(&[0, 1]);
    assert_eq!(all.set, [2]);
    assert!(all.inclusion[2] > 0.99);
}

proptest! {
    /// Independent parameters are decided as if each stood alone.
    #[test]
    fn independent_hypotheses_do_not_disturb_each_other(values in prop::collection::vec(-8.0..8.0f64, 1..5)) {
        let all = simple(&values).decide(&[]);
        for (i, v) in values.iter().enumerate() {
            let alone = simple(&[*v]).decide(&[]);
            prop_assert_eq!(all.set.contains(&i), alone.set.contains(&0));
        }
    }
}
