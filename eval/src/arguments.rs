//! The command line.

use clap::Parser;
use control::demonstration::Withheld;
use std::path::PathBuf;

/// Width of a line for a person.
pub const WIDTH: usize = 100;

/// Scores a model directory on a recording and predicts its torque.
#[derive(Debug, Parser)]
#[command(name = "eval", version)]
pub struct Arguments {
    /// Print the systems of the source documents, which of them work, and published figures beside ours (Markdown); with a
    /// document's name its page. Needs neither model nor data.
    #[arg(long, exclusive = true, value_name = "DOCUMENT", num_args = 0..=1, default_missing_value = "")]
    pub sources: Option<String>,
    /// Track motions in simulation, under a drive's cascade with and without the model: the simulated robot of --model, or SCARA, Delta and
    /// PUMA beside the softMC manual's figures; needs no recording.
    #[arg(long, conflicts_with_all = ["data", "predict", "drive", "cutoff_hz", "collision", "verbose"])]
    pub closed_loop: bool,
    /// With --closed-loop and --model: what the simulated robot has beyond viscous and Coulomb friction.
    #[arg(long, value_enum, default_value_t = Beyond::All, requires = "closed_loop")]
    pub withheld: Beyond,
    /// Thresholds for collisions by torque error and momentum observer, and what exceeds them in the recording.
    #[arg(long, conflicts_with_all = ["predict", "verbose"])]
    pub collision: bool,
    /// With --collision: wanted false alarms per hour, of all joints together.
    #[arg(
        long,
        value_name = "PER_HOUR",
        default_value_t = 0.1,
        requires = "collision"
    )]
    pub false_alarms: f64,
    /// With --collision: choose the thresholds from this recording, without collisions, instead of from the data.
    #[arg(long, value_name = "REC", requires = "collision")]
    pub calibration: Option<PathBuf>,
    /// Model directory.
    #[arg(long, required_unless_present_any = ["sources", "closed_loop"])]
    pub model: Option<PathBuf>,
    /// Recording (.csv, .parquet, .npz, or the KR300 benchmark's .mat: its test part).
    #[arg(long, required_unless_present_any = ["sources", "closed_loop"])]
    pub data: Option<PathBuf>,
    /// Write the scores as JSON.
    #[arg(long)]
    pub json: Option<PathBuf>,
    /// Write a report page.
    #[arg(long)]
    pub html: Option<PathBuf>,
    /// Write predicted torque and its standard deviation as CSV; the recording needs no torque.
    #[arg(long)]
    pub predict: Option<PathBuf>,
    /// Drive file: names and units of the recording's columns, gear ratios, torque constants.
    #[arg(long)]
    pub drive: Option<PathBuf>,
    /// Cut-off of the zero-phase low-pass of the motion, Hz [default: the model's own].
    #[arg(long)]
    pub cutoff_hz: Option<f64>,
    /// Print the scores of every model and scope.
    #[arg(long, conflicts_with = "quiet")]
    pub verbose: bool,
    /// Print nothing but errors.
    #[arg(long)]
    pub quiet: bool,
}

/// What a simulated robot has that its model may not know.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Beyond {
    /// Friction with memory, load, temperature and ripple, and elastic gears.
    All,
    /// The same with stiff gears.
    Friction,
    /// Nothing.
    Nothing,
}

impl From<Beyond> for Withheld {
    fn from(beyond: Beyond) -> Self {
        match beyond {
            Beyond::All => Self::FrictionAndElasticity,
            Beyond::Friction => Self::Friction,
            Beyond::Nothing => Self::Nothing,
        }
    }
}
