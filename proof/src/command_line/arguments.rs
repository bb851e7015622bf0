//! Command line of `diagnose`.

use clap::builder::PossibleValuesParser;
use clap::{ArgGroup, Args, Parser, Subcommand};
use diagnose::settings::Rule;
use program::Running;
use std::path::PathBuf;
use trials::cases::{EFFECTS, GENERATOR};

/// Diagnoses the gap between a simulator's torque and a real robot's: where it lies, which unmodelled
/// effect causes it, and how far it shrinks on held-out data.
#[derive(Parser)]
#[command(name = "diagnose", version = program::VERSION, args_conflicts_with_subcommands = true)]
pub struct Command {
    /// Another job than a diagnosis.
    #[command(subcommand)]
    pub proof: Option<Proof>,
    /// The diagnosis.
    #[command(flatten)]
    pub arguments: Option<Arguments>,
    /// Threads and what is printed.
    #[command(flatten)]
    pub running: Running,
}

/// Jobs beside the diagnosis.
#[derive(Subcommand)]
pub enum Proof {
    /// Diagnoses sealed simulated cases with a withheld effect, and scores the answers.
    Prove(Sealed),
    /// Diagnoses and scores cases that `simulate cases` or another simulator has written into a folder: `cases/NAME` with a description,
    /// `train.parquet` and `test.parquet`, and `truth/NAME.json`.
    Score {
        /// Folder of the cases. Reports go into its `reports`. A report that is there already is scored as it is.
        folder: PathBuf,
        /// Skip all that is computed from surrogate recordings (p-values, the level of chance): somewhat faster.
        #[arg(long)]
        fast: bool,
    },
    /// Scores diagnoses of sealed simulated cases (every other one hard) with the ten most important thresholds halved
    /// and doubled, or with special rules switched off. Draws no surrogates.
    Thresholds {
        /// Number of cases.
        #[arg(long, default_value_t = 30)]
        cases: u64,
        /// Seed of the draw.
        #[arg(long, default_value_t = 1)]
        seed: u64,
        /// Version of the generator: 1 executes every motion once, 2 executes motions twice in a third of the cases.
        #[arg(long, value_name = "N", default_value_t = GENERATOR, value_parser = clap::value_parser!(u8).range(1..=i64::from(GENERATOR)))]
        generator: u8,
        /// Largest number of joints of an arm. Small arms are diagnosed faster.
        #[arg(long, value_name = "N", default_value_t = 7)]
        joints: usize,
        /// File of cases to use instead, with their stored answers: proof/tests/whole/headline.json.
        #[arg(long, value_name = "FILE", conflicts_with_all = ["cases", "seed", "generator", "joints"])]
        headline: Option<PathBuf>,
        /// Special rule to switch off, instead of changing thresholds; `all` stands for every rule. May be repeated:
        /// each rule is then switched off alone.
        #[arg(long, value_name = "RULE", value_parser = PossibleValuesParser::new(Rule::ALL.map(Rule::name).into_iter().chain(["all"])))]
        off: Vec<String>,
        /// Switch the rules of --off off together rather than each alone.
        #[arg(long, requires = "off")]
        together: bool,
        /// Folder for the reports. A report that is there already is scored as it is.
        #[arg(long)]
        out: Option<PathBuf>,
    },
    /// Diagnoses simulated arms before and after a change (payload, friction, torque constant, mount, joint zero or none), with the same
    /// motions and with others, and scores the answers.
    Changes {
        /// Number of pairs; 24 hold every change on both arms with either motion.
        #[arg(long, default_value_t = 24)]
        cases: u64,
        /// Seed of the draw.
        #[arg(long, default_value_t = 1)]
        seed: u64,
    },
}

/// Sealed cases.
#[derive(Args)]
pub struct Sealed {
    /// Number of cases.
    #[arg(long, default_value_t = 24)]
    pub cases: u64,
    /// Seed of the draw.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Cases nearer to real recordings: descriptions that are further off, small effects on every joint, filtered currents,
    /// other rates, days and stamps, two effects on one joint, pushes at rest.
    #[arg(long, conflicts_with = "leave_one_out")]
    pub hard: bool,
    /// Draw only cases of this kind: the name of an effect, none, outside or two (with --hard also two_same_joint or
    /// contact_at_rest).
    #[arg(long)]
    pub only: Option<String>,
    /// Never draw this effect, as before it entered the catalogue.
    #[arg(long, conflicts_with_all = ["hard", "leave_one_out"], value_parser = PossibleValuesParser::new(EFFECTS))]
    pub without: Option<String>,
    /// Version of the generator: 1 executes every motion once, 2 executes motions twice in a third of the cases.
    #[arg(long, value_name = "N", default_value_t = GENERATOR, value_parser = clap::value_parser!(u8).range(1..=i64::from(GENERATOR)))]
    pub generator: u8,
    /// Also give the arms encoders on their links.
    #[arg(long, conflicts_with = "leave_one_out")]
    pub link_encoders: bool,
    /// Also give the arms thermometers in their joints.
    #[arg(long, conflicts_with = "leave_one_out")]
    pub temperatures: bool,
    /// Also diagnose each case with its effect removed from the catalogue, and say what is named instead.
    #[arg(long)]
    pub leave_one_out: bool,
    /// Also say what can be known of the same cases at all: the Bayes choice of an observer who is told the true motion and the torque's
    /// channel, beside the diagnosis.
    #[arg(long, conflicts_with_all = ["link_encoders", "temperatures", "without"])]
    pub attainable: bool,
    /// Also fit the weights of the confidence to these cases, print them, and say how reliable they are on cases left
    /// out.
    #[arg(long)]
    pub calibrate: bool,
    /// Folder of an earlier run of the same program: its cases also count for the weights. May be repeated.
    #[arg(long, value_name = "DIR", requires = "calibrate")]
    pub with: Vec<PathBuf>,
    /// Skip all that is computed from surrogate recordings (p-values, the level of chance): somewhat faster.
    #[arg(long)]
    pub fast: bool,
    /// Folder for cases, answers and reports. A case whose report is there already is scored by it,
    /// whatever sensors it had.
    #[arg(long)]
    pub out: Option<PathBuf>,
}

