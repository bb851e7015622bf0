use super::*;
use ndarray::{Array1, Array2, Axis};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use serde_json::Value;

fn fixture() -> Value {
    serde_json::from_str(include_str!("../../tests/fixtures/least_squares.json")).unwrap()
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

fn indices(v: &Value) -> Vec<usize> {
    vector(v).into_iter().map(|x| x as usize).collect()
}

fn assert_close(found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len());
    let size = expected.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    for (f, e) in std::iter::zip(found, expected) {
        assert!(
            (f - e).abs() <= tolerance * size,
            "{found:?} against {expected:?}"
        );
    }
}

fn noise(rng: &mut ChaCha8Rng, rows: usize, columns: usize) -> Array2<f64> {
    Array2::from_shape_simple_fn((rows, columns), || rng.sample(StandardNormal))
}

#[test]
fn numpy_agrees() {
    let f = fixture();
    let (a, b) = (matrix(&f["a"]), Array1::from(vector(&f["b"])));
    let scale = Array1::from(vector(&f["scale"]));
    let plain = Triangle::of(a.view(), b.view()).unwrap();
    let mut rows = Accumulator::new(a.ncols());
    rows.push_rows(a.view(), b.view(), Some(scale.view()))
        .unwrap();
    let weighted = rows.finish().unwrap();
    for (triangle, name) in [(&plain, "plain"), (&weighted, "weighted")] {
        let expected = &f[name];
        let fit = solve(triangle, &SolveOptions::default()).unwrap();
        assert_close(&fit.parameters, &vector(&expected["x"]), 1e-11);
        let covariance = matrix(&expected["covariance"]);
        assert_close(
            fit.covariance.as_slice().unwrap(),
            covariance.as_slice().unwrap(),
            1e-10,
        );
        let rss = expected["rss"].as_f64().unwrap();
        assert_close(&[fit.residual_sum_of_squares], &[rss], 1e-11);
        assert_close(
            &[fit.sigma2],
            &[expected["sigma2"].as_f64().unwrap()],
            1e-11,
        );
        assert_eq!((fit.rank, fit.rows), (5, 40));
        // Rows in units of their noise instead of a variance that is estimated.
        let noise = fit.sigma2.sqrt();
        let formal = Gram::from(triangle).scaled(1.0 / noise).deviations();
        let deviations = covariance.diag().mapv(f64::sqrt).to_vec();
        assert_close(&formal.unwrap(), &deviations, 1e-8);
    }

    let subset = indices(&f["subset"]["columns"]);
    let options = SolveOptions {
        columns: Some(subset.clone()),
        ..SolveOptions::default()
    };
    let fit = solve(&weighted, &options).unwrap();
    let (x, rss) = (
        vector(&f["subset"]["x"]),
        f["subset"]["rss"].as_f64().unwrap(),
    );
    assert_close(&[fit.residual_sum_of_squares], &[rss], 1e-11);
    let picked: Vec<f64> = subset.iter().map(|&c| fit.parameters[c]).collect();
    assert_close(&picked, &x, 1e-11);
    let gram = Gram::from(&weighted).fit(&subset, 0.0).unwrap().unwrap();
    assert_close(&gram.parameters, &x, 1e-8);
    assert_close(&[gram.residual_sum_of_squares], &[rss], 1e-8);

    let parts = SubRegressors::of(&plain, &[1, 2], &[], &[0]).unwrap();
    let expected = &f["condition"];
    assert_close(
        &[parts.whole],
        &[expected["whole"].as_f64().unwrap()],
        1e-10,
    );
    let part = expected["part"].as_f64().unwrap();
    assert_close(&[parts.inertial.unwrap()], &[part], 1e-10);
    assert_eq!(parts.gravity, None);
    assert_close(&[parts.friction.unwrap()], &[1.0], 1e-12);
}

#[test]
fn prior_is_the_posterior_mean_of_numpy() {
    let f = fixture();
    let triangle =
        Triangle::of(matrix(&f["a"]).view(), Array1::from(vector(&f["b"])).view()).unwrap();
    let expected = &f["prior"];
    let options = SolveOptions {
        prior: Some(Prior {
            mean: vector(&expected["mean"]),
            std: vector(&expected["std"]),
        }),
        sigma2: Some(0.01),
        ..SolveOptions::default()
    };
    let fit = solve(&triangle, &options).unwrap();
    assert_close(&fit.parameters, &vector(&expected["x"]), 1e-11);
    let covariance = matrix(&expected["covariance"]);
    assert_close(
        fit.covariance.as_slice().unwrap(),
        covariance.as_slice().unwrap(),
        1e-10,
    );
}

#[test]
fn prior_carries_short_data() {
    // Three rows for five parameters: the prior decides what they leave open.
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let a = noise(&mut rng, 3, 5);
    let mean = vec![1.0, 2.0, 3.0, 4.0, 5.0];
    let b = a.dot(&Array1::from(mean.clone()));
    let options = SolveOptions {
        prior: Some(Prior {
            mean: mean.clone(),
            std: vec![0.1; 5],
        }),
        ..SolveOptions::default()
    };
    let fit = solve(&Triangle::of(a.view(), b.view()).unwrap(), &options).unwrap();
    assert_close(&fit.parameters, &mean, 1e-12);
    assert_eq!(fit.rank, 3);
}

