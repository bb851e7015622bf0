//! The estimators on one simulated arm whose parameters are known, with outliers, coloured noise and friction by a
//! power of speed.

use ::identify::base::BaseParameters;
use datasets::{PrepareOptions, Recording, Trajectory};
use model::identify::estimators::{Estimator, EstimatorOptions, Known, Lmi};
use model::identify::identification::IdentifyOptions;
use model::physics_fit::{Fit, FitOptions, fit_physics};
use ndarray::Array2;
use physics::dynamics::{Workspace, inverse_dynamics};
use physics::effects::{Sliding, Term};
use physics::robot::Robot;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

const EXPONENT: f64 = 0.6;

struct Case {
    trajectories: usize,
    /// Samples of each.
    length: usize,
    /// Correlation of neighbouring noise samples.
    rho: f64,
    /// Part of the samples that are far off.
    outliers: f64,
    /// Exponent of speed.
    exponent: f64,
    seed: u64,
}

const CALM: Case = Case {
    trajectories: 6,
    length: 600,
    rho: 0.0,
    outliers: 0.0,
    exponent: 1.0,
    seed: 1,
};

/// A UR5 on sums of sines at 50 Hz.
fn recording(case: &Case) -> Recording {
    let robot = Robot::builtin("ur5").unwrap();
    let mut rng = ChaCha8Rng::seed_from_u64(case.seed);
    let mut workspace = Workspace::new(&robot);
    let length = case.length;
    let n = case.trajectories * length;
    let time: Vec<f64> = (0..n).map(|k| 0.02 * k as f64).collect();
    let (mut q, mut qd, mut qdd, mut tau) = (
        Array2::zeros((n, 6)),
        Array2::zeros((n, 6)),
        Array2::zeros((n, 6)),
        Array2::zeros((n, 6)),
    );
    let mut noise = [0.0; 6];
    for trajectory in 0..case.trajectories {
        let sines: Vec<(f64, f64, f64)> = (0..24)
            .map(|i| {
                let w = rng.random_range(0.6..4.0);
                let size = rng.random_range(0.2..0.9) / w;
                (
                    if i % 4 == 0 { 1.5 * size } else { size },
                    w,
                    rng.random_range(0.0..6.3),
                )
            })
            .collect();
        for k in trajectory * length..(trajectory + 1) * length {
            for j in 0..6 {
                let offset = [0.0, -1.2, 1.0, -0.6, 0.5, 0.0][j];
                q[(k, j)] = offset;
                for &(size, w, phase) in &sines[4 * j..4 * j + 4] {
                    let (s, c) = (w * time[k] + phase).sin_cos();
                    q[(k, j)] += size * s;
                    qd[(k, j)] += size * w * c;
                    qdd[(k, j)] -= size * w * w * s;
                }
            }
            let row = |t: &Array2<f64>| t.row(k).to_vec();
            let mut torque = vec![0.0; 6];
            inverse_dynamics(
                &robot,
                &mut workspace,
                &row(&q),
                &row(&qd),
                &row(&qdd),
                &mut torque,
            );
            for j in 0..6 {
                let v: f64 = qd[(k, j)];
                let friction = v.signum() * (1.0 + 2.0 * v.abs().powf(case.exponent));
                let fresh: f64 = rng.sample(StandardNormal);
                noise[j] = case.rho * noise[j] + (1.0 - case.rho * case.rho).sqrt() * fresh;
                let off = if rng.random_bool(case.outliers) {
                    12.0
                } else {
                    0.0
                };
                tau[(k, j)] = torque[j] + friction + 0.2 * noise[j] + off;
            }
        }
    }
    let mut recording = Recording::new("made", time, q, Some(tau));
    (recording.qd, recording.qdd) = (Some(qd), Some(qdd));
    recording.trajectories = (0..case.trajectories)
        .map(|t| Trajectory {
            label: t.to_string(),
            range: t * length..(t + 1) * length,
        })
        .collect();
    recording
}

