//! Metrics and baselines against NumPy and nfoursid: `fixtures/baselines.py`.

use datasets::metrics::{Scope, Scores};
use model::baseline::{ForwardSettings, LinearForward, LinearInverse};
use ndarray::Array2;
use serde::Deserialize;
use std::collections::BTreeMap;

type Table = Vec<Vec<f64>>;

#[derive(Deserialize)]
struct Fixture {
    metrics: Metrics,
    inverse: Inverse,
    forward: Forward,
}

#[derive(Deserialize)]
struct Metrics {
    measured: Table,
    predicted: Table,
    qd: Table,
    scores: BTreeMap<String, Scores>,
}

#[derive(Deserialize)]
struct Inverse {
    q: Table,
    qd: Table,
    qdd: Table,
    tau: Table,
    matrix: Table,
    predicted: Table,
}

#[derive(Deserialize)]
struct Forward {
    u: Table,
    y: Table,
    /// Real part and absolute imaginary part, sorted.
    eigenvalues: Vec<[f64; 2]>,
    /// C Aᵏ B for k = 0 … 9.
    impulse: Vec<Table>,
    nfoursid_eigenvalues: Vec<[f64; 2]>,
}

fn fixture() -> Fixture {
    serde_json::from_str(include_str!("../fixtures/baselines.json")).unwrap()
}

fn array(rows: &Table) -> Array2<f64> {
    Array2::from_shape_fn((rows.len(), rows[0].len()), |(i, j)| rows[i][j])
}

fn worst<'a>(a: impl IntoIterator<Item = &'a f64>, b: impl IntoIterator<Item = &'a f64>) -> f64 {
    std::iter::zip(a, b).fold(0.0, |w, (a, b)| w.max((a - b).abs()))
}

#[test]
fn scores_equal_numpy() {
    let f = fixture().metrics;
    let [measured, predicted, qd] = [&f.measured, &f.predicted, &f.qd].map(array);
    for scope in Scope::BOTH {
        let found = Scores::of(measured.view(), predicted.view(), qd.view(), scope).unwrap();
        let expected = &f.scores[scope.name()];
        for (found, expected) in [
            (&found.rmse, &expected.rmse),
            (&found.nrmse, &expected.nrmse),
            (&found.r2, &expected.r2),
            (
                &vec![found.mean_nrmse, found.mean_r2],
                &vec![expected.mean_nrmse, expected.mean_r2],
            ),
        ] {
            assert_eq!(found.len(), expected.len());
            let error = worst(found.iter().flatten(), expected.iter().flatten());
            assert!(
                found.iter().all(Option::is_some) && error < 1e-10,
                "{error}"
            );
        }
    }
}

#[test]
fn inverse_baseline_equals_numpy() {
    let f = fixture().inverse;
    let [q, qd, qdd, tau] = [&f.q, &f.qd, &f.qdd, &f.tau].map(array);
    let model = LinearInverse::fit(q.view(), qd.view(), qdd.view(), tau.view()).unwrap();
    let error = worst(model.matrix.iter().flatten(), f.matrix.iter().flatten());
    assert!(error < 1e-10, "{error}");
    let predicted = model.predict(q.view(), qd.view(), qdd.view()).unwrap();
    let error = worst(&predicted, f.predicted.iter().flatten());
    assert!(error < 1e-10, "{error}");
}

/// Eigenvalues as the fixture has them.
fn eigenvalues(a: &Table) -> Vec<[f64; 2]> {
    let a = faer::Mat::from_fn(a.len(), a.len(), |i, j| a[i][j]);
    let mut found: Vec<[f64; 2]> = a
        .eigenvalues()
        .unwrap()
        .iter()
        .map(|z| [z.re, z.im.abs()])
        .collect();
    found.sort_by(|a, b| a[0].total_cmp(&b[0]));
    found
}

fn settings() -> ForwardSettings {
    ForwardSettings {
        order: 4,
        horizon: 10,
        feedthrough: false,
    }
}

