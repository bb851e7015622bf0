//! Command line of `train`.

use crate::doctor::Doctor;
use crate::estimator::EstimatorArguments;
use crate::forward::Forward;
use crate::oracle::Oracle;
use crate::study::Study;
use clap::{Parser, Subcommand, ValueEnum};
use program::Running;
use std::path::PathBuf;

/// Identifies a robot's physics from recordings, trains the compensator on what is left, and writes a
/// model directory. Without arguments: the simulated UR5, end to end.
#[derive(Debug, Parser)]
#[command(name = "train", version = program::VERSION, args_conflicts_with_subcommands = true)]
pub struct Arguments {
    /// Another job than training.
    #[command(subcommand)]
    pub command: Option<Command>,
    /// Built-in robot (ur5, kr300, foxbot_a05), URDF or MJCF [default: the simulated ur5].
    #[arg(long)]
    pub robot: Option<String>,
    /// Joints of the robot, base first, or the frame of its tool; needed where the description holds more joints.
    /// NAME=POSITION (rad or m) holds another joint at that position [default: those that the recording's columns name,
    /// or the only chain].
    #[arg(long, value_name = "A,B,C", value_delimiter = ',')]
    pub joints: Vec<String>,
    /// Recordings to learn from (.csv, .parquet, .npz, .mcap, .db3, rosbag2 folders; .mat with --robot kr300).
    #[arg(long, num_args = 1..)]
    pub data: Vec<PathBuf>,
    /// Recording kept for scoring. Its torque is never used to fit or to choose anything.
    #[arg(long)]
    pub heldout: Option<PathBuf>,
    /// Model directory to write.
    #[arg(long, default_value = "residyn-model")]
    pub out: PathBuf,
    /// Seed of all random numbers.
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
    /// Identify the physics only; train no compensator.
    #[arg(long)]
    pub physics_only: bool,
    /// Fit only viscous and Coulomb friction, offset and rotor inertia; select no further terms.
    #[arg(long)]
    pub basic: bool,
    /// Estimator.
    #[command(flatten)]
    pub estimator: EstimatorArguments,
    /// Fit only samples in motion (|q̇| > 0.01 rad/s or m/s, joint by joint).
    #[arg(long)]
    pub moving_only: bool,
    /// Kind of compensator.
    #[arg(long, value_enum, default_value_t = PresetName::Default)]
    pub preset: PresetName,
    /// Number of networks that are averaged for each joint.
    #[arg(long)]
    pub members: Option<usize>,
    /// Number of passes over the training data.
    #[arg(long)]
    pub epochs: Option<usize>,
    /// Also fit ridge regression and boosted trees to the same inputs and compare them on folds held back. They are
    /// kept beside the model for `eval --leaderboard`.
    #[arg(long, conflicts_with = "physics_only")]
    pub yardsticks: bool,
    /// Continue an interrupted run with the same arguments from its checkpoint.
    #[arg(long)]
    pub resume: bool,
    /// Stop after the check of the recordings.
    #[arg(long)]
    pub check_only: bool,
    /// List the topics of the bags of --data, with types, rates, joints and fields, or the features of its LeRobot data sets with the
    /// names of their columns, and stop.
    #[arg(long, requires = "data")]
    pub list: bool,
    /// With --check-only: print the check as JSON.
    #[arg(long)]
    pub json: bool,
    /// Drive file: gear ratios, torque constants, joint zeros, names and units of columns.
    #[arg(long)]
    pub drive: Option<PathBuf>,
    /// Rows per second of tables without a column of time.
    #[arg(long, value_name = "HZ", value_parser = model::preparation::setup::rate)]
    pub rate: Option<f64>,
    /// Gravity in the base frame, m/s².
    #[arg(long, value_name = "X,Y,Z", value_parser = model::preparation::setup::gravity, allow_hyphen_values = true)]
    pub gravity: Option<[f64; 3]>,
    /// Cut-off of the zero-phase low-pass of the motion, Hz [default: chosen from the data].
    #[arg(long)]
    pub cutoff_hz: Option<f64>,
    /// Average the runs of each motion of --data: trajectories that repeat and, with SECONDS, the periods of that
    /// length within each.
    #[arg(long, value_name = "SECONDS", num_args = 0..=1, requires = "data")]
    pub average: Option<Option<f64>>,
    /// With --average: fit the motion by a Fourier series with this many harmonics of the period, which also gives the
    /// derivatives.
    #[arg(long, value_name = "N", requires = "average")]
    pub harmonics: Option<usize>,
    /// Smooth the torque of --data by robust local regression (rloess) over a window of this many samples.
    #[arg(long, value_name = "SAMPLES", requires = "data")]
    pub rloess: Option<usize>,
    /// Train the networks on a GPU: only in the program built in `gpu/`. The networks are the same up to rounding.
    #[arg(long, conflicts_with = "physics_only")]
    pub gpu: bool,
    /// Print everything: all findings, parameters, tests of the residual, scores of every scope.
    #[arg(long, conflicts_with = "quiet")]
    pub verbose: bool,
    /// How it runs.
    #[command(flatten)]
    pub running: Running,
}

/// Jobs beside training.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Reprint the published comparisons on the simulated UR5.
    Study(Study),
    /// Compare a model of a simulated robot with the best possible: noise floor, attainable error, and what is left of
    /// each mechanism.
    Oracle(Oracle),
    /// Count how often the check of the torque channel is right, on simulated recordings of every kind.
    Doctor(Doctor),
    /// Predict positions from torque (the benchmark's forward task) by solving a trained model for the motion.
    Forward(Forward),
}

/// Names of the presets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum PresetName {
    /// Inputs are the joint's own motion, load and friction memory: the evidence favours these.
    Default,
    /// The published unit: motion of the joint and those further from the base, LSTM 128 + 128.
    Ucm,
}
