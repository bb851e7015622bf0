//! Identification against the figures it must meet: tall least squares beside NumPy (peers/least_squares.py runs both
//! and prints the ratio), the iterative approach at the size of Han et al. (30,000 × 58), feasibility, and memory
//! that does not grow with the samples.
//!
//! `cargo bench -p residyn-identify --bench identification [-- least_squares|iterative|feasible|memory]`

use identify::base::{BaseParameters, Extra};
use identify::feasible::{Constraints, Feasibility, Nominal};
use identify::iterative::{IterativeOptions, Physical, PowerLaw, Problem, identify};
use identify::least_squares::{Accumulator, SolveOptions, Triangle, solve};
use ndarray::{Array1, Array2};
use physics::dynamics::{Workspace, regressor};
use physics::robot::Robot;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use std::time::{Duration, Instant};

type Failure = Box<dyn std::error::Error>;
type Part = fn() -> Result<(), Failure>;

fn main() -> Result<(), Failure> {
    let chosen: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| !a.starts_with('-'))
        .collect();
    let parts: [(&str, Part); 4] = [
        ("least_squares", tall_least_squares),
        ("iterative", iterative),
        ("feasible", feasible),
        ("memory", memory),
    ];
    for (name, run) in parts {
        if chosen.is_empty() || chosen.iter().any(|c| c == name) {
            run()?;
        }
    }
    Ok(())
}

/// Median time of five runs.
fn median<T>(mut run: impl FnMut() -> T) -> Duration {
    let mut times: Vec<Duration> = (0..5)
        .map(|_| {
            let start = Instant::now();
            std::hint::black_box(run());
            start.elapsed()
        })
        .collect();
    times.sort();
    times[2]
}

fn tall_least_squares() -> Result<(), Failure> {
    let (rows, columns) = (200_000, 60);
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let a = Array2::from_shape_simple_fn((rows, columns), || rng.sample(StandardNormal));
    let b = Array1::from_shape_simple_fn(rows, || rng.sample(StandardNormal));
    let time = median(|| {
        let triangle = Triangle::of(a.view(), b.view());
        triangle.and_then(|t| solve(&t, &SolveOptions::default()))
    });
    println!("least_squares {rows}x{columns} ms {:.1}", ms(time));
    Ok(())
}

/// 10 million rows of 60 columns, 4.9 GB if they were kept.
fn memory() -> Result<(), Failure> {
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    let mut rows = Accumulator::new(60);
    let mut row = [0.0; 60];
    let start = Instant::now();
    for _ in 0..10_000_000 {
        row.fill_with(|| rng.random_range(-1.0..1.0));
        rows.push(&row, row[0] - row[59], 1.0)?;
    }
    let estimate = solve(&rows.finish()?, &SolveOptions::default())?;
    let peak = std::fs::read_to_string("/proc/self/status").ok();
    let peak = peak
        .as_deref()
        .and_then(|s| s.lines().find(|l| l.starts_with("VmHWM")));
    println!(
        "memory 10000000x60 s {:.1} first parameter {:.6} {}",
        start.elapsed().as_secs_f64(),
        estimate.parameters[0],
        peak.unwrap_or("peak memory unknown on this system"),
    );
    Ok(())
}

/// A UR5 in random states with friction |q̇|^0.7, correlated noise and 3 % outliers: rows, torque, velocities.
struct Case {
    robot: Robot,
    base: BaseParameters,
    rows: Array2<f64>,
    torque: Array1<f64>,
    velocity: Array2<f64>,
}

