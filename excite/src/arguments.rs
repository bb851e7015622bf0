//! The command line.

use clap::{Parser, ValueEnum};
use identify::excitation::{Criterion, Region, Rest};
use std::path::PathBuf;

/// Designs motions within a robot's limits from which its parameters can be identified, and says what a motion would
/// show.
#[derive(Debug, Parser)]
#[command(name = "excite", version = program::VERSION)]
pub struct Arguments {
    /// The robot: a URDF, or the name of a built-in one.
    #[arg(long, default_value = "ur5")]
    pub robot: String,
    /// Joints of the robot, base first, or the frame of its tool; needed where the description holds more joints.
    /// NAME=POSITION (rad or m) holds another joint at that position [default: the only chain].
    #[arg(long, value_name = "A,B,C", value_delimiter = ',')]
    pub joints: Vec<String>,
    /// Drive file: rotor inertias, gear ratios; and columns of --motion.
    #[arg(long, value_name = "FILE.toml")]
    pub drive: Option<PathBuf>,
    /// Gravity in the base frame, m/s².
    #[arg(long, value_name = "X,Y,Z", value_parser = model::preparation::setup::gravity, allow_hyphen_values = true)]
    pub gravity: Option<[f64; 3]>,
    /// Where the motion is written: .csv or .parquet.
    #[arg(long, value_name = "FILE", default_value = "excitation.csv")]
    pub out: PathBuf,
    /// Write the summary, and with --plan what the motion would show, as JSON.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Write the same with curves as a self-contained page.
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
    /// Say which base parameters and which effects the motion would show, and from which size on.
    #[arg(long)]
    pub plan: bool,
    /// Write commands for `residyn replay` instead: ramps, steps and holds joint by joint, and a sweep of all. They
    /// separate gain, friction, damping, inertia and delay of each drive. Record them twice, without and with a known
    /// load.
    #[arg(long, conflicts_with_all = ["plan", "method", "criterion", "against", "json", "html", "trajectories", "period"])]
    pub replay: bool,
    /// Judge this motion instead of designing one: a file that excite wrote, or a recording. No motion is written.
    #[arg(long, value_name = "FILE", requires = "plan", conflicts_with_all = ["method", "criterion", "against", "out"])]
    pub motion: Option<PathBuf>,