/// A diagnosis.
#[derive(Args)]
#[command(group(ArgGroup::new("given").required(true).args(["robot", "model"])))]
pub struct Arguments {
    /// The simulator's model: a URDF, an MJCF, or the name of a built-in robot.
    #[arg(long)]
    pub robot: Option<String>,
    /// Joints of the robot, base first, or the frame of its tool; needed where the description holds more joints.
    /// NAME=POSITION (rad or m) holds another joint at that position [default: those that the recording's columns name,
    /// or the only chain].
    #[arg(
        long,
        value_name = "A,B,C",
        value_delimiter = ',',
        conflicts_with = "model"
    )]
    pub joints: Vec<String>,
    /// An identified model instead: a model directory that `train` wrote.
    #[arg(long, value_name = "DIR", conflicts_with = "gravity")]
    pub model: Option<PathBuf>,
    /// Earlier recordings of the same robot, to find what has changed since: the robot is identified from them. --robot then gives lengths,
    /// axes and gravity; its masses are a prior, used where it lowers the error on rows left out.
    #[arg(long, num_args = 1.., conflicts_with_all = ["model", "learn", "next"])]
    pub before: Vec<PathBuf>,
    /// Recordings of the real robot on which effects are fitted.
    #[arg(long, required = true, num_args = 1..)]
    pub data: Vec<PathBuf>,
    /// Recording on which every figure is measured [default with --before: every third trajectory of --data].
    #[arg(long, required_unless_present = "before")]
    pub heldout: Option<PathBuf>,
    /// Gravity in the base frame, m/s².
    #[arg(
        long,
        value_name = "X,Y,Z",
        value_parser = model::preparation::setup::gravity,
        allow_hyphen_values = true
    )]
    pub gravity: Option<[f64; 3]>,
    /// Drive file: gear ratios, torque constants, joint zeros, names and units of columns.
    #[arg(long, value_name = "FILE.toml")]
    pub drive: Option<PathBuf>,
    /// Rows per second of tables without a column of time.
    #[arg(long, value_name = "HZ", value_parser = model::preparation::setup::rate)]
    pub rate: Option<f64>,
    /// Cut-off of the motion's low-pass, Hz, instead of the one chosen from the data.
    #[arg(long, value_name = "F", value_parser = cutoff)]
    pub cutoff_hz: Option<f64>,
    /// Skip all that is computed from surrogate recordings (p-values, the level of chance): somewhat faster.
    #[arg(long)]
    pub fast: bool,
    /// Also train a compensator and say how much of the rest of the gap it would close.
    #[arg(long)]
    pub learn: bool,
    /// Write the motion (CSV or Parquet, as `excite` does) that best tells ambiguous causes apart, within the robot's limits.
    #[arg(long, value_name = "FILE")]
    pub next: Option<PathBuf>,
    /// Write the report as JSON; `-` is standard output.
    #[arg(long)]
    pub json: Option<PathBuf>,
    /// Write the report as a self-contained page.
    #[arg(long)]
    pub html: Option<PathBuf>,
    /// Write torque over time of the held-out recording for PlotJuggler or Foxglove (.mcap, .parquet): measured, as given, corrected and
    /// what is left, joint by joint. Beside an .mcap lie layouts for both.
    #[arg(long, value_name = "FILE")]
    pub trace: Option<PathBuf>,
    /// Write the model with the accepted causes. Of an MJCF: the whole model, ready for MuJoCo; else a URDF, and beside it a
    /// snippet for MuJoCo and, for rotor inertias, a drive file. With both a table of values.
    #[arg(long)]
    pub patch: Option<PathBuf>,
    /// Write the accepted causes as a model directory: for eval, a control loop, and --model. With --learn the compensator,
    /// too.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

fn cutoff(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(f) if f > 0.0 && f.is_finite() => Ok(f),
        _ => Err("a frequency above zero is needed, in Hz".to_owned()),
    }
}
