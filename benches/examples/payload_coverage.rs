//! Do the deviations of `payload` hold? Bodies of known mass on a simulated arm, each with a model of its own.
//!
//! `cargo run --release -p residyn-benches --example payload_coverage -- --draws 40 --arm ur5|seven` simulates an arm without and with
//! a random body, identifies the first recording as `train --physics-only` does, estimates the body from the second, and
//! prints by figure the mean error in deviations, its spread, and how many of the figures lie within two and three deviations.
//! `--gains` does the same of the gains of drives whose torque constants are wrong, with the body as a known one.

use clap::Parser;
use model::directory::ModelFile;
use model::identify::identification::IdentifyOptions;
use model::payload::gains::{self, GainOptions, KnownBody};
use model::payload::{Figure, PayloadOptions, estimate};
use model::physics_fit::{FitOptions, fit_physics};
use rayon::prelude::*;
use trials::protocols::payload::{Loaded, LoadedArm, loaded};

/// Coverage of the payload's deviations on a simulated arm.
#[derive(Parser)]
struct Arguments {
    /// Number of bodies.
    #[arg(long, default_value_t = 40)]
    draws: u64,
    /// Which arm.
    #[arg(long, default_value = "ur5", value_parser = ["ur5", "seven"])]
    arm: String,
    /// Seed of the first body.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// The arm without anything that a rigid model with viscous and Coulomb friction lacks.
    #[arg(long)]
    plain: bool,
    /// The stored model has viscous and Coulomb friction alone, as train --basic.
    #[arg(long)]
    basic: bool,
    /// The gains of drives with wrong torque constants, from the body as one that is known, instead of the body.
    #[arg(long)]
    gains: bool,
    /// A line for every body.
    #[arg(long)]
    each: bool,
}

const NAMES: [&str; 10] = [
    "mass", "com x", "com y", "com z", "Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz",
];

/// Estimate and truth of each figure of one body.
fn one(arm: LoadedArm, arguments: &Arguments, seed: u64) -> Vec<(Option<Figure>, f64)> {
    let mut made = loaded(arm, arguments.plain, seed).expect("the arm is possible");
    if arguments.gains {
        made = made.with_wrong_drives(seed);
    }
    let options = FitOptions {
        identify: IdentifyOptions {
            select: !arguments.basic,
            ..IdentifyOptions::default()
        },
        ..FitOptions::default()
    };
    let fit = fit_physics(
        &made.robot,
        std::slice::from_ref(&made.without),
        None,
        &options,
    )
    .expect("the recording can be fitted");
    if arguments.gains {
        return drives(&fit.file, &made);
    }
    let found = estimate(&fit.file, &made.with, &PayloadOptions::default())
        .expect("the body can be estimated");
    let (about, com) = (made.body.about_com(), made.body.com());
    let truth = [made.body.mass]
        .into_iter()
        .chain([com.x, com.y, com.z])
        .chain([
            about.m11, about.m12, about.m22, about.m13, about.m23, about.m33,
        ]);
    let body = &found.body;
    let figures = [body.mass].into_iter().chain(body.com).chain(body.inertia);
    figures.zip(truth).collect()
}

/// Estimate and truth of the gain of each joint's drive.
fn drives(file: &ModelFile, made: &Loaded) -> Vec<(Option<Figure>, f64)> {
    let (about, com) = (made.body.about_com(), made.body.com());
    let inertia = [
        about.m11, about.m12, about.m22, about.m13, about.m23, about.m33,
    ];
    let known = KnownBody::new(made.body.mass, Some(com.into()), Some(inertia))
        .expect("the body is a possible one");
    let found = gains::estimate(
        file,
        &made.without,
        &made.with,
        &known,
        &GainOptions::default(),
    )
    .expect("some gain is told");
    std::iter::zip(found.gain, made.gains.iter().copied()).collect()
}

fn main() {
    let arguments = Arguments::parse();
    let arm = match arguments.arm.as_str() {
        "seven" => LoadedArm::Seven,
        _ => LoadedArm::Ur5,
    };
    let seeds = arguments.seed..arguments.seed + arguments.draws;
    let all: Vec<Vec<(Option<Figure>, f64)>> = seeds
        .into_par_iter()
        .map(|seed| one(arm, &arguments, seed))
        .collect();
    if arguments.each && !arguments.gains {
        for figures in &all {
            if let (Some(mass), truth) = &figures[0] {
                println!(
                    "mass {:.3} ± {:.3} of {truth:.3} kg: {:+.2} deviations",
                    mass.value,
                    mass.std,
                    (mass.value - truth) / mass.std
                );
            }
        }
    }
    println!(
        "{} bodies on {}\n{:<6} {:>5} {:>9} {:>9} {:>10} {:>7} {:>7}",
        all.len(),
        arm.name(),
        "",
        "told",
        "mean dev.",
        "RMS dev.",
        "RMS error",
        "in 2σ",
        "in 3σ"
    );
    let names: Vec<String> = match arguments.gains {
        true => (1..=all[0].len()).map(|j| format!("gain {j}")).collect(),
        false => NAMES.map(str::to_owned).to_vec(),
    };
    for (k, name) in names.iter().enumerate() {
        let told: Vec<(f64, f64)> = all
            .iter()
            .filter_map(|figures| {
                let (figure, truth) = &figures[k];
                figure.map(|f| (f.value - truth, (f.value - truth) / f.std))
            })
            .collect();
        let count = told.len().max(1) as f64;
        let mean = told.iter().map(|t| t.1).sum::<f64>() / count;
        let rms = (told.iter().map(|t| t.1 * t.1).sum::<f64>() / count).sqrt();
        let error = (told.iter().map(|t| t.0 * t.0).sum::<f64>() / count).sqrt();
        let within = |k: f64| told.iter().filter(|t| t.1.abs() < k).count() as f64 / count;
        println!(
            "{name:<6} {:>5} {mean:>9.2} {rms:>9.2} {error:>10.2e} {:>6.0}% {:>6.0}%",
            told.len(),
            100.0 * within(2.0),
            100.0 * within(3.0)
        );
    }
}
