use super::*;
use crate::least_squares::{SolveOptions, Triangle, solve};
use ndarray::{Array1, Array2};
use serde_json::Value;

fn fixture() -> Value {
    serde_json::from_str(include_str!("../../tests/fixtures/feasible.json")).unwrap()
}

fn vector(v: &Value) -> Vec<f64> {
    v.as_array()
        .unwrap()
        .iter()
        .map(|x| x.as_f64().unwrap())
        .collect()
}

fn matrix(v: &Value) -> Array2<f64> {
    let rows: Vec<Vec<f64>> = v.as_array().unwrap().iter().map(vector).collect();
    Array2::from_shape_fn((rows.len(), rows[0].len()), |(i, j)| rows[i][j])
}

fn problem(f: &Value) -> (Feasibility, Triangle, f64) {
    let grouping = matrix(&f["grouping"]);
    let grouping = Mat::from_fn(grouping.nrows(), grouping.ncols(), |i, j| grouping[(i, j)]);
    let nominal = Nominal {
        parameters: vector(&f["nominal"]),
        std: vector(&f["std"]),
    };
    let feasibility =
        Feasibility::new(grouping.as_ref(), Constraints::new(2, [20, 21]), nominal).unwrap();
    let triangle =
        Triangle::of(matrix(&f["r"]).view(), Array1::from(vector(&f["z"])).view()).unwrap();
    (feasibility, triangle, f["sigma2"].as_f64().unwrap())
}

/// Σ ((x − x̄)/s)².
fn distance(nominal: &Nominal, x: &[f64]) -> f64 {
    (0..x.len())
        .map(|j| ((x[j] - nominal.parameters[j]) / nominal.std[j]).powi(2))
        .sum()
}

fn assert_near(x: &[f64], expected: &[f64], std: &[f64], tolerance: f64) {
    for j in 0..x.len() {
        let off = (x[j] - expected[j]).abs() / std[j];
        assert!(
            off < tolerance,
            "parameter {j}: {} against {}",
            x[j],
            expected[j]
        );
    }
}

#[test]
fn clarabel_agrees_on_the_constrained_fit() {
    let f = fixture();
    let (feasibility, triangle, sigma2) = problem(&f);
    let found = feasibility.fit(&triangle, sigma2).unwrap();
    assert_eq!(found.status, Status::Solved);
    assert!(found.steps < 60, "{}", found.steps);
    let value = triangle.residual_sum_of_squares(&found.base).unwrap() / sigma2
        + distance(feasibility.nominal(), &found.standard);
    let expected = f["fit"]["value"].as_f64().unwrap();
    // The gap bounds the objective; Clarabel's own is below 1e-8.
    assert!(
        (value - expected).abs() < 2e-6,
        "{value} against {expected}"
    );
    let std = &feasibility.nominal().std;
    assert_near(&found.standard, &vector(&f["fit"]["x"]), std, 1e-4);
    assert!(found.smallest_eigenvalue > 0.0);
    assert!(feasibility.constraints().hold(&found.standard));
}

#[test]
fn the_fixture_needs_the_constraints() {
    let f = fixture();
    let (feasibility, triangle, sigma2) = problem(&f);
    let free = solve(&triangle, &SolveOptions::default()).unwrap();
    let found = feasibility.fit(&triangle, sigma2).unwrap();
    let excess = triangle.residual_sum_of_squares(&found.base).unwrap()
        - triangle.residual_sum_of_squares(&free.parameters).unwrap();
    assert!(
        excess > sigma2,
        "the unconstrained estimate is possible: {excess}"
    );
}

#[test]
fn correcting_a_finished_estimate_equals_fitting_with_constraints() {
    let f = fixture();
    let (feasibility, triangle, sigma2) = problem(&f);
    let free = solve(&triangle, &SolveOptions::default()).unwrap();
    let information = faer::Scale(1.0 / sigma2) * (triangle.r().transpose() * triangle.r());
    let nearest = feasibility
        .nearest(&free.parameters, information.as_ref())
        .unwrap();
    let fitted = feasibility.fit(&triangle, sigma2).unwrap();
    let std = &feasibility.nominal().std;
    assert_near(&nearest.standard, &fitted.standard, std, 1e-4);
}

#[test]
fn clarabel_agrees_on_the_nearest_parameters_that_reproduce() {
    let f = fixture();
    let (feasibility, ..) = problem(&f);
    let expected = &f["reproduce"];
    let beta = vector(&expected["beta"]);
    let found = feasibility.standard_from(&beta).unwrap();
    for (found, beta) in std::iter::zip(&found.base, &beta) {
        assert!((found - beta).abs() < 1e-12);
    }
    assert!(feasibility.constraints().hold(&found.standard));
    let distance = distance(feasibility.nominal(), &found.standard);
    let least = expected["value"].as_f64().unwrap();
    assert!(
        (distance - least).abs() < 1e-5 * least,
        "{distance} against {least}"
    );
    let std = &feasibility.nominal().std;
    assert_near(&found.standard, &vector(&expected["x"]), std, 1e-3);
}

#[test]
fn an_impossible_base_is_brought_to_the_border() {
    let f = fixture();
    let (feasibility, ..) = problem(&f);
    let mut beta = vector(&f["reproduce"]["beta"]);
    beta.iter_mut().for_each(|b| *b = -*b);
    let found = feasibility.standard_from(&beta).unwrap();
    assert!(feasibility.constraints().hold(&found.standard));
    let off: f64 = std::iter::zip(&found.base, &beta)
        .map(|(a, b)| (a - b).abs())
        .sum();
    assert!(off > 0.1);
}

#[test]
fn bad_input_is_refused() {
    let f = fixture();
    let (feasibility, ..) = problem(&f);
    assert!(feasibility.standard_from(&[1.0]).is_err());
    let g = Mat::<f64>::identity(10, 10);
    let nominal = Nominal {
        parameters: vec![1.0; 10],
        std: vec![1.0; 10],
    };
    let error = Feasibility::new(g.as_ref(), Constraints::new(1, [10]), nominal.clone());
    assert!(matches!(
        error,
        Err(FeasibilityError::NoSuchParameter { index: 10, .. })
    ));
    let flat = Nominal {
        std: vec![0.0; 10],
        ..nominal
    };
    let error = Feasibility::new(g.as_ref(), Constraints::new(1, []), flat);
    assert!(matches!(
        error,
        Err(FeasibilityError::BadDeviation { index: 0 })
    ));
}
