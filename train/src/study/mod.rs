//! `train study`: the published comparisons (Tables 6–8 of the uncertainty-compensation paper) on the
//! simulated UR5.

mod arguments;
mod attainable;
mod comparisons;
mod data;
mod results;
mod settings;
mod tables;
mod trial;
mod verification;

pub use arguments::Study;

use crate::runtime::{pool, stop};
use comparisons::Comparisons;
use compensator::training::Control;
use data::Data;
use indicatif::ProgressBar;
use model::failure::Failure;
use results::{Report, Variant};
use settings::{GO_ON, SPAN, Settings};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use trial::Outcome;

/// Runs the study and prints it.
///
/// # Errors
/// Data that cannot be simulated or written, or the interruption.
pub fn run(study: &Study, cancel: &AtomicBool) -> Result<(), Failure> {
    let threads = study.running.threads();
    pool(&study.running)?.install(|| steps(study, cancel, threads))
}

fn steps(study: &Study, cancel: &AtomicBool, threads: usize) -> Result<(), Failure> {
    let data = Data::simulated(study, None)?;
    stop(cancel, GO_ON)?;
    let settings = Settings::new(study.quick, &data, study.seed)?;
    let kind = if study.quick { "quick-" } else { "" };
    let kept = study.checkpoints.join(format!("{kind}{}", study.seed));
    let bar = crate::progress::bar(study.running.quiet, "training");
    let finished = AtomicUsize::new(0);
    let show = |p: &compensator::training::Progress| {
        if p.finished {
            let finished = 1 + finished.fetch_add(1, Ordering::Relaxed);
            bar.set_position((100 * finished / Comparisons::networks(&settings, &data)) as u64);
        }
    };
    let compare = Comparisons {
        data: &data,
        settings: &settings,
        kept: &kept,
        control: Control {
            threads,
            cancel: Some(cancel),
            progress: Some(&show),
            ..Control::default()
        },
    };
    // Every table is printed as soon as it stands, so that an interrupted study has shown what it knows.
    let tell = |print: &dyn Fn()| {
        if !study.running.quiet {
            ProgressBar::suspend(&bar, print);
        }
    };
    let mut report = Report {
        schema: "study/2",
        seed: study.seed,
        quick: study.quick,
        joints: data.joints.clone(),
        folds: settings.folds.len(),
        repeats: settings.repeats,
        hidden: settings.hidden,
        epochs: settings.training.epochs,
        windows_per_epoch: settings.windows,
        ..Report::default()
    };
    tell(&|| tables::heading(&report));
    let attention = compare.published()?;
    report.table_6 = vec![
        Variant::once("physics", data.physics_rmse(&settings.folds)),
        Variant::once("attention", attention.iter().map(Outcome::mean).collect()),
        Variant::once("no_attention", compare.without_attention()?),
        Variant::once(
            "attainable",
            attainable::rmse(study, &data, &settings.folds)?,
        ),
    ];
    tell(&|| tables::table_6(&report));
    report.table_8 = Some(verification::verify(&data, &attention)?);
    tell(&|| tables::verification(&report));
    let published = compare.published_over_seeds(&attention)?;
    report.inputs = compare.inputs(&published)?;
    tell(&|| tables::inputs(&report));
    report.timesteps = compare.timesteps(&published)?;
    tell(&|| tables::timesteps(&report));
    report.nodes = compare.nodes()?;
    tell(&|| tables::nodes(&report));
    let smooth = Data::simulated(study, Some(SPAN))?;
    stop(cancel, GO_ON)?;
    report.papers_way = compare.papers_way(&smooth, &published[0])?;
    tell(&|| tables::papers_way(&report));
    bar.finish_and_clear();
    if let Some(path) = &study.json {
        report::write_atomic(path, model::directory::json(&report))?;
    }
    // What is kept serves nothing but going on.
    std::fs::remove_dir_all(&kept).map_err(|e| Failure::other(format!("{}: {e}", kept.display())))
}
