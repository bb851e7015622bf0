//! The steps of `train`.

use crate::arguments::{Arguments, PresetName};
use crate::runtime::{pool, stop};
use crate::taught::Outside;
use crate::watch::Watch;
use crate::{
    checked, checkpoint, inertia, input, output, progress, screen, taught, topics, yardsticks,
};
use compensator::training::{Control, Progress, Tensors};
use datasets::Recording;
use model::cross_fit::physics_out_of_fold;
use model::directory::{Timing, json};
use model::failure::Failure;
use model::identify::identification::IdentifyOptions;
use model::physics_fit::{Fit, FitError, FitOptions, fit_physics};
use model::residual::{Preset, ResidualError, ResidualOptions, train_residual};
use model::spread::{LeftOut, by_regime};
use ndarray::Array2;
use report::{say, say_text};
use std::sync::atomic::AtomicBool;
use std::time::Instant;

/// Runs `train` on threads of its own until it is done or `cancel` is raised.
///
/// # Errors
/// Input that cannot be used, or the interruption.
pub fn run(arguments: &Arguments, cancel: &AtomicBool, watch: &dyn Watch) -> Result<(), Failure> {
    run_with(arguments, cancel, watch, no_gpu)
}

/// Device for the training with `--gpu`, which only a program built with GPU support has (`gpu/`).
pub type Gpu = fn() -> Result<Tensors, compensator::Error>;

/// Error of a program without GPU support, in place of a device.
pub(crate) fn no_gpu() -> Result<Tensors, compensator::Error> {
    Err(compensator::Error::Gpu(
        "this program was built without support for a GPU".into(),
    ))
}

/// Runs a training like [`run`], with a GPU for `--gpu`.
///
/// # Errors
/// Input that cannot be used, no GPU where one is asked for, or the interruption.
pub fn run_with(
    arguments: &Arguments,
    cancel: &AtomicBool,
    watch: &dyn Watch,
    gpu: Gpu,
) -> Result<(), Failure> {
    if arguments.list {
        return topics::list(&arguments.data);
    }
    let tensors = arguments.gpu.then(gpu).transpose();
    let tensors = tensors.map_err(ResidualError::from)?;
    let threads = arguments.running.threads();
    pool(&arguments.running)?
        .install(|| steps(arguments, cancel, watch, (threads, tensors.as_ref())))
}