fn fit(case: &Case, estimator: EstimatorOptions) -> Fit {
    let robot = Robot::builtin("ur5").unwrap();
    let options = FitOptions {
        identify: IdentifyOptions {
            select: false,
            estimator,
            ..IdentifyOptions::default()
        },
        prepare: PrepareOptions {
            cutoff_hz: Some(12.0),
            ..PrepareOptions::default()
        },
        seed: 0,
    };
    fit_physics(&robot, &[recording(case)], None, &options).unwrap()
}

fn of(estimator: Estimator) -> EstimatorOptions {
    EstimatorOptions {
        estimator,
        ..EstimatorOptions::default()
    }
}

/// Distances of base parameters from the truth, in deviations.
fn off(fit: &Fit) -> Vec<f64> {
    let robot = Robot::builtin("ur5").unwrap();
    let truth = BaseParameters::of_robot(&robot, &[]).base_from(&robot.parameters());
    let found = &fit.identified.estimate;
    (0..truth.len())
        .map(|i| (found.parameters[i] - truth[i]) / found.std[i])
        .collect()
}

fn size(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt()
}

#[test]
fn every_estimator_finds_the_parameters_in_plain_noise() {
    for estimator in [
        Estimator::Ols,
        Estimator::Wls,
        Estimator::Irls,
        Estimator::Iterative,
    ] {
        let fit = fit(&CALM, of(estimator));
        let off = off(&fit);
        assert!(
            off.iter().all(|o| o.abs() < 3.5),
            "{estimator:?}: {off:.1?}"
        );
        for std in &fit.identified.residual_std {
            assert!((0.15..0.25).contains(std), "{estimator:?}: {std}");
        }
    }
}

#[test]
fn deviations_cover_coloured_noise_even_in_one_trajectory() {
    let mut all = Vec::new();
    for seed in 1..=6 {
        let case = Case {
            trajectories: 2,
            rho: 0.97,
            seed,
            ..CALM
        };
        all.extend(off(&fit(&case, EstimatorOptions::default())));
    }
    let within = all.iter().filter(|o| o.abs() < 3.0).count() as f64 / all.len() as f64;
    assert!(within > 0.985, "{within}");
    assert!(
        size(&all) > 0.4,
        "not by deviations without meaning: {}",
        size(&all)
    );
}

#[test]
fn outliers_are_left_out() {
    let case = Case {
        outliers: 0.03,
        ..CALM
    };
    let plain = fit(&case, of(Estimator::Wls));
    let robust = fit(&case, of(Estimator::Irls));
    // The offset shows it: 3 % of 12 N·m.
    let offset = |fit: &Fit| {
        let first = fit.identified.term_offsets()[2];
        let k = fit.identified.terms[2]
            .iter()
            .position(|t| *t == Term::Offset)
            .unwrap();
        fit.identified.estimate.parameters[first + k]
    };
    assert!(offset(&plain) > 0.2, "{}", offset(&plain));
    assert!(offset(&robust).abs() < 0.1, "{}", offset(&robust));
    let report = &robust.file.diagnostics.as_ref().unwrap().estimator;
    assert!(
        report.left_out.iter().all(|s| (0.02..0.05).contains(s)),
        "{report:?}"
    );
    assert!(report.converged);
}

#[test]
fn the_exponent_of_friction_is_found_and_predicts() {
    let case = Case {
        exponent: EXPONENT,
        ..CALM
    };
    let fit = fit(&case, of(Estimator::Iterative));
    let report = &fit.file.diagnostics.as_ref().unwrap().estimator;
    for found in &report.exponents {
        let found = found.expect("estimated");
        assert!((found - EXPONENT).abs() < 0.1, "{found}");
    }
    // The model that is written has the power of speed.
    for list in &fit.file.physics.terms {
        assert!(
            list.iter()
                .any(|w| matches!(w.term, Term::Sliding(Sliding::Power { .. })))
        );
    }
    let rows = fit.rows(0, &recording(&case)).unwrap();
    let physics = rows.iter().find(|r| r.name == "physics").unwrap();
    assert!(
        physics.scores.rmse.iter().all(|e| e.unwrap() < 0.25),
        "{physics:?}"
    );
}

