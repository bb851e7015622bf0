//! The iterative paper's comparisons at its size, on its simulated robot: medians over seeds.
//!
//! `cargo run --release --workspace --example iterative_study -- [--seeds 10]` simulates the Foxbot A05's protocol for each seed (seven
//! trajectories to identify from, three to judge by), identifies 58 parameters from its 31,500 rows by every estimator without further
//! friction terms, and prints the error on the three trajectories, whether all loops ended by their tolerance and after how many
//! solutions, and how far the exponents of friction are off.

use clap::Parser;
use datasets::metrics::Row;
use model::identify::estimators::{Estimator, EstimatorOptions, Lmi};
use model::identify::identification::IdentifyOptions;
use model::physics_fit::{FitOptions, fit_physics};
use physics::robot::Robot;
use rayon::prelude::*;
use trials::Protocol;

/// The iterative paper's comparisons, medians over seeds.
#[derive(Parser)]
struct Arguments {
    /// Number of seeds, from 1.
    #[arg(long, default_value_t = 10)]
    seeds: u64,
}

/// What is compared.
const VARIANTS: [(&str, Estimator, Lmi); 4] = [
    ("linear friction, weighted", Estimator::Wls, Lmi::Off),
    (
        "linear friction, without outliers",
        Estimator::Irls,
        Lmi::Off,
    ),
    ("three loops, free", Estimator::Iterative, Lmi::Off),
    (
        "three loops, possible links",
        Estimator::Iterative,
        Lmi::Last,
    ),
];

/// One estimate.
struct Made {
    /// Mean NRMSE of the joints on the three trajectories.
    error: f64,
    /// Columns of the weighted regressor, and rows it had.
    size: [usize; 2],
    converged: bool,
    solutions: usize,
    /// Largest error of an exponent, none where friction is linear.
    exponent: Option<f64>,
}

fn one(seed: u64, estimator: Estimator, lmi: Lmi) -> Made {
    let robot = Robot::builtin("foxbot_a05").expect("built in");
    let simulated = Protocol::FoxbotA05
        .simulate(seed, &|_| {})
        .expect("the robot is possible");
    let part = |name| simulated.part(name).expect("a part of the protocol");
    let (training, heldout) = (part("identification"), part("validation"));
    let options = FitOptions {
        identify: IdentifyOptions {
            select: false,
            estimator: EstimatorOptions {
                estimator,
                lmi,
                ..EstimatorOptions::default()
            },
            ..IdentifyOptions::default()
        },
        ..FitOptions::default()
    };
    let data = std::slice::from_ref(training);
    let fit = fit_physics(&robot, data, Some(heldout), &options).expect("it can be fitted");
    let tau = heldout.tau.as_ref().expect("simulated with torque");
    let qd = &fit.session.parts[1].at_samples.qd;
    let rows = Row::both_scopes("physics", tau, &fit.physics[1], qd).expect("one shape");
    let errors: Vec<f64> = rows[0].scores.nrmse.iter().flatten().copied().collect();
    let report = &fit.file.diagnostics.as_ref().expect("fitted").estimator;
    let truth = simulated.truth["alpha"].as_array().expect("six exponents");
    let off = report.exponents.iter().zip(truth);
    Made {
        error: errors.iter().sum::<f64>() / errors.len() as f64,
        size: [
            fit.file.covariance_table().nrows(),
            training.len() * robot.dof() / report.every,
        ],
        converged: report.converged,
        solutions: report.solutions,
        exponent: off
            .filter_map(|(found, truth)| Some((found.as_ref()? - truth.as_f64()?).abs()))
            .reduce(f64::max),
    }
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    signal::quantile::median(values.collect()).unwrap_or(f64::NAN)
}

fn main() {
    let arguments = Arguments::parse();
    println!(
        "{:<36} {:>9} {:>11} {:>11} {:>10} {:>10}",
        "", "NRMSE / %", "rows", "parameters", "converged", "solutions"
    );
    let mut free = f64::NAN;
    for (name, estimator, lmi) in VARIANTS {
        let made: Vec<Made> = (1..=arguments.seeds)
            .into_par_iter()
            .map(|seed| one(seed, estimator, lmi))
            .collect();
        let error = median(made.iter().map(|m| m.error));
        let [columns, rows] = made[0].size;
        println!(
            "{name:<36} {:>9.3} {rows:>11} {columns:>11} {:>10} {:>10.0}",
            100.0 * error,
            format!(
                "{} of {}",
                made.iter().filter(|m| m.converged).count(),
                made.len()
            ),
            median(made.iter().map(|m| m.solutions as f64)),
        );
        if made.iter().any(|m| m.exponent.is_some()) {
            let worst = median(made.iter().filter_map(|m| m.exponent));
            println!("    worst exponent of the six off by {worst:.3} (median over the seeds)");
        }
        if lmi == Lmi::Off {
            free = error;
        } else {
            println!("    error over the free estimate's: {:.4}", error / free);
        }
    }
}
