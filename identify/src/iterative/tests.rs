use super::*;
use crate::base::{BaseParameters, Extra};
use crate::feasible::{Constraints, Nominal};
use ndarray::Array1;
use physics::dynamics::{Workspace, regressor};
use physics::robot::Robot;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

const EXTRAS: [Extra; 4] = [
    Extra::RotorInertia,
    Extra::Viscous,
    Extra::Coulomb,
    Extra::Offset,
];

/// A UR5 with known friction, moving through random states.
struct Synthetic {
    robot: Robot,
    base: BaseParameters,
    regressor: Array2<f64>,
    torque: Array1<f64>,
    velocity: Array2<f64>,
    /// Base parameters behind the torque.
    truth: Vec<f64>,
    /// Standard parameters and extras behind the torque.
    standard: Vec<f64>,
}

impl Synthetic {
    /// Friction grows with |q̇|^alpha; noise is correlated between joints 1 and 2.
    fn new(samples: usize, alpha: f64, noise: f64, seed: u64) -> Self {
        let robot = Robot::builtin("ur5").unwrap();
        let n = robot.dof();
        let base = BaseParameters::of_robot(&robot, &EXTRAS);
        let mut standard = robot.parameters();
        for value in [0.3, 8.0, 5.0, 0.2] {
            standard.extend((0..n).map(|j| value / (1.0 + j as f64)));
        }
        let truth = base.base_from(&standard);
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut state =
            |range: f64| -> Vec<f64> { (0..n).map(|_| rng.random_range(-range..range)).collect() };
        let width = base.names().len();
        let mut rows = Array2::zeros((samples * n, base.len()));
        let mut velocity = Array2::zeros((samples, n));
        let mut workspace = Workspace::new(&robot);
        let mut y = vec![0.0; n * 10 * n];
        let mut full = vec![0.0; width];
        let mut states = Vec::new();
        for _ in 0..samples {
            states.push((state(3.0), state(2.0), state(6.0)));
        }
        for (k, (q, qd, qdd)) in states.iter().enumerate() {
            regressor(&robot, &mut workspace, q, qd, qdd, &mut y);
            for joint in 0..n {
                full.fill(0.0);
                full[..10 * n].copy_from_slice(&y[joint * 10 * n..][..10 * n]);
                for (e, extra) in EXTRAS.iter().enumerate() {
                    full[10 * n + e * n + joint] = extra.value(qd[joint], qdd[joint]);
                }
                let v = qd[joint];
                full[10 * n + n + joint] = v.signum() * v.abs().powf(alpha);
                for (j, &column) in base.independent().iter().enumerate() {
                    rows[(k * n + joint, j)] = full[column];
                }
                velocity[(k, joint)] = v;
            }
        }
        let mut torque = rows.dot(&Array1::from(truth.clone()));
        for k in 0..samples {
            let mut e: Vec<f64> = (0..n).map(|_| rng.sample(StandardNormal)).collect();
            e[1] = 0.6 * e[0] + 0.8 * e[1];
            for (joint, e) in e.iter().enumerate() {
                torque[k * n + joint] += noise * (n - joint) as f64 * e;
            }
        }
        Self {
            robot,
            base,
            regressor: rows,
            torque,
            velocity,
            truth,
            standard,
        }
    }

    fn problem(&self) -> Problem {
        Problem::new(self.regressor.view(), self.torque.view(), self.robot.dof()).unwrap()
    }

    fn column(&self, name: &str) -> usize {
        self.base
            .base_names()
            .iter()
            .position(|n| n == name)
            .unwrap()
    }

    fn feasibility(&self) -> Feasibility {
        let n = self.robot.dof();
        let extras: Vec<(f64, f64)> = [(0.2, 1.0), (5.0, 10.0), (5.0, 10.0), (0.0, 5.0)]
            .iter()
            .flat_map(|&e| vec![e; n])
            .collect();
        let nominal = Nominal::of_robot(&self.robot, &extras);
        let constraints = Constraints::new(n, 10 * n..10 * n + 3 * n);
        Feasibility::new(self.base.grouping(), constraints, nominal).unwrap()
    }
}

