//! Criterion, selection and acceptance on one joint, with numbers worked out by hand.

use super::objective::Objective;
use super::select::{Search, without};
use crate::algebra::gram::{Grams, JointGram, Layout};
use crate::catalogue::candidate::Quantity;
use crate::catalogue::effect::Effect;
use crate::catalogue::{Bound, Candidate, Column, Unit};
use crate::motion::scene::Scale;
use crate::settings::SearchSettings;
use ndarray::{Array1, Array2, Axis};
use physics::robot::Robot;
use std::collections::HashSet;

const ROWS: usize = 200;
const FOLD: usize = 50;

/// A joint with 2 N·m of torque whose residuals are white: a row in 25 is independent as long as nothing is known of them.
fn scale() -> Scale {
    Scale {
        softness: vec![0.01],
        lead: vec![0.0],
        speed: vec![1.0],
        range: vec![(-1.0, 1.0)],
        torque: vec![2.0],
        session: (0.0, 10.0),
        step: 0.05,
        channel: None,
        correlation_rows: None,
    }
}

/// Products of columns with a gap, in four folds.
fn grams(columns: &[Array1<f64>], gap: &Array1<f64>) -> Grams {
    let layout = Layout::new(1, &vec![vec![0]; columns.len()]);
    let fold = |f: usize| {
        let rows = f * FOLD..(f + 1) * FOLD;
        let x = Array2::from_shape_fn((FOLD, columns.len()), |(i, c)| columns[c][rows.start + i]);
        let y = gap.slice_axis(Axis(0), rows.clone().into());
        vec![JointGram::new(x.view(), y, Array1::ones(FOLD).view())]
    };
    Grams::new(layout, (0..ROWS / FOLD).map(fold).collect())
}

fn sine(rate: f64) -> Array1<f64> {
    Array1::from_shape_fn(ROWS, |i| (rate * i as f64).sin())
}

/// Noise that no column of this file follows: +1, −1, +1 …
fn alternating(size: f64) -> Array1<f64> {
    Array1::from_shape_fn(ROWS, |i| if i % 2 == 0 { size } else { -size })
}

fn candidate(effect: Effect, bound: Bound) -> Candidate {
    let quantity = Quantity::plain("size", Unit::NewtonMetre, Some(0));
    let unused = Column::own(0, |scene| Array1::zeros(scene.len()));
    Candidate::single(effect, 0, quantity, bound, unused)
}

fn search<'a>(
    objective: &'a Objective<'a>,
    candidates: &'a [Candidate],
    members: &'a [Vec<usize>],
    robot: &'a Robot,
    chance: f64,
) -> Search<'a> {
    Search {
        objective,
        candidates,
        members,
        robot,
        base: Vec::new(),
        barred: HashSet::new(),
        chance,
        missing: Default::default(),
    }
}

fn pendulum() -> Robot {
    let body = r#"<inertial><origin xyz="0.1 0 0"/><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>"#;
    Robot::from_urdf_str(&format!(
        r#"<robot name="p"><link name="b"/><link name="l">{body}</link><joint name="j" type="continuous"><parent link="b"/><child link="l"/><axis xyz="0 1 0"/></joint></robot>"#
    ))
    .unwrap()
}

#[test]
fn the_criterion_counts_independent_samples_coefficients_and_bent_parameters() {
    let settings = SearchSettings {
        floor: 0.006,
        correlated_rows: 25.0,
        cost: 4.0,
        wide: 3.0,
        ..SearchSettings::default()
    };
    let grams = grams(&[Array1::ones(ROWS)], &alternating(0.2));
    let objective = Objective::new(&grams, &scale(), &settings);
    // 8 (N·m)² over 200 rows, and a floor of 0.006 · 2 N·m.
    assert!((objective.variance(&[8.0])[0] - 0.040_144).abs() < 1e-12);
    assert!((objective.relative(&[8.0])[0] - 0.1).abs() < 1e-12);
    assert!((objective.given()[0] - 0.1).abs() < 1e-12);
    // Eight independent samples: 4 · ln 0.040144, half the penalty of 3, two coefficients.
    let value = objective.value(&[8.0], 3.0, 2);
    assert!((value - (4.0 * -3.215_282_4 + 1.5 + 8.0)).abs() < 1e-6);
    assert!((objective.weights(&[8.0])[0] - 1.0 / (25.0 * 0.040_144)).abs() < 1e-9);
    // One unit of the column makes 1 N·m: three times the joint's 2 N·m is one deviation.
    assert!((objective.wide(0).precision - 1.0 / 36.0).abs() < 1e-12);
    assert_eq!(settings.correlated(0.5), settings.fewest_rows);
    assert_eq!(settings.correlated(1e3), 25.0);
}

#[test]
fn the_true_column_is_selected_alone_and_an_impossible_sign_is_not() {
    let settings = SearchSettings::default();
    let columns = [sine(0.3), sine(1.1), -sine(0.3)];
    let gap = 2.0 * &columns[0] + alternating(0.1);
    let grams = grams(&columns, &gap);
    let objective = Objective::new(&grams, &scale(), &settings);
    let candidates = [
        candidate(Effect::Counterbalance, Bound::Free),
        candidate(Effect::Counterbalance, Bound::Free),
        candidate(Effect::JointCoupling, Bound::Positive),
    ];
    let members = [vec![0], vec![1], vec![2]];
    let robot = pendulum();
    let search = search(&objective, &candidates, &members, &robot, 0.0);
    let found = search.run();
    assert_eq!(found.accepted, [0]);
    assert!((found.fit.beta()[0] - 2.0).abs() < 0.02);
    // The squared gap is 2² · ½ and 0.1² a row: what is left of it is the noise.
    let before = 2.0 + 0.01;
    let gain = search.tried(&search.fit(&[]), &[])[0].gain;
    let floor = (settings.floor * 2.0).powi(2);
    let by_hand =
        0.5 * ROWS as f64 / settings.correlated_rows * ((before + floor) / (0.01 + floor)).ln();
    assert!(
        (gain - (by_hand - settings.cost)).abs() < 0.6,
        "{gain} {by_hand}"
    );
    // One place of each effect, and one coefficient.
    assert_eq!(search.charge(&[0, 2]), 2.0 * settings.cost);
    // The same effect at the same place is closed, whatever its shape.
    assert!(!search.open(1, &[0]) && search.open(2, &[0]));
    assert_eq!(without(&[4, 7, 9], 1), [4, 9]);
}

#[test]
fn a_cause_has_to_earn_more_than_chance_and_be_visible() {
    let settings = SearchSettings::default();
    let columns = [sine(0.3)];
    let robot = pendulum();
    let candidates = [candidate(Effect::Counterbalance, Bound::Free)];
    let members = [vec![0]];
    let named = |size: f64, chance: f64| {
        let gap = size * &columns[0] + alternating(0.01);
        let grams = grams(&columns, &gap);
        let objective = Objective::new(&grams, &scale(), &settings);
        search(&objective, &candidates, &members, &robot, chance).accepts(0)
    };
    assert!(named(0.5, 0.0));
    // 0.5 N·m beside 0.01 N·m of noise gains 4 · ln((0.125 + 0.000244)/0.000244) − 4 = 21 nats.
    assert!(!named(0.5, 25.0));
    // 0.01 N·m is less than anybody sees of 2 N·m.
    assert!(!named(0.01, 0.0));
}