#[test]
fn possible_links_on_demand() {
    // So short that the free estimate is impossible.
    let case = Case {
        trajectories: 1,
        ..CALM
    };
    let free = fit(&case, EstimatorOptions::default());
    assert!(free.identified.feasible.is_none());
    for (estimator, lmi) in [
        (Estimator::Wls, Lmi::Last),
        (Estimator::Wls, Lmi::Every),
        (Estimator::Iterative, Lmi::Last),
    ] {
        let made = fit(
            &case,
            EstimatorOptions {
                lmi,
                ..of(estimator)
            },
        );
        let d = made.file.diagnostics.as_ref().unwrap();
        assert_eq!(d.links.len(), 6);
        for link in &d.links {
            assert!(
                link.eigenvalues.iter().all(|v| *v > 0.0),
                "{estimator:?} {lmi:?} {link:?}"
            );
        }
        // The identified URDF is the rigid part of the model.
        let urdf = model::urdf::identified(&made).expect("possible links");
        let robot = Robot::from_urdf_str(&urdf).unwrap();
        let model = made.file.physics.nominal().unwrap();
        let rigid = model.with_parameters(&made.file.physics.rigid).unwrap();
        let (q, qd, qdd) = ([0.3, -1.0, 0.8, 2.0, -0.4, 1.0], [0.5; 6], [-1.0; 6]);
        let torque = |robot: &Robot| {
            let mut tau = [0.0; 6];
            inverse_dynamics(robot, &mut Workspace::new(robot), &q, &qd, &qdd, &mut tau);
            tau
        };
        for (a, b) in std::iter::zip(torque(&robot), torque(&rigid)) {
            assert!((a - b).abs() < 1e-8, "{a} {b}");
        }
        // The estimate itself is of these links, and torque is as well predicted.
        let feasible = made.identified.feasible.as_ref().unwrap();
        assert_eq!(made.identified.estimate.parameters, feasible.base);
        let worse = std::iter::zip(&made.identified.residual_std, &free.identified.residual_std);
        assert!(
            worse.into_iter().all(|(a, b)| a < &(1.2 * b)),
            "{estimator:?} {lmi:?}"
        );
    }
}

#[test]
fn a_prior_carries_short_data() {
    let case = Case {
        trajectories: 1,
        length: 150,
        rho: 0.97,
        ..CALM
    };
    let robot = Robot::builtin("ur5").unwrap();
    let truth = BaseParameters::of_robot(&robot, &[]).base_from(&robot.parameters());
    let error = |fit: &Fit| {
        let found = &fit.identified.estimate.parameters;
        truth
            .iter()
            .zip(found)
            .map(|(t, x)| (t - x).powi(2))
            .sum::<f64>()
    };
    let free = fit(&case, EstimatorOptions::default());
    let known = Known::nominal(&robot);
    let held = |ridge| EstimatorOptions {
        prior: Some(known.clone()),
        ridge,
        ..EstimatorOptions::default()
    };
    let near = fit(&case, held(None));
    assert!(
        error(&near) < 0.3 * error(&free),
        "{} {}",
        error(&near),
        error(&free)
    );
    // Pulled hard enough, the prior is what comes out; by another estimator as well.
    for estimator in [Estimator::Wls, Estimator::Irls] {
        let stiff = fit(
            &case,
            EstimatorOptions {
                estimator,
                ..held(Some(1e3))
            },
        );
        assert!(error(&stiff) < 1e-3 * error(&free), "{estimator:?}");
    }
    // An older model of the same robot serves as well, one of another robot is refused.
    let older = near.file.known(&robot).unwrap();
    let again = fit(
        &case,
        EstimatorOptions {
            prior: Some(older),
            ..EstimatorOptions::default()
        },
    );
    assert!(error(&again) < 0.3 * error(&free));
    assert!(near.file.known(&Robot::builtin("kr300").unwrap()).is_err());
}