#[test]
fn a_column_that_never_moves_is_held_at_zero() {
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    let mut a = noise(&mut rng, 2000, 4);
    a.column_mut(1).fill(0.0);
    let b = a.dot(&Array1::from(vec![1.0, 7.0, -2.0, 0.5]));
    let fit = solve(
        &Triangle::of(a.view(), b.view()).unwrap(),
        &SolveOptions::default(),
    )
    .unwrap();
    assert_close(&fit.parameters, &[1.0, 0.0, -2.0, 0.5], 1e-12);
    assert_eq!(fit.rank, 3);
}

#[test]
fn three_standard_deviations_hold_the_truth() {
    // 200 repetitions of 6 parameters: 99.73 % of 1200 within 3σ, so 3.2 outside on average; 12 or more
    // has a probability below 1e-3.
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let truth = Array1::from(vec![1.0, -2.0, 0.1, 30.0, 0.0, -0.5]);
    let mut outside = 0;
    for _ in 0..200 {
        let a = noise(&mut rng, 80, 6);
        let e = noise(&mut rng, 80, 1);
        let b = a.dot(&truth) + &e.column(0) * 0.3;
        let fit = solve(
            &Triangle::of(a.view(), b.view()).unwrap(),
            &SolveOptions::default(),
        )
        .unwrap();
        outside += (0..6)
            .filter(|&j| (fit.parameters[j] - truth[j]).abs() > 3.0 * fit.std[j])
            .count();
    }
    assert!((1..12).contains(&outside), "{outside}");
}

#[test]
fn bad_input_is_refused() {
    let mut rows = Accumulator::new(2);
    assert!(matches!(
        rows.push(&[1.0], 0.0, 1.0),
        Err(LeastSquaresError::Size { .. })
    ));
    rows.push(&[1.0, f64::NAN], 0.0, 1.0).unwrap();
    assert_eq!(rows.finish().unwrap_err(), LeastSquaresError::NotFinite);
    let empty = Triangle::empty(2);
    assert_eq!(
        solve(&empty, &SolveOptions::default()).unwrap_err(),
        LeastSquaresError::NoRows
    );
    assert!(matches!(
        empty.select(&[2]),
        Err(LeastSquaresError::NoSuchColumn { .. })
    ));
    assert!(empty.residual_sum_of_squares(&[1.0]).is_err());
}

#[test]
fn sums_follow_their_rows() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let a = noise(&mut rng, 50, 2);
    let b = noise(&mut rng, 50, 1).column(0).to_owned();
    let triangle = Triangle::of(a.view(), b.view()).unwrap();
    let gram = Gram::from(&triangle);
    let mean = [2.0, -0.5];
    let about = gram.about(&mean).unwrap();
    let error = |g: &Gram, x: &[f64]| g.residual_sum_of_squares(&[0, 1], x).unwrap();
    // A (x − mean) − (b − A mean) = A x − b.
    let (x, off) = ([0.7, 0.1], [0.7 - mean[0], 0.1 - mean[1]]);
    assert!((error(&about, &off) - error(&gram, &x)).abs() < 1e-9);
    assert!((error(&gram.scaled(3.0), &x) / error(&gram, &x) - 9.0).abs() < 1e-9);
    let placed = gram.embed(&[2, 0], 4).unwrap();
    let far = placed.residual_sum_of_squares(&[2, 0], &x).unwrap();
    assert!((far - error(&gram, &x)).abs() < 1e-9);
    assert!(gram.embed(&[4, 0], 4).is_err() && gram.about(&[1.0]).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn groups_stack_into_the_whole(
        seed in 0u64..1000, p in 1usize..12, rows in 1usize..3000, cut in 0.0..1.0f64, dependent: bool,
    ) {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut a = noise(&mut rng, rows, p);
        if dependent && p > 2 {
            // A column of zeros and a repeated one: no rank may be assumed.
            a.column_mut(0).fill(0.0);
            let copy = a.column(1).to_owned();
            a.column_mut(p - 1).assign(&copy);
        }
        let b = noise(&mut rng, rows, 1).column(0).to_owned();
        let at = (rows as f64 * cut) as usize;
        let (a0, a1) = a.view().split_at(Axis(0), at);
        let (b0, b1) = b.view().split_at(Axis(0), at);
        let parts = [Triangle::of(a0, b0).unwrap(), Triangle::of(a1, b1).unwrap()];
        let stacked = Triangle::stack(&parts).unwrap();
        prop_assert_eq!(stacked.rows(), rows);
        // Against the rows themselves, for random parameter vectors.
        for _ in 0..3 {
            let x = noise(&mut rng, p, 1).column(0).to_owned();
            let direct = (a.dot(&x) - &b).mapv(|e| e * e).sum();
            let from = stacked.residual_sum_of_squares(x.as_slice().unwrap()).unwrap();
            prop_assert!((from - direct).abs() <= 1e-11 * direct);
        }
        prop_assert!((stacked.target_sum_of_squares() - b.dot(&b)).abs() <= 1e-11 * b.dot(&b));
        // The same through the normal equations, group by group.
        let sums = Gram::from(&parts[0]).plus(&Gram::from(&parts[1])).unwrap();
        let x = vec![0.3; p];
        let all: Vec<usize> = (0..p).collect();
        let direct = stacked.residual_sum_of_squares(&x).unwrap();
        let from = sums.residual_sum_of_squares(&all, &x).unwrap();
        prop_assert!((from - direct).abs() <= 1e-9 * stacked.target_sum_of_squares().max(direct));
    }
}