/// Most deviations of an estimate from the truth, in its own standard deviations.
fn worst(estimate: &Estimate, truth: &[f64]) -> f64 {
    (0..truth.len())
        .map(|j| (estimate.parameters[j] - truth[j]).abs() / estimate.std[j])
        .fold(0.0, f64::max)
}

#[test]
fn truth_lies_within_the_deviations_stated() {
    let s = Synthetic::new(600, 1.0, 0.05, 1);
    // 36 rigid, rotor inertia of joints 3 to 6 on its own, friction and offset.
    assert_eq!(s.truth.len(), 36 + 4 + 18);
    // Deviations of Noise::Equal would not hold: the joints' noise differs sixfold.
    for noise in [Noise::PerJoint, Noise::Full] {
        let options = IterativeOptions {
            noise,
            weight: Weight::Equal,
            ..IterativeOptions::default()
        };
        let found = identify(&mut s.problem(), &options).unwrap();
        assert!(found.converged);
        // 58 parameters: 3.7σ is passed by one of them with probability 1.3 %.
        let worst = worst(&found.estimate, &s.truth);
        assert!(worst < 3.7, "{noise:?}: {worst}");
        assert!((found.estimate.sigma2 - 1.0).abs() < 0.02);
    }
}

/// A joint that stands the whole time has no row that counts; the others are identified all the same.
#[test]
fn a_joint_without_rows_takes_no_other_with_it() {
    let s = Synthetic::new(600, 1.0, 0.05, 3);
    for noise in [Noise::Equal, Noise::PerJoint, Noise::Full] {
        let mut problem = s.problem();
        (0..problem.samples()).for_each(|sample| problem.leave_out(sample, 4));
        let options = IterativeOptions {
            noise,
            ..IterativeOptions::default()
        };
        let found = identify(&mut problem, &options).unwrap();
        assert_eq!(found.weights.column(4).sum(), 0.0);
        for name in ["fv1", "fc3", "f06"] {
            let column = s.column(name);
            let error = (found.estimate.parameters[column] - s.truth[column]).abs();
            assert!(error < 0.1, "{noise:?}, {name}: {error}");
        }
    }
}

#[test]
fn full_covariance_finds_the_correlation_and_shrinks_the_deviations() {
    let s = Synthetic::new(2000, 1.0, 0.05, 2);
    let options = |noise| IterativeOptions {
        noise,
        weight: Weight::Equal,
        ..IterativeOptions::default()
    };
    let full = identify(&mut s.problem(), &options(Noise::Full)).unwrap();
    let omega = &full.noise;
    let correlation = omega[(0, 1)] / (omega[(0, 0)] * omega[(1, 1)]).sqrt();
    assert!((correlation - 0.6).abs() < 0.06, "{correlation}");
    for joint in 0..6 {
        let expected = 0.05 * (6 - joint) as f64;
        assert!((omega[(joint, joint)].sqrt() / expected - 1.0).abs() < 0.06);
    }
    let equal = identify(&mut s.problem(), &options(Noise::Equal)).unwrap();
    let inertia = s.column("Ixx6");
    assert!(full.estimate.std[inertia] < 0.6 * equal.estimate.std[inertia]);
}

#[test]
fn outliers_are_left_out() {
    let mut s = Synthetic::new(1500, 1.0, 0.05, 3);
    // Every 20th sample of joint 2 is off by a hundred deviations, always to the same side.
    for k in (0..1500).step_by(20) {
        s.torque[k * 6 + 1] += 25.0;
    }
    let options = |weight| IterativeOptions {
        noise: Noise::Full,
        weight,
        ..IterativeOptions::default()
    };
    let plain = identify(&mut s.problem(), &options(Weight::Equal)).unwrap();
    let offset = s.column("f02");
    assert!((plain.estimate.parameters[offset] - s.truth[offset]).abs() > 0.5);
    for weight in [
        Weight::Hard { threshold: 3.0 },
        Weight::Tukey { threshold: 4.685 },
    ] {
        let found = identify(&mut s.problem(), &options(weight)).unwrap();
        let worst = worst(&found.estimate, &s.truth);
        assert!(worst < 4.5, "{weight:?}: {worst}");
        assert!((0..1500).step_by(20).all(|k| found.weights[(k, 1)] == 0.0));
        let deviation = found.noise[(1, 1)].sqrt();
        assert!(
            (deviation / 0.25 - 1.0).abs() < 0.08,
            "{weight:?}: {deviation}"
        );
    }
    let huber = options(Weight::Huber { threshold: 1.345 });
    let found = identify(&mut s.problem(), &huber).unwrap();
    // Huber bounds the pull of an outlier without ending it.
    let off = |found: &Identification| (found.estimate.parameters[offset] - s.truth[offset]).abs();
    assert!(off(&found) < 0.25 * off(&plain));
}