impl Case {
    fn new(samples: usize) -> Result<Self, Failure> {
        let extras = [
            Extra::RotorInertia,
            Extra::Viscous,
            Extra::Coulomb,
            Extra::Offset,
        ];
        let robot = Robot::builtin("ur5").ok_or("no built-in ur5")?;
        let (n, base) = (robot.dof(), BaseParameters::of_robot(&robot, &extras));
        let mut standard = robot.parameters();
        for value in [0.3, 8.0, 5.0, 0.2] {
            standard.extend((0..n).map(|j| value / (1.0 + j as f64)));
        }
        let truth = Array1::from(base.base_from(&standard));
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let mut rows = Array2::zeros((samples * n, base.len()));
        let mut torque = Array1::zeros(samples * n);
        let mut velocity = Array2::zeros((samples, n));
        let mut workspace = Workspace::new(&robot);
        let mut y = vec![0.0; 10 * n * n];
        let mut full = vec![0.0; standard.len()];
        for k in 0..samples {
            let mut draw = |range: f64| -> Vec<f64> {
                (0..n).map(|_| rng.random_range(-range..range)).collect()
            };
            let (q, qd, qdd) = (draw(3.0), draw(2.0), draw(6.0));
            regressor(&robot, &mut workspace, &q, &qd, &qdd, &mut y);
            let common: f64 = rng.sample(StandardNormal);
            for joint in 0..n {
                full.fill(0.0);
                full[..10 * n].copy_from_slice(&y[joint * 10 * n..][..10 * n]);
                for (e, extra) in extras.iter().enumerate() {
                    full[10 * n + e * n + joint] = extra.value(qd[joint], qdd[joint]);
                }
                full[11 * n + joint] = qd[joint].signum() * qd[joint].abs().powf(0.7);
                let row = k * n + joint;
                for (j, &column) in base.independent().iter().enumerate() {
                    rows[(row, j)] = full[column];
                }
                let own: f64 = rng.sample(StandardNormal);
                let size = 0.1 * (n - joint) as f64;
                torque[row] = rows.row(row).dot(&truth) + size * (0.5 * common + own);
                if rng.random_bool(0.03) {
                    torque[row] += 20.0 * size;
                }
                velocity[(k, joint)] = qd[joint];
            }
        }
        Ok(Self {
            robot,
            base,
            rows,
            torque,
            velocity,
        })
    }

    fn feasibility(&self) -> Result<Feasibility, Failure> {
        let n = self.robot.dof();
        let extras: Vec<(f64, f64)> = [(0.2, 1.0), (5.0, 10.0), (5.0, 10.0), (0.0, 5.0)]
            .iter()
            .flat_map(|&e| vec![e; n])
            .collect();
        let nominal = Nominal::of_robot(&self.robot, &extras);
        let constraints = Constraints::new(n, 10 * n..13 * n);
        Ok(Feasibility::new(
            self.base.grouping(),
            constraints,
            nominal,
        )?)
    }
}

fn iterative() -> Result<(), Failure> {
    let case = Case::new(5000)?;
    let feasibility = case.feasibility()?;
    let names = case.base.base_names();
    let columns: Vec<Option<usize>> = (1..=case.robot.dof())
        .map(|j| names.iter().position(|n| *n == format!("fv{j}")))
        .collect();
    for (name, physical) in [
        ("free", Physical::Free),
        ("lmi_last_step", Physical::LastStep(&feasibility)),
        ("lmi_every_step", Physical::EveryStep(&feasibility)),
    ] {
        let mut problem = Problem::new(case.rows.view(), case.torque.view(), case.robot.dof())?;
        let options = IterativeOptions {
            power_law: Some(PowerLaw::new(columns.clone(), case.velocity.clone())),
            physical,
            ..IterativeOptions::default()
        };
        let start = Instant::now();
        let found = identify(&mut problem, &options)?;
        println!(
            "iterative {}x{} {name} s {:.2} solutions {} converged {} exponents {:.3?}",
            case.rows.nrows(),
            case.rows.ncols(),
            start.elapsed().as_secs_f64(),
            found.solutions,
            found.converged,
            found.exponents,
        );
    }
    Ok(())
}

fn feasible() -> Result<(), Failure> {
    let case = Case::new(500)?;
    let feasibility = case.feasibility()?;
    let triangle = Triangle::of(case.rows.view(), case.torque.view())?;
    let free = solve(&triangle, &SolveOptions::default())?;
    let fit = feasibility.fit(&triangle, free.sigma2)?;
    let time = median(|| feasibility.fit(&triangle, free.sigma2));
    println!(
        "feasible fit ms {:.2} steps {} {:?}",
        ms(time),
        fit.steps,
        fit.status
    );
    let urdf = feasibility.standard_from(&fit.base)?;
    let time = median(|| feasibility.standard_from(&fit.base));
    println!(
        "feasible standard_from ms {:.2} steps {} {:?}",
        ms(time),
        urdf.steps,
        urdf.status
    );
    Ok(())
}

fn ms(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}
