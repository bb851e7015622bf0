//! `train study`: the published comparisons (Tables 6–8 of the uncertainty-compensation paper) on the
//! simulated UR5.

mod arguments;
mod data;
mod results;
mod settings;
mod tables;
mod trial;
mod verification;

pub use arguments::Study;

use crate::runtime::{pool, stop, threads};
use compensator::inputs::InputSet;
use compensator::training::{Control, Fold};
use data::Data;
use feedforward::network::{Architecture, Memory, Recurrent};
use model::failure::Failure;
use results::{Nodes, Report, Variant};
use settings::Settings;
use std::sync::atomic::AtomicBool;
use trial::{Outcome, Trial};

/// Runs the study and prints it.
///
/// # Errors
/// Data that cannot be simulated or written, or the interruption.
pub fn run(study: &Study, cancel: &AtomicBool) -> Result<(), Failure> {
    let threads = threads(study.threads)?;
    pool(threads)?.install(|| steps(study, cancel, threads))
}

fn steps(study: &Study, cancel: &AtomicBool, threads: usize) -> Result<(), Failure> {
    let data = Data::simulated(study)?;
    stop(cancel, "Run the same command again.")?;
    let settings = Settings::new(study.quick, &data, study.seed)?;
    let all: Vec<usize> = (0..data.joints.len()).collect();
    let recurrent = |hidden, attention, timestep| {
        Architecture::Recurrent(Recurrent {
            encoder: hidden,
            attention,
            reencoder: hidden,
            memory: Memory::Window { timestep },
        })
    };
    let h = settings.hidden;
    let published = recurrent(h, Some(h), 3);

    let bar = crate::progress::bar(study.quiet, "training");
    let first = &settings.folds[..1];
    let nodes = settings.nodes.len();
    let planned = all.len() * (2 * settings.folds.len() + 5) + 2 * nodes;
    let done = std::sync::atomic::AtomicUsize::new(0);
    let show = |p: &compensator::training::Progress| {
        if p.finished {
            let done = 1 + done.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
            bar.set_position((100 * done / planned) as u64);
        }
    };
    let control = Control {
        threads,
        cancel: Some(cancel),
        progress: Some(&show),
        ..Control::default()
    };
    let trial = |inputs, architecture: &Architecture, joints: &[usize], folds: &[Fold]| {
        let trial = Trial {
            data: &data,
            settings: &settings,
            inputs,
            architecture: architecture.clone(),
        };
        trial.run(joints, folds, &control)
    };

    let attention = trial(InputSet::Icm, &published, &all, &settings.folds)?;
    let plain = trial(InputSet::Icm, &recurrent(h, None, 3), &all, &settings.folds)?;
    let table_6 = vec![
        Variant {
            value: "physics",
            rmse: data.physics_rmse(&settings.folds),
        },
        Variant {
            value: "attention",
            rmse: attention.iter().map(Outcome::mean).collect(),
        },
        Variant {
            value: "no_attention",
            rmse: plain.iter().map(Outcome::mean).collect(),
        },
    ];

    // Comparisons on the first fold alone share its published unit.
    let on_first: Vec<f64> = attention.iter().map(Outcome::first).collect();
    let compare = |inputs, architecture: &Architecture| -> Result<Vec<f64>, Failure> {
        let outcomes = trial(inputs, architecture, &all, first)?;
        Ok(outcomes.iter().map(Outcome::first).collect())
    };
    let inputs = vec![
        Variant {
            value: "own",
            rmse: compare(InputSet::Own, &published)?,
        },
        Variant {
            value: "all",
            rmse: compare(InputSet::All, &published)?,
        },
        Variant {
            value: "icm",
            rmse: on_first.clone(),
        },
    ];
    let mut timesteps = Vec::new();
    for timestep in [2, 3, 5, 10] {
        let rmse = if timestep == 3 {
            on_first.clone()
        } else {
            compare(InputSet::Icm, &recurrent(h, Some(h), timestep))?
        };
        timesteps.push(Variant {
            value: timestep,
            rmse,
        });
    }
    let mut nodes = Vec::new();
    for &n in &settings.nodes {
        let connected = Architecture::Perceptron {
            hidden: vec![n],
            timestep: 3,
        };
        let of_joint_1 = |architecture: &Architecture| -> Result<f64, Failure> {
            Ok(trial(InputSet::Icm, architecture, &[0], first)?[0].first())
        };
        nodes.push(Nodes {
            nodes: n,
            fully_connected: of_joint_1(&connected)?,
            lstm: of_joint_1(&recurrent(n, None, 3))?,
        });
    }
    let table_8 = verification::verify(&data, &attention)?;
    bar.finish_and_clear();

    let report = Report {
        schema: "study/1",
        seed: study.seed,
        quick: study.quick,
        joints: data.joints.clone(),
        folds: settings.folds.len(),
        hidden: h,
        epochs: settings.training.epochs,
        windows_per_epoch: settings.windows,
        table_6,
        inputs,
        timesteps,
        nodes,
        table_8,
    };
    if let Some(path) = &study.json {
        report::write_atomic(path, model::directory::json(&report))?;
    }
    if !study.quiet {
        tables::print(&report);
    }
    Ok(())
}
