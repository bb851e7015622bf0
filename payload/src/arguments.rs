//! The command line.

use clap::Parser;
use model::payload::gains::KnownBody;
use std::path::PathBuf;

/// Estimates mass, centre of mass and inertia of a body on the last link, from a recording with the body and a model
/// without it. With --known and --without: estimates the gains of the drives from a known body.
#[derive(Debug, Parser)]
#[command(name = "payload", version = program::VERSION)]
pub struct Arguments {
    /// Model directory of the robot without the body.
    #[arg(long, value_name = "DIR")]
    pub model: PathBuf,
    /// Recording of the robot with the body (.csv, .parquet, .npz, .mcap, rosbag2 folder).
    #[arg(long, value_name = "REC")]
    pub data: PathBuf,
    /// Drive file: names and units of the recording's columns, gear ratios, torque constants.
    #[arg(long, value_name = "FILE.toml")]
    pub drive: Option<PathBuf>,
    /// Cut-off of the zero-phase low-pass of the motion, Hz [default: the model's own].
    #[arg(long, value_name = "F")]
    pub cutoff_hz: Option<f64>,
    /// Relative change of friction to expect since the model was made, as one standard deviation.
    #[arg(long, value_name = "PART", default_value_t = 0.1, value_parser = part)]
    pub friction_change: f64,
    /// Known values of the body in the last joint's frame: MASS, MASS,X,Y,Z or MASS,X,Y,Z,Ixx,Ixy,Iyy,Ixz,Iyz,Izz (kg,
    /// m, kg·m² about the centre of mass). Estimates the gains of the drives instead of the body.
    #[arg(
        long,
        value_name = "NUMBERS",
        requires = "without",
        allow_hyphen_values = true
    )]
    pub known: Option<KnownBody>,
    /// With --known: recording of the robot without the body.
    #[arg(
        long,
        value_name = "REC",
        requires = "known",
        conflicts_with = "friction_change"
    )]
    pub without: Option<PathBuf>,
    /// Write the figures as JSON.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Print nothing but errors.
    #[arg(long)]
    pub quiet: bool,
}

fn part(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(value) if (0.0..=1.0).contains(&value) => Ok(value),
        _ => Err("a number from 0 to 1 is needed".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Arguments::command().debug_assert();
        assert!(part("0.3").is_ok() && part("1.2").is_err() && part("nan").is_err());
    }
}