fn steps(
    arguments: &Arguments,
    cancel: &AtomicBool,
    watch: &dyn Watch,
    (threads, tensors): (usize, Option<&Tensors>),
) -> Result<(), Failure> {
    let input = input::read(arguments)?;
    let prepare_options = checked::prepare_options(arguments);
    let checks = checked::reports(&input, &prepare_options)?;
    let robot = &input.setup.robot;
    if arguments.check_only && arguments.json {
        say_text!(json(&checks));
    } else if !arguments.running.quiet {
        let whole = arguments.check_only || arguments.verbose;
        let lines = checked::lines(robot, &checks, whole);
        lines.iter().for_each(|line| say!("{line}"));
    }
    if arguments.check_only {
        return Ok(());
    }
    checked::severe(robot, &checks)
        .iter()
        .for_each(|line| watch.warns(line));
    stop(cancel, "Nothing was written.")?;
    if arguments.resume {
        checkpoint::check(arguments, &input)?;
    }

    let estimator = arguments.estimator.options(&input.setup.robot)?;
    let spinner = arguments.running.spinner().with_message("identifying");
    let options = FitOptions {
        identify: IdentifyOptions {
            moving_only: arguments.moving_only,
            // The published compensator corrects the published physics: rigid body, viscous, Coulomb.
            select: !arguments.basic && arguments.preset != PresetName::Ucm,
            estimator,
            ..IdentifyOptions::default()
        },
        prepare: prepare_options,
        seed: arguments.seed,
    };
    let begun = Instant::now();
    let fitted = |options: &FitOptions| {
        fit_physics(
            &input.setup.robot,
            &input.data,
            input.heldout.as_ref(),
            options,
        )
    };
    let mut fit = fitted(&options)?;
    // By its motion alone: shapes of friction that were chosen on slow motions run away on fast ones.
    let outside = fit
        .session
        .parts
        .get(input.data.len())
        .map_or_else(Vec::new, |heldout| {
            taught::outside(
                &input.setup.robot,
                &fit.session.parts[..input.data.len()],
                heldout,
            )
        });
    let faster = outside.iter().filter(|o| o.faster).map(|o| o.joint);
    let faster: Vec<usize> = faster.collect();
    if options.identify.select && !faster.is_empty() {
        let mut plain = options.clone();
        plain.identify.plain = faster;
        fit = fitted(&plain)?;
    }
    let apart = physics_out_of_fold(&fit, &input.data).map_err(FitError::from)?;
    let physics_s = begun.elapsed().as_secs_f64();
    spinner.finish_and_clear();
    stop(cancel, "Run the same command again.")?;

    let folder = if arguments.physics_only {
        None
    } else {
        Some(checkpoint::open(arguments, &input)?)
    };
    let begun = Instant::now();
    let learned = match &folder {
        None => None,
        Some(folder) => {
            let options = ResidualOptions {
                preset: match arguments.preset {
                    PresetName::Default => Preset::Default,
                    PresetName::Ucm => Preset::Ucm,
                },
                seed: arguments.seed,
                members: arguments.members,
                epochs: arguments.epochs,
                moving_only: arguments.moving_only,
                yardsticks: arguments.yardsticks,
            };
            let bar = progress::Training::new(
                arguments.running.quiet,
                &fit.file.joints,
                options.networks(fit.file.joints.len()),
            );
            let show = |p: &Progress| {
                bar.update(p);
                watch.trained(p);
            };
            let control = Control {
                threads,
                checkpoints: Some(folder),
                cancel: Some(cancel),
                progress: Some(&show),
                tensors,
            };
            let learned = train_residual(&fit, &input.data, &apart, &options, &control);
            bar.finish();
            Some(learned?)
        }
    };
    let compensator_s = learned.as_ref().map(|_| begun.elapsed().as_secs_f64());
    if let Some(learned) = &learned {
        fit.file.compensator = Some(learned.record.clone());
        fit.file.memory.clone_from(&learned.memory);
    }
    let left = match learned.as_ref().map(|l| &l.left) {
        Some(left) if !left.is_empty() => left.clone(),
        _ => left_out(&fit, &input.data, &apart),
    };
    fit.file.residual_std = by_regime(&left, &fit.file.residual_std);
    let metrics = output::metrics(&fit, learned.as_ref(), &input.data, input.heldout.as_ref())?;
    output::write(arguments, learned.as_ref(), &metrics, &fit)?;
    Timing::new(threads, physics_s, compensator_s, arguments.resume).save(&arguments.out)?;
    output::page(arguments, &fit, learned.as_ref(), &metrics, &input)?;
    if let Some(folder) = &folder {
        checkpoint::remove(folder);
    }
    let impossible = inertia::impossible(&arguments.out, &fit);
    let warned: Vec<String> = outside
        .iter()
        .map(Outside::line)
        .chain(impossible)
        .collect();
    warned.iter().for_each(|line| watch.warns(line));
    if !arguments.running.quiet {
        if arguments.verbose {
            screen::everything(&fit, &metrics, &warned, arguments);
        } else {
            screen::first(&fit, &metrics, &checks, &warned, arguments);
        }
        if let Some(compared) = learned.as_ref().and_then(|l| l.yardsticks.as_ref()) {
            yardsticks::print(compared, metrics.heldout.as_deref());
        }
    }
    Ok(())
}

/// Errors of the physics where it was not fitted.
fn left_out(fit: &Fit, data: &[Recording], apart: &[Array2<f64>]) -> Vec<LeftOut> {
    let mut left = vec![LeftOut::default(); fit.file.joints.len()];
    for (i, (recording, torque)) in data.iter().zip(apart).enumerate() {
        let Some(tau) = &recording.tau else { continue };
        let qd = &fit.session.parts[i].at_samples.qd;
        for ((row, joint), tau) in tau.indexed_iter() {
            left[joint].push(tau - torque[[row, joint]], qd[[row, joint]]);
        }
    }
    left
}
