//! Raw recordings of robots that nobody has met: do the intervals of the torque channel cover, and what does the default
//! cut-off cost against the best one in hindsight?
//!
//! `cargo run --release -p residyn-benches --example raw_recordings -- --cases 100 --seed S` simulates recordings (see
//! `trials::raw`), estimates the channel of the part to fit on, and prints how often intervals of 95 % hold the truth, with
//! the interval of Clopper and Pearson. With `--cutoffs` it also fits the physics of `train --physics-only` with its own
//! choice and with every cut-off of a list, and compares the errors on the part to test on. A run that was cut off goes on
//! with `--first K`: recordings do not depend on each other.

use clap::Parser;
use datasets::channel::Estimate95;
use datasets::metrics::{Row, Scope};
use datasets::prepare::{PrepareOptions, prepare};
use model::physics_fit::{FitOptions, fit_physics};
use model::preparation::channel::estimate;
use model::preparation::cutoff::HIGHEST_PART;
use physics::robot::Robot;
use rayon::prelude::*;
use std::process::ExitCode;
use trials::raw::{RawCase, generate};

/// Intervals of the torque channel and choice of the cut-off on simulated raw recordings.
#[derive(Parser)]
struct Arguments {
    /// Number of recordings.
    #[arg(long, default_value_t = 100)]
    cases: u64,
    /// Seed.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Index of the first recording.
    #[arg(long, default_value_t = 0)]
    first: u64,
    /// A line for every joint.
    #[arg(long)]
    joints: bool,
    /// Fit the physics with its own cut-off and with each of a list.
    #[arg(long)]
    cutoffs: bool,
}

/// Whether intervals hold the truth.
#[derive(Default, Clone)]
struct Tally {
    held: usize,
    judged: usize,
    /// Not determined.
    unknown: usize,
    /// Half widths.
    halves: Vec<f64>,
}

impl Tally {
    fn count(&mut self, estimate: &Estimate95, truth: f64) {
        let Some([low, high]) = estimate.interval else {
            self.unknown += 1;
            return;
        };
        self.judged += 1;
        self.held += usize::from((low..=high).contains(&truth));
        self.halves.push(0.5 * (high - low));
    }

    fn add(mut self, other: &Self) -> Self {
        self.held += other.held;
        self.judged += other.judged;
        self.unknown += other.unknown;
        self.halves.extend(&other.halves);
        self
    }

    fn line(&self, what: &str) -> String {
        let [low, high] = signal::proportion::interval(self.held, self.judged, 0.05);
        format!(
            "{what:<34} {:>4} of {:>4} = {:.3} [{low:.3}, {high:.3}], median half width {:.4}, not determined {}",
            self.held,
            self.judged,
            self.held as f64 / self.judged.max(1) as f64,
            signal::quantile::median(self.halves.clone()).unwrap_or(f64::NAN),
            self.unknown
        )
    }
}

/// Cut-offs of which the best in hindsight is taken, Hz; those above 0.4 of the rate are left out.
const HINDSIGHT: [f64; 8] = [2.0, 3.5, 6.0, 9.0, 14.0, 22.0, 40.0, 80.0];

/// Error on the part to test on of the physics at its own cut-off, that cut-off, and the best error and cut-off of the list.
fn against_hindsight(
    robot: &Robot,
    case: &RawCase,
) -> Result<[f64; 4], Box<dyn std::error::Error + Send + Sync>> {
    let fit =
        |cutoff_hz: Option<f64>| -> Result<[f64; 2], Box<dyn std::error::Error + Send + Sync>> {
            let options = FitOptions {
                prepare: PrepareOptions {
                    cutoff_hz,
                    ..PrepareOptions::default()
                },
                ..FitOptions::default()
            };
            let fit = fit_physics(
                robot,
                std::slice::from_ref(&case.train),
                Some(&case.test),
                &options,
            )?;
            let rows = fit.rows(1, &case.test)?;
            let own = |r: &&Row| r.name == "physics" && r.scope == Scope::All;
            let error = rows.iter().find(own).and_then(|r| r.scores.mean_nrmse);
            let cutoff = fit.file.preprocessing.cutoff_hz.unwrap_or(f64::NAN);
            Ok([error.unwrap_or(f64::NAN), cutoff])
        };
    let [own, at] = fit(None)?;
    let highest = HIGHEST_PART * case.truth.setting.rate_hz;
    let mut best = [own, at];
    for hz in HINDSIGHT.into_iter().filter(|hz| *hz < highest) {
        let tried = fit(Some(hz))?;
        if tried[0] < best[0] {
            best = tried;
        }
    }
    Ok([own, at, best[0], best[1]])
}

#[derive(Default, Clone)]
struct Outcome {
    /// Error with the default cut-off over the best in hindsight.
    ratio: Option<f64>,
    common: Tally,
    joint_delay: Tally,
    scale: Tally,
    offset: Tally,
    signs: Tally,
    text: String,
}

