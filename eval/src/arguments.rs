//! The command line.
// What --closed-loop and --collision take is read where they are built.
#![cfg_attr(not(feature = "reproductions"), allow(dead_code))]

use clap::{ArgGroup, Parser};
#[cfg(feature = "reproductions")]
use control::demonstration::Withheld;
use feedforward::network::Weights;
use std::path::PathBuf;

/// Width of a line of output, characters.
pub const WIDTH: usize = 100;

/// Scores a model directory on a recording and predicts its torque.
///
/// `physics` is the identified model alone; `physics+compensator` adds the learned torque. Motion is filtered forwards and backwards, which
/// a control loop cannot do: rows and columns marked `[causal]` show the same model on motion that is derived from past positions alone, and
/// `[reference]` on the planned motion (q_ref). If the model does not fit the recording, the first note says so.
#[derive(Debug, Parser)]
#[command(name = "eval", version = program::VERSION)]
#[command(group(ArgGroup::new("scored").args(["data", "closed_loop"]).multiple(true)))]
pub struct Arguments {
    /// Print which systems of the source documents work here, and published figures beside ours (Markdown). With
    /// DOCUMENT: print the page of that document. Needs neither model nor data.
    #[arg(long, exclusive = true, value_name = "DOCUMENT", num_args = 0..=1, default_missing_value = "")]
    pub sources: Option<String>,
    /// Simulate the tracking of motions by a cascade drive, with and without the model. The robot is the simulated one
    /// of --model, or SCARA, Delta and PUMA beside the softMC manual's figures. Needs no recording.
    #[arg(long, conflicts_with_all = ["data", "predict", "drive", "cutoff_hz", "collision", "verbose"])]
    pub closed_loop: bool,
    /// With --closed-loop and --model: effects of the simulated robot beyond viscous and Coulomb friction.
    #[arg(long, value_enum, default_value_t = Beyond::All, requires = "closed_loop")]
    pub withheld: Beyond,
    /// Choose collision thresholds on torque error and momentum observer, and list where the recording exceeds them.
    #[arg(long, conflicts_with_all = ["predict", "verbose"])]
    pub collision: bool,
    /// With --collision: accepted false alarms per hour, all joints together.
    #[arg(
        long,
        value_name = "PER_HOUR",
        default_value_t = 0.1,
        requires = "collision"
    )]
    pub false_alarms: f64,
    /// With --collision: recording without collisions from which the thresholds are chosen, instead of from --data.
    #[arg(long, value_name = "REC", requires = "collision")]
    pub calibration: Option<PathBuf>,
    /// Model directory.
    #[arg(long, required_unless_present_any = ["sources", "closed_loop", "leaderboard"])]
    pub model: Option<PathBuf>,
    /// Compare models of one robot on the recording, beside published results; --html, --markdown and --json then write that page.
    #[arg(long, value_name = "DIR", num_args = 1.., conflicts_with_all = ["model", "onnx", "predict", "verbose", "closed_loop", "collision"])]
    pub leaderboard: Vec<PathBuf>,
    /// Recording (.csv, .parquet, .npz, .mcap, rosbag2 folder, or the KR300 benchmark's .mat: its test part).
    #[arg(long, required_unless_present_any = ["sources", "closed_loop", "onnx"])]
    pub data: Option<PathBuf>,
    /// Write the scores as JSON; `-` is standard output.
    #[arg(long, requires = "scored")]
    pub json: Option<PathBuf>,
    /// Write a report page.
    #[arg(long, requires = "scored")]
    pub html: Option<PathBuf>,
    /// With --leaderboard: write the page as Markdown.
    #[arg(long, requires = "leaderboard", conflicts_with = "model")]
    pub markdown: Option<PathBuf>,
    /// With --leaderboard: print the rows as a Markdown table as in the README, without figures measured on this
    /// machine.
    #[arg(long, requires = "leaderboard", conflicts_with_all = ["model", "quiet"])]
    pub table: bool,
    /// Write predicted torque and its standard deviation as CSV; the recording needs no torque.
    #[arg(long, requires = "data")]
    pub predict: Option<PathBuf>,
    /// Write the compensator of all joints as one ONNX graph, with its inputs in a JSON file beside it (NAME.json).
    #[arg(long, value_name = "NAME", conflicts_with_all = ["closed_loop", "collision"])]
    pub onnx: Option<PathBuf>,
    /// With --onnx: a graph for one sample at a time, with what the networks remember as inputs and outputs.
    #[arg(long, requires = "onnx")]
    pub stepwise: bool,
    /// Choose how a control loop keeps the compensator's weights, and write a model directory with that choice to --out. Refused
    /// where a joint's torque error on --data, a recording that the model has not seen, grows by more than 1 %.
    #[arg(long, value_enum, value_name = "FORM", requires = "data", requires = "out", conflicts_with_all = ["closed_loop", "collision", "leaderboard"])]
    pub weights: Option<Form>,
    /// With --weights: the model directory to write; it holds what a loop needs.
    #[arg(long, value_name = "DIR", requires = "weights")]
    pub out: Option<PathBuf>,
    /// Drive file: names and units of the recording's columns, gear ratios, torque constants.
    #[arg(long)]
    pub drive: Option<PathBuf>,
    /// Rows per second of tables without a column of time.
    #[arg(long, value_name = "HZ", value_parser = model::preparation::setup::rate)]
    pub rate: Option<f64>,
    /// Cut-off of the zero-phase low-pass of the motion, Hz [default: the model's own].
    #[arg(long)]
    pub cutoff_hz: Option<f64>,
    /// Print the scores of every model, over all samples and over those in motion.
    #[arg(long, conflicts_with = "quiet")]
    pub verbose: bool,
    /// Print nothing but errors.
    #[arg(long)]
    pub quiet: bool,
}

/// How a control loop keeps weights.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Form {
    /// Single precision.
    F32,
    /// The upper half of single precision: half as much memory.
    Bf16,
    /// Whole numbers of eight bits with a scale for each output: a quarter.
    Int8,
}

impl From<Form> for Weights {
    fn from(form: Form) -> Self {
        match form {
            Form::F32 => Self::F32,
            Form::Bf16 => Self::Bf16,
            Form::Int8 => Self::Int8,
        }
    }
}

/// What a simulated robot has that its model may not know.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Beyond {
    /// Friction with memory, load, temperature and ripple, and elastic gears.
    All,
    /// The same with stiff gears.
    Friction,
    /// None of these.
    Nothing,
}

#[cfg(feature = "reproductions")]
impl From<Beyond> for Withheld {
    fn from(beyond: Beyond) -> Self {
        match beyond {
            Beyond::All => Self::FrictionAndElasticity,
            Beyond::Friction => Self::Friction,
            Beyond::Nothing => Self::Nothing,
        }
    }
}