    /// How motions are made: periodic series that a criterion improves, one sine per joint, or random ones.
    #[arg(long, value_enum, default_value = "fourier")]
    pub method: Method,
    /// Criterion that the search makes small. By default the condition number of the regressor over the noise, with its
    /// parts added (sub-regressors). `separation`, with --against: what two models have alike.
    #[arg(long, value_name = "NAME", value_parser = criterion, default_value = "cond-sub-noise",
          long_help = "cond, cond-noise, cond-sub, cond-sub-noise, d-optimal, separation: see docs/excitation.md")]
    pub criterion: Wanted,
    /// With --criterion separation: the model from which the motion is to tell the robot apart.
    #[arg(long, value_name = "ROBOT")]
    pub against: Option<String>,

    /// Number of trajectories; each complements those before it [default: 3; model-free: 36].
    #[arg(long, value_name = "N")]
    pub trajectories: Option<usize>,
    /// Length of a trajectory, s [default: 12.5; model-free: 60.6; sines: as long as three periods take].
    #[arg(long, value_name = "S", value_parser = positive)]
    pub period: Option<f64>,
    /// Number of harmonics of a series.
    #[arg(long, value_name = "N", default_value_t = 5)]
    pub harmonics: usize,
    /// Highest frequency, Hz; keep it below the first resonance [default: that of the last harmonic; model-free: 1].
    #[arg(long, value_name = "F", value_parser = positive)]
    pub max_hz: Option<f64>,
    /// Highest derivative that is zero at both ends of a series: velocity, acceleration or jerk [default: acceleration;
    /// model-free: jerk].
    #[arg(long, value_name = "LEVEL", value_parser = rest)]
    pub rest: Option<Rest>,
    /// Number of runs of each trajectory in a row, to average over.
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub repeat: usize,
    /// Samples per second of the file.
    #[arg(long, value_name = "HZ", value_parser = positive, default_value_t = 100.0)]
    pub rate: f64,

    /// File of limits: see docs/excitation.md. It overrides the robot's description, and flags override it.
    #[arg(long, value_name = "FILE.toml")]
    pub limits: Option<PathBuf>,
    /// Position range, rad or m: LO:HI for every joint, or one for each, LO:HI,LO:HI,…
    #[arg(long, value_name = "LO:HI,…", value_delimiter = ',', value_parser = range, allow_hyphen_values = true)]
    pub position: Vec<[f64; 2]>,
    /// Largest speed, rad/s or m/s: one value for every joint, or one for each.
    #[arg(long, value_name = "V,…", value_delimiter = ',', value_parser = positive)]
    pub velocity: Vec<f64>,
    /// Largest acceleration [default: full speed in half a second].
    #[arg(long, value_name = "A,…", value_delimiter = ',', value_parser = positive)]
    pub acceleration: Vec<f64>,
    /// Largest jerk [default: full acceleration in a tenth of a second].
    #[arg(long, value_name = "J,…", value_delimiter = ',', value_parser = positive)]
    pub jerk: Vec<f64>,
    /// Part of all these limits that the motion may use.
    #[arg(long, value_name = "F", value_parser = share, default_value_t = 0.9)]
    pub share: f64,
    /// Pose at which every trajectory starts and ends, one value for all joints or one for each.
    #[arg(
        long,
        value_name = "Q,…",
        value_delimiter = ',',
        allow_hyphen_values = true
    )]
    pub home: Vec<f64>,
    /// The tool's point in the frame of the last joint, m.
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    pub tool: Option<[f64; 3]>,
    /// Box in the base frame that the tool stays in, m. May be repeated: the tool then stays in all of them.
    #[arg(long, value_name = "LO:HI,LO:HI,LO:HI", value_parser = tool_box, allow_hyphen_values = true)]
    pub tool_box: Vec<Region>,
    /// Sphere in the base frame that the tool stays in: centre and radius, m. May be repeated.
    #[arg(long, value_name = "X,Y,Z,R", value_parser = tool_sphere, allow_hyphen_values = true)]
    pub tool_sphere: Vec<Region>,

    /// Parameters to identify besides the inertial ones: rotor, viscous, coulomb, offset [default: all four].
    #[arg(long, value_name = "NAME,…", value_delimiter = ',', value_enum)]
    pub columns: Vec<Column>,
    /// Standard deviation of one torque sample, N·m: one value for every joint, or one for each [default: a hundredth
    /// of the joint's torque over random states].
    #[arg(long, value_name = "S,…", value_delimiter = ',', value_parser = positive)]
    pub noise: Vec<f64>,
    /// Number of motions tried for each trajectory.
    #[arg(long, value_name = "N", default_value_t = 4000)]
    pub evaluations: usize,
    /// Seed; the same gives the same file.
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
    /// Print nothing but errors.
    #[arg(long)]
    pub quiet: bool,
}

/// How motions are made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Method {
    /// Periodic Fourier series, improved by the criterion (Swevers; Han; UR5; COMAU).
    Fourier,
    /// One sine per joint of frequencies without whole ratios (softMC manual).
    Sines,
    /// Random series that no model chooses (KR300 benchmark).
    ModelFree,
}

impl Method {
    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fourier => "fourier",
            Self::Sines => "sines",
            Self::ModelFree => "model-free",
        }
    }
}

/// What a motion is to be good for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// The parameters of the model.
    Parameters(Criterion),
    /// To tell the model from another.
    Separation,
}

impl Wanted {
    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Parameters(c) => c.name(),
            Self::Separation => "separation",
        }
    }
}

/// Parameters beside the inertial ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Column {
    /// Rotor inertia.
    Rotor,
    /// Viscous friction.
    Viscous,
    /// Coulomb friction.
    Coulomb,
    /// Offset of the torque.
    Offset,
}

