//! Command line of `simulate`.
// `println!` panics where the reader has gone (`… | head`): see `report::say`.
#![deny(clippy::print_stdout, clippy::print_stderr)]

use crate::protocols::changed::{Change, changed};
use crate::protocols::payload::{LoadedArm, loaded};
use crate::{Protocol, SimulateError, cases, raw};
use clap::builder::PossibleValuesParser;
use clap::{CommandFactory, Parser, Subcommand};
use indicatif::{ProgressBar, ProgressStyle};
use std::ffi::OsString;
use std::path::PathBuf;
use std::process::ExitCode;

/// Recordings of simulated robots, with effects that a rigid-body model lacks.
#[derive(Parser)]
#[command(name = "simulate", version = program::VERSION)]
struct Arguments {
    #[command(subcommand)]
    what: What,
    /// Number of threads; 0 is all cores.
    #[arg(long, global = true, default_value_t = 0)]
    threads: usize,
    /// No progress bar.
    #[arg(long, global = true)]
    quiet: bool,
}

#[derive(Subcommand)]
enum What {
    /// Sealed cases for `diagnose`: robot.urdf, train.parquet and test.parquet for each, and truth/ID.json.
    Cases {
        /// Folder to write into.
        #[arg(long)]
        out: PathBuf,
        /// Number of cases.
        #[arg(long, default_value_t = cases::ROUND)]
        cases: u64,
        /// Seed of the run.
        #[arg(long, default_value_t = 1)]
        seed: u64,
        /// Nearer to real recordings: descriptions that are further off, small effects on every joint, filtered currents,
        /// other rates, days and stamps, two effects on one joint, pushes at rest.
        #[arg(long)]
        hard: bool,
        /// Never draw this effect, as before it entered the catalogue.
        #[arg(long, conflicts_with = "hard", value_parser = PossibleValuesParser::new(cases::EFFECTS))]
        without: Option<String>,
        /// Write only cases of this effect: the first ones that the seed draws.
        #[arg(long, conflicts_with = "without", value_parser = PossibleValuesParser::new(cases::EFFECTS))]
        only: Option<String>,
        /// Version of the generator: 1 executes every motion once, 2 executes motions twice in a third of the cases.
        #[arg(long, value_name = "N", default_value_t = cases::GENERATOR, value_parser = clap::value_parser!(u8).range(1..=i64::from(cases::GENERATOR)))]
        generator: u8,
        /// Also record encoders on the links: columns ql1, ql2, …
        #[arg(long)]
        link_encoders: bool,
        /// Also record thermometers in the joints: columns temp1, temp2, …
        #[arg(long)]
        temperatures: bool,
    },
    /// Raw recordings as a controller logs them: robot.urdf, train.csv and test.csv for each, and truth/ID.json with delay,
    /// scale and offset of the torque.
    Raw {
        /// Folder to write into.
        #[arg(long)]
        out: PathBuf,
        /// Number of recordings.
        #[arg(long, default_value_t = 100)]
        cases: u64,
        /// Seed of the run.
        #[arg(long, default_value_t = 1)]
        seed: u64,
    },
    /// UR5: Fourier excitations at 100 Hz, 154,440 samples of point-to-point moves at 60 Hz, a verification run.
    Ur5(Recordings),
    /// KR300: 36 trajectories of 60.6 s run twice, 10 Hz behind a 2 Hz low-pass.
    Kr300(Recordings),
    /// Foxbot A05: Fourier series with friction by a power of speed.
    #[command(name = "foxbot_a05")]
    FoxbotA05(Recordings),
    /// An arm with and without a load: four excitations without, and one with a body on its last link. Also writes
    /// robot.urdf and truth.json.
    Payload {
        /// Folder to write into.
        #[arg(long)]
        out: PathBuf,
        /// Arm: ur5 or seven.
        #[arg(long, default_value = "ur5", value_parser = arm)]
        arm: LoadedArm,
        /// Seed of body, motion and noise.
        #[arg(long, default_value_t = 1)]
        seed: u64,
        /// Simulate only what a rigid model with viscous and Coulomb friction describes.
        #[arg(long)]
        plain: bool,
        /// Record torque as drives with wrong torque constants do. truth.json holds the gains that correct it.
        #[arg(long)]
        wrong_drives: bool,
    },
    /// An arm on two days between which one thing was changed, for `diagnose --before`: robot.urdf, whose masses are up to a
    /// fifth off, before.parquet, after.parquet and truth.json.
    Changed {
        /// Folder to write into.
        #[arg(long)]
        out: PathBuf,
        /// What was changed.
        #[arg(long, value_parser = PossibleValuesParser::new(Change::ALL.map(Change::name)))]
        change: String,
        /// Arm: ur5 or seven.
        #[arg(long, default_value = "ur5", value_parser = arm)]
        arm: LoadedArm,
        /// Execute the same motions on both days.
        #[arg(long)]
        again: bool,
        /// Seed of change, motion and noise.
        #[arg(long, default_value_t = 1)]
        seed: u64,
        /// Simulate only what a rigid model with viscous and Coulomb friction describes.
        #[arg(long)]
        plain: bool,
    },
}

