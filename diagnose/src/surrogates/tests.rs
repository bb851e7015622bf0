mod decoys;

use super::*;
use crate::Options;
use crate::diagnosis::first_search;
use std::collections::BTreeMap;
use trials::cases::{draw as drawn, generate};

/// Surrogates of one null.
const SURROGATES: u64 = 199;
/// Number of further surrogates that are judged against the null.
const FURTHER: u64 = 200;

/// A recording's null, and further surrogates of it.
fn nulls(index: u64, seed: u64) -> [Null; 2] {
    let case = generate(&drawn(index, seed), seed).unwrap();
    let model = NominalModel::new(physics::robot::Robot::from_urdf_str(&case.urdf).unwrap());
    let recordings = [&case.train, &case.test];
    let (frames, found, weight) = first_search(&model, recordings, &Options::default()).unwrap();
    let last = SURROGATES + FURTHER;
    with(&model, &frames, &found, &weight, |source| {
        [0..SURROGATES, SURROGATES..last].map(|s| source.null(s))
    })
}

/// How many of some gains have p < 0.05 against a null's.
fn rare(null: &[f64], gains: &[f64]) -> usize {
    let p =
        |g: f64| (1 + null.iter().filter(|n| **n >= g).count()) as f64 / (1 + null.len()) as f64;
    gains.iter().filter(|g| p(**g) < 0.05).count()
}

#[test]
#[ignore = "long: by hand, with --ignored"]
fn p_values_are_what_they_say() {
    let all: Vec<[Null; 2]> = (0..5).map(|index| nulls(index, 40_961)).collect();
    let largest: usize = all.iter().map(|[n, f]| rare(&n.largest, &f.largest)).sum();
    let share = largest as f64 / (all.len() as u64 * FURTHER) as f64;
    println!("largest gain: {share:.3} have p < 0.05");
    assert!((0.03..=0.07).contains(&share), "{share}");
    let (mut rare_own, mut judged) = (0, 0);
    for [null, further] in &all {
        for (effect, own) in &null.by_effect {
            // Where a candidate's bounds refuse nearly every surrogate there is no gain to judge.
            if own.iter().filter(|g| g.is_finite()).count() < own.len() / 4 {
                continue;
            }
            rare_own += rare(own, &further.by_effect[effect]);
            judged += FURTHER as usize;
        }
    }
    let share = rare_own as f64 / judged as f64;
    println!("each effect's own: {share:.3} of {judged}");
    assert!((0.03..=0.07).contains(&share), "{share}");
}

#[test]
fn a_level_is_what_one_in_a_hundred_reaches() {
    let null = Null {
        largest: (0..199).map(f64::from).collect(),
        by_effect: BTreeMap::new(),
    };
    assert_eq!(null.level(), 197.0);
    let p = |gain| null.p_value(Effect::StribeckFriction, gain).unwrap();
    assert!(p(198.0) <= 0.01 && p(197.0) > 0.01);
    assert_eq!(null.p_value(Effect::FrictionParameters, 5.0), None);
}
