//! What is trained on: given recordings, or the simulated UR5.

use crate::arguments::Arguments;
use datasets::{Part, Recording};
use model::failure::Failure;
use model::setup::Setup;

/// Robot and recordings.
pub struct Input {
    /// The robot.
    pub setup: Setup,
    /// Training recordings.
    pub data: Vec<Recording>,
    /// The recording that is scored.
    pub heldout: Option<Recording>,
}

/// Reads what the arguments name; without `--data`, the built-in simulation of the robot is recorded.
pub fn read(arguments: &Arguments) -> Result<Input, Failure> {
    let gravity = arguments.gravity.as_ref().map(|g| [g[0], g[1], g[2]]);
    let setup = Setup::new(
        arguments.robot.as_deref().unwrap_or("ur5"),
        arguments.drive.as_deref(),
        gravity,
    )?;
    if arguments.data.is_empty() {
        if arguments.robot.is_some() || arguments.heldout.is_some() {
            return Err(Failure::input(
                "--data is missing",
                "Give recordings of the robot, or no argument at all for the simulated UR5.",
            ));
        }
        let (data, heldout) = simulated(arguments)?;
        return Ok(Input {
            setup,
            data,
            heldout: Some(heldout),
        });
    }
    let data = setup.read(&arguments.data, Part::Train, true)?;
    let heldout = match &arguments.heldout {
        Some(path) => setup
            .read(std::slice::from_ref(path), Part::Test, true)?
            .pop(),
        None => None,
    };
    Ok(Input {
        setup,
        data,
        heldout,
    })
}

fn simulated(_arguments: &Arguments) -> Result<(Vec<Recording>, Recording), Failure> {
    Err(Failure::input(
        "--robot and --data are missing",
        "Give a robot and its recordings.",
    ))
}