#[test]
fn friction_exponent_is_recovered() {
    let s = Synthetic::new(2000, 0.6, 0.02, 4);
    let columns = (1..=6).map(|j| Some(s.column(&format!("fv{j}")))).collect();
    let options = IterativeOptions {
        power_law: Some(PowerLaw::new(columns, s.velocity.clone())),
        ..IterativeOptions::default()
    };
    let found = identify(&mut s.problem(), &options).unwrap();
    assert!(found.converged);
    for (joint, alpha) in found.exponents.iter().enumerate() {
        assert!((alpha - 0.6).abs() < 0.02, "joint {joint}: {alpha}");
    }
    let linear = identify(
        &mut s.problem(),
        &IterativeOptions {
            power_law: Some(PowerLaw {
                range: (1.0, 1.0),
                ..options.power_law.clone().unwrap()
            }),
            ..IterativeOptions::default()
        },
    )
    .unwrap();
    assert!(linear.noise[(0, 0)] > 2.0 * found.noise[(0, 0)]);
}

#[test]
fn feasible_estimates_are_possible_robots() {
    // Little data, much noise: the free estimate is impossible.
    let s = Synthetic::new(60, 1.0, 1.0, 5);
    let feasibility = s.feasibility();
    let options = |physical| IterativeOptions {
        noise: Noise::PerJoint,
        weight: Weight::Equal,
        physical,
        ..IterativeOptions::default()
    };
    let mut errors = Vec::new();
    for physical in [
        Physical::LastStep(&feasibility),
        Physical::EveryStep(&feasibility),
    ] {
        let found = identify(&mut s.problem(), &options(physical)).unwrap();
        let feasible = found.feasible.as_ref().unwrap();
        assert!(feasible.smallest_eigenvalue > 0.0);
        assert!(feasibility.constraints().hold(&feasible.standard));
        let cost = |x: &[f64]| found.triangle.residual_sum_of_squares(x).unwrap();
        assert!(cost(&feasible.base) > cost(&found.estimate.parameters));
        let again = s.base.base_from(&feasible.standard);
        for (a, b) in std::iter::zip(again, &feasible.base) {
            assert!((a - b).abs() < 1e-9 * (1.0 + b.abs()));
        }
        let off = |x: &[f64]| -> f64 {
            std::iter::zip(x, &s.truth)
                .map(|(a, b)| (a - b).powi(2))
                .sum()
        };
        errors.push(off(&feasible.base) / off(&found.estimate.parameters));
    }
    // What is impossible is also wrong: the constraint brings the estimate nearer to the truth.
    assert!(errors.iter().all(|e| *e < 0.7), "{errors:?}");
    assert_eq!(s.standard.len(), 84);
}

#[test]
fn bad_input_is_refused() {
    let rows = Array2::<f64>::ones((7, 2));
    let torque = Array1::<f64>::ones(7);
    assert!(Problem::new(rows.view(), torque.view(), 2).is_err());
    let mut torque = Array1::<f64>::ones(6);
    torque[3] = f64::INFINITY;
    let rows = Array2::<f64>::ones((6, 2));
    assert_eq!(
        Problem::new(rows.view(), torque.view(), 2).unwrap_err(),
        LeastSquaresError::NotFinite
    );
    let mut problem = Problem::new(rows.view(), Array1::ones(6).view(), 2).unwrap();
    let options = IterativeOptions {
        power_law: Some(PowerLaw::new(vec![Some(5), None], Array2::zeros((3, 2)))),
        ..IterativeOptions::default()
    };
    assert!(identify(&mut problem, &options).is_err());
    // A torque that the columns explain exactly has no noise to weigh by.
    assert_eq!(
        identify(&mut problem, &IterativeOptions::default()).unwrap_err(),
        IterativeError::Singular
    );
}