fn arm(text: &str) -> Result<LoadedArm, String> {
    let all = [LoadedArm::Ur5, LoadedArm::Seven];
    let found = all.into_iter().find(|a| a.name() == text);
    found.ok_or_else(|| "expected ur5 or seven".to_owned())
}

#[derive(clap::Args)]
struct Recordings {
    /// Folder for NAME-PART.parquet and NAME-truth.json.
    #[arg(long)]
    out: PathBuf,
    /// Format: parquet or csv.
    #[arg(long, default_value = "parquet", value_parser = ["parquet", "csv"])]
    format: String,
    /// Seed of the simulation.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Simulate only what a rigid model with viscous and Coulomb friction describes.
    #[arg(long)]
    plain: bool,
}

/// The command line, as clap takes it.
pub fn command() -> clap::Command {
    Arguments::command()
}

/// Runs the program `simulate` and returns its exit status. The first of the arguments is the name by which it was
/// called. `--help` and wrong usage end the process here, as clap does it.
pub fn command_line(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let arguments = Arguments::parse_from(arguments);
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(arguments.threads)
        .build();
    let result = match pool {
        Ok(pool) => pool.install(|| run(&arguments)),
        Err(error) => {
            report::warn!("simulate: cannot start threads: {error}");
            return ExitCode::FAILURE;
        }
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            report::warn!("simulate: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &Arguments) -> Result<(), SimulateError> {
    match &arguments.what {
        What::Cases {
            out,
            cases,
            seed,
            hard,
            without,
            only,
            generator,
            link_encoders,
            temperatures,
        } => {
            let sensors = cases::Sensors {
                links: *link_encoders,
                temperatures: *temperatures,
            };
            let bar = bar(*cases, arguments.quiet);
            let without = without.as_deref().and_then(cases::effect_index);
            let count = *cases as usize;
            let specs: Vec<_> = match only {
                Some(only) if *hard => cases::draw_hard_only(only, *seed).take(count).collect(),
                Some(only) => cases::draw_only(only, *seed).take(count).collect(),
                None if *hard => (0..*cases).map(|i| cases::draw_hard(i, *seed)).collect(),
                None => {
                    let draw = |i| cases::draw_without(i, *seed, without);
                    (0..*cases).map(draw).collect()
                }
            };
            let specs: Vec<_> = specs.into_iter().map(|s| s.by(*generator)).collect();
            cases::write_all(&specs, *seed, sensors, out, |id, _| {
                bar.set_message(id.to_owned());
                bar.inc(1);
            })?;
            bar.finish_with_message(format!("written to {}", out.display()));
            Ok(())
        }
        What::Raw { out, cases, seed } => {
            let bar = bar(*cases, arguments.quiet);
            for index in 0..*cases {
                let case = raw::generate(*seed, index)?;
                raw::write(&case, out)?;
                bar.set_message(case.id);
                bar.inc(1);
            }
            bar.finish_with_message(format!("written to {}", out.display()));
            Ok(())
        }
        What::Ur5(to) => record(Protocol::Ur5, to, arguments.quiet),
        What::Kr300(to) => record(Protocol::Kr300, to, arguments.quiet),
        What::FoxbotA05(to) => record(Protocol::FoxbotA05, to, arguments.quiet),
        What::Payload {
            out,
            arm,
            seed,
            plain,
            wrong_drives,
        } => {
            let mut made = loaded(*arm, *plain, *seed)?;
            if *wrong_drives {
                made = made.with_wrong_drives(*seed);
            }
            for file in made.write(out)? {
                report::say!("{}", file.display());
            }
            Ok(())
        }
        What::Changed {
            out,
            change,
            arm,
            again,
            seed,
            plain,
        } => {
            let change = Change::ALL.into_iter().find(|c| c.name() == change);
            let change = change.unwrap_or(Change::None);
            for file in changed(*arm, change, *again, *plain, *seed)?.write(out)? {
                report::say!("{}", file.display());
            }
            Ok(())
        }
    }
}

fn record(protocol: Protocol, to: &Recordings, quiet: bool) -> Result<(), SimulateError> {
    let bar = bar(100, quiet);
    bar.set_message(protocol.name());
    let machine = protocol.machine()?;
    let machine = if to.plain { machine.plain() } else { machine };
    let made = protocol.simulate_machine(&machine, to.seed, &|part| {
        bar.set_position((100.0 * part) as u64);
    })?;
    bar.finish();
    for file in made.write(&to.out, &to.format)? {
        report::say!("{}", file.display());
    }
    Ok(())
}

fn bar(length: u64, quiet: bool) -> ProgressBar {
    if quiet {
        return ProgressBar::hidden();
    }
    let style = ProgressStyle::with_template("{bar:30} {pos}/{len} {elapsed} (left {eta}) {msg}");
    ProgressBar::new(length).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}
