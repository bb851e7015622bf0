//! The command line.

use crate::unit::Unit;
use clap::Parser;
use std::path::PathBuf;

/// Adds the torque to a planned motion, for a controller that feeds it forward. A plan that breaks a limit of the robot
/// is refused; the message says at which speed it would hold.
#[derive(Debug, Parser)]
#[command(name = "feedforward", version = program::VERSION)]
pub struct Arguments {
    /// Model directory of the robot.
    #[arg(long, value_name = "DIR")]
    pub model: PathBuf,
    /// Planned motion: a table (.csv, .parquet, .npz) with `time`, `q1` … or `q_ref1` …, velocities and accelerations where it has
    /// them; or a bag (.mcap, .db3, folder) with a trajectory_msgs/JointTrajectory.
    #[arg(long, value_name = "PLAN")]
    pub trajectory: PathBuf,
    /// File to write: the same table with `tau1` … added (.csv, .parquet), in the units and signs that --drive declares; or a
    /// JointTrajectory with effort (.mcap, .yaml), in rad and the signs of the robot's description.
    #[arg(long, value_name = "OUT")]
    pub out: PathBuf,
    /// Unit of the torque: at the joint (N·m or N), current of the motor (A), or per mille of its rated torque (CiA 402, object
    /// 60B2h). The last two need --drive.
    #[arg(long, value_enum, default_value_t = Unit::Nm)]
    pub unit: Unit,
    /// Drive file: gear ratios, torque constants, rated currents; names and units of the plan's columns.
    #[arg(long, value_name = "FILE.toml")]
    pub drive: Option<PathBuf>,
    /// Compute the torque from the physics alone, without the learned compensator.
    #[arg(long)]
    pub physics_only: bool,
    /// Print nothing but errors.
    #[arg(long)]
    pub quiet: bool,
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Arguments::command().debug_assert();
    }
}