#[test]
fn a_known_system_is_recovered_as_well_as_by_nfoursid() {
    let f = fixture().forward;
    let (u, y) = (array(&f.u), array(&f.y));
    let whole = 0..u.nrows();
    let model = LinearForward::fit(
        u.view(),
        y.view(),
        std::slice::from_ref(&whole),
        &settings(),
    )
    .unwrap();
    let found = eigenvalues(&model.system.a);
    let error = |e: &[[f64; 2]]| worst(e.iter().flatten(), f.eigenvalues.iter().flatten());
    let (ours, theirs) = (error(&found), error(&f.nfoursid_eigenvalues));
    // Noise of 1 % of the signal; the other program's error is the yardstick.
    assert!(
        ours < 2e-3 && ours < 2.0 * theirs.max(1e-3),
        "{ours} {theirs}"
    );

    // Impulse response in the units of the tables: C Aᵏ B, whatever the basis of the states.
    let s = &model.system;
    let (a, mut b, c) = (array(&s.a), array(&s.b), array(&s.c));
    for expected in &f.impulse {
        let response = c.dot(&b);
        for ((o, i), value) in response.indexed_iter() {
            let value = value * model.output.std[o] / model.input.std[i];
            assert!(
                (value - expected[o][i]).abs() < 0.02,
                "{value} {}",
                expected[o][i]
            );
        }
        b = a.dot(&b);
    }
    let json = serde_json::to_string(&model).unwrap();
    assert_eq!(serde_json::from_str::<LinearForward>(&json).unwrap(), model);
}

#[test]
fn nothing_reaches_over_a_break() {
    let f = fixture().forward;
    let (mut u, mut y) = (array(&f.u), array(&f.y));
    let trajectories = [0..200, 230..400];
    // What lies between the trajectories is put in reverse order: only the normalisation sees it.
    let fit = |u: &Array2<f64>, y: &Array2<f64>| {
        LinearForward::fit(u.view(), y.view(), &trajectories, &settings()).unwrap()
    };
    let before = fit(&u, &y);
    for table in [&mut u, &mut y] {
        let between = table.slice(ndarray::s![200..230, ..]).to_owned();
        let reversed = between.slice(ndarray::s![..;-1, ..]);
        table.slice_mut(ndarray::s![200..230, ..]).assign(&reversed);
    }
    let model = fit(&u, &y);
    // Compared by what they do: near-equal singular values leave the basis of the states open.
    let outputs = |m: &LinearForward| m.simulate(u.view(), &trajectories).unwrap();
    let difference = worst(&outputs(&before), &outputs(&model));
    assert!(difference < 1e-8, "{difference}");

    let both = model.simulate(u.view(), &trajectories).unwrap();
    let second = u.slice(ndarray::s![230.., ..]);
    let whole = 0..second.nrows();
    let alone = model
        .simulate(second, std::slice::from_ref(&whole))
        .unwrap();
    assert_eq!(both.slice(ndarray::s![230.., ..]), alone);
}

#[test]
fn data_that_cannot_be_used_are_refused() {
    use model::baseline::BaselineError;
    let f = fixture().forward;
    let (u, y) = (array(&f.u), array(&f.y));
    let fit = |trajectories: &[std::ops::Range<usize>], order| {
        let settings = ForwardSettings {
            order,
            ..settings()
        };
        LinearForward::fit(u.view(), y.view(), trajectories, &settings).unwrap_err()
    };
    assert_eq!(fit(&[0..200, 200..401], 4), BaselineError::Trajectory(1));
    assert_eq!(fit(&[0..200, 200..400], 0), BaselineError::Settings);
    let short: Vec<_> = (0..20).map(|k| 20 * k..20 * k + 19).collect();
    assert_eq!(
        fit(&short, 4),
        BaselineError::TooShort {
            found: 0,
            needed: 80
        }
    );
}