fn judge(
    case: &RawCase,
    joints: bool,
    cutoffs: bool,
) -> Result<Outcome, Box<dyn std::error::Error + Send + Sync>> {
    let robot = Robot::from_urdf_str(&case.urdf)?;
    let prepared = prepare(&case.train, &PrepareOptions::default())?;
    let found = estimate(&robot, &case.train, &prepared);
    let truth = &case.truth;
    let mut out = Outcome::default();
    let shared = truth.lag.iter().all(|l| *l == truth.lag[0]);
    if shared {
        out.common.count(&found.delay, truth.delay);
    }
    let show = |e: &Estimate95, unit: f64| match (e.value, e.interval) {
        (Some(v), Some([a, b])) => format!("{:.3} [{:.3}, {:.3}]", unit * v, unit * a, unit * b),
        _ => "null".to_owned(),
    };
    let setting = &truth.setting;
    out.text = format!(
        "{:>3} {} {:<12} {:>4.0} Hz {:>5.1} s cut-off {:>5.1}: delay {} ms, truth {:.2}{}",
        setting.index,
        setting.id,
        setting.robot,
        setting.rate_hz,
        case.train.len() as f64 / setting.rate_hz,
        prepared.report.cutoff_hz.unwrap_or(f64::NAN),
        show(&found.delay, 1e3),
        1e3 * truth.delay,
        if shared { "" } else { " (filters differ)" },
    );
    if cutoffs {
        let [own, at, best, best_at] = against_hindsight(&robot, case)?;
        out.ratio = Some(own / best).filter(|r| r.is_finite());
        out.text += &format!(
            "\n      NRMSE {own:.4} at {at:.1} Hz, best {best:.4} at {best_at:.1} Hz: {:.3}",
            own / best
        );
    }
    for (j, channel) in found.joints.iter().enumerate() {
        out.joint_delay.count(&channel.delay, truth.joint_delay[j]);
        out.scale.count(&channel.scale, truth.gain[j]);
        out.offset.count(&channel.offset, truth.offset[j]);
        if let Some(sign) = channel.sign {
            out.signs.judged += 1;
            out.signs.held += usize::from(f64::from(sign) * truth.gain[j] > 0.0);
        } else {
            out.signs.unknown += 1;
        }
        if joints {
            let held = |e: &Estimate95, t: f64| match e.interval {
                Some([a, b]) if (a..=b).contains(&t) => ' ',
                Some(_) => '!',
                None => '-',
            };
            out.text += &format!(
                "\n      {} delay {} ms, truth {:.2} {} scale {}, truth {:.3} {} offset {}, truth {:.3} {} {:?}",
                j + 1,
                show(&channel.delay, 1e3),
                1e3 * truth.joint_delay[j],
                held(&channel.delay, truth.joint_delay[j]),
                show(&channel.scale, 1.0),
                truth.gain[j],
                held(&channel.scale, truth.gain[j]),
                show(&channel.offset, 1.0),
                truth.offset[j],
                held(&channel.offset, truth.offset[j]),
                truth.lag[j],
            );
        }
    }
    Ok(out)
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let span = arguments.first..arguments.first + arguments.cases;
    println!("seed {}, recordings {span:?}", arguments.seed);
    let outcomes: Result<Vec<Outcome>, _> = span
        .into_par_iter()
        .map(|index| {
            let case = generate(arguments.seed, index)?;
            let outcome = judge(&case, arguments.joints, arguments.cutoffs)?;
            println!("{}", outcome.text);
            Ok::<_, Box<dyn std::error::Error + Send + Sync>>(outcome)
        })
        .collect();
    let outcomes = match outcomes {
        Ok(outcomes) => outcomes,
        Err(error) => {
            eprintln!("raw_recordings: {error}");
            return ExitCode::FAILURE;
        }
    };
    let sum = |of: fn(&Outcome) -> &Tally| {
        outcomes
            .iter()
            .fold(Tally::default(), |sum, o| sum.add(of(o)))
    };
    println!(
        "{}",
        sum(|o| &o.common).line("delay, one filter for all joints")
    );
    println!("{}", sum(|o| &o.joint_delay).line("delay, joint by joint"));
    println!("{}", sum(|o| &o.scale).line("scale, joint by joint"));
    println!("{}", sum(|o| &o.offset).line("offset, joint by joint"));
    println!("{}", sum(|o| &o.signs).line("sign"));
    let ratios: Vec<f64> = outcomes.iter().filter_map(|o| o.ratio).collect();
    if let (Some(middle), Some(worst)) = (
        signal::quantile::median(ratios.clone()),
        ratios.iter().copied().reduce(f64::max),
    ) {
        println!(
            "error over that of the best cut-off in hindsight: median {middle:.3}, worst {worst:.3}, {} recordings",
            ratios.len()
        );
    }
    ExitCode::SUCCESS
}