fn criterion(text: &str) -> Result<Wanted, String> {
    let mut all = Criterion::ALL
        .into_iter()
        .map(Wanted::Parameters)
        .collect::<Vec<_>>();
    all.push(Wanted::Separation);
    let names: Vec<&str> = all.iter().map(|w| w.name()).collect();
    let found = all.iter().find(|w| w.name() == text);
    found
        .copied()
        .ok_or_else(|| format!("expected one of {}", names.join(", ")))
}

fn rest(text: &str) -> Result<Rest, String> {
    match text {
        "velocity" => Ok(Rest::Velocity),
        "acceleration" => Ok(Rest::Acceleration),
        "jerk" => Ok(Rest::Jerk),
        _ => Err("expected velocity, acceleration or jerk".into()),
    }
}

fn positive(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value),
        _ => Err("a number above zero is needed".into()),
    }
}

fn share(text: &str) -> Result<f64, String> {
    match positive(text) {
        Ok(value) if value <= 1.0 => Ok(value),
        _ => Err("a number above 0 and up to 1 is needed".into()),
    }
}

fn numbers<const N: usize>(text: &str, separator: char) -> Option<[f64; N]> {
    let parts: Vec<&str> = text.split(separator).collect();
    let values: Vec<f64> = parts
        .iter()
        .filter_map(|part| part.trim().parse().ok())
        .filter(|v: &f64| v.is_finite())
        .collect();
    let whole = values.len() == parts.len();
    whole.then(|| values.try_into().ok()).flatten()
}

fn point(text: &str) -> Result<[f64; 3], String> {
    numbers(text, ',').ok_or_else(|| "expected three numbers in m, for example 0,0,0.15".into())
}

fn range(text: &str) -> Result<[f64; 2], String> {
    match numbers::<2>(text, ':') {
        Some([low, high]) if low < high => Ok([low, high]),
        _ => Err("expected LO:HI with LO below HI, for example -1.5:1.5".into()),
    }
}

fn tool_box(text: &str) -> Result<Region, String> {
    let sides: Vec<[f64; 2]> = text.split(',').map(range).collect::<Result<_, _>>()?;
    match <[[f64; 2]; 3]>::try_from(sides) {
        Ok([x, y, z]) => Ok(Region::Box {
            lower: [x[0], y[0], z[0]],
            upper: [x[1], y[1], z[1]],
        }),
        Err(_) => Err("expected three ranges, for example -0.5:0.5,-0.5:0.5,0.1:1".into()),
    }
}

fn tool_sphere(text: &str) -> Result<Region, String> {
    match numbers::<4>(text, ',') {
        Some([x, y, z, radius]) if radius > 0.0 => Ok(Region::Sphere {
            centre: [x, y, z],
            radius,
        }),
        _ => Err("expected centre and radius, for example 0,0,0.5,0.8".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn ranges_and_regions_from_text() {
        assert_eq!(range("-1.5:2"), Ok([-1.5, 2.0]));
        let lower = [-1.0, -2.0, 0.0];
        let upper = [1.0, 2.0, 3.0];
        assert_eq!(tool_box("-1:1,-2:2,0:3"), Ok(Region::Box { lower, upper }));
        let sphere = tool_sphere("0,-0.5,1,0.8");
        let centre = [0.0, -0.5, 1.0];
        assert_eq!(
            sphere,
            Ok(Region::Sphere {
                centre,
                radius: 0.8
            })
        );
        for wrong in ["1:1", "2:1", "1", "1:x", "1:2:3", "", "0:inf"] {
            assert!(range(wrong).is_err(), "{wrong}");
        }
        for wrong in ["0,0,0", "0,0,0,-1", "0,0,0,1,2", "a,0,0,1"] {
            assert!(tool_sphere(wrong).is_err(), "{wrong}");
        }
        assert!(tool_box("0:1,0:1").is_err() && tool_box("0:1,0:1,1:0").is_err());
        assert!(criterion("cond-sub").is_ok() && criterion("best").is_err());
        assert!(share("1").is_ok() && share("1.1").is_err() && share("0").is_err());
    }
}
