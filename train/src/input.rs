//! Input of a training: given recordings, or the simulated UR5.

use crate::arguments::Arguments;
use crate::periods;
use datasets::{Part, Recording};
use model::failure::Failure;
use model::preparation::setup::{Setup, refuse_overlap};
use physics::robot::Builtin;
use trials::protocols::{Protocol, cached};

/// Robot and recordings that a model is trained on.
pub struct Input {
    /// The robot and the options for reading its recordings.
    pub setup: Setup,
    /// Training recordings, prepared for the robot.
    pub data: Vec<Recording>,
    /// The recording that is scored.
    pub heldout: Option<Recording>,
}

/// Reads the recordings that the arguments name; without `--data`, the built-in robot is simulated.
pub fn read(arguments: &Arguments) -> Result<Input, Failure> {
    let mut setup = Setup::for_recordings(
        arguments.robot.as_deref().unwrap_or("ur5"),
        &arguments.joints,
        arguments.drive.as_deref(),
        arguments.gravity,
        &arguments.data,
    )?;
    setup.rate_hz = arguments.rate;
    if arguments.data.is_empty() {
        let protocol = match setup.robot.which_builtin() {
            Some(Builtin::Ur5) => Protocol::Ur5,
            Some(Builtin::Kr300) => Protocol::Kr300,
            Some(Builtin::FoxbotA05) => Protocol::FoxbotA05,
            Some(Builtin::Puma560) | None => {
                return Err(Failure::input(
                    "--data is missing",
                    "Give recordings of the robot; only ur5, kr300 and foxbot_a05 can be simulated instead.",
                ));
            }
        };
        if arguments.heldout.is_some() {
            return Err(Failure::input(
                "--heldout without --data",
                "Give recordings to learn from, or leave --heldout out for the simulated robot.",
            ));
        }
        let (data, heldout) = simulated(protocol, arguments)?;
        return Ok(Input {
            setup,
            data,
            heldout,
        });
    }
    let data = setup.read_training(&arguments.data)?;
    let heldout = arguments
        .heldout
        .as_ref()
        .map(|path| setup.read_one(path, Part::Test, true))
        .transpose()?;
    if let Some(heldout) = &heldout {
        refuse_overlap(&data, heldout)?;
    }
    let data = periods::applied(data, arguments)?;
    Ok(Input {
        setup,
        data,
        heldout,
    })
}

/// Training recordings and the held-out one (the protocol's last part), simulated once and cached.
fn simulated(
    protocol: Protocol,
    arguments: &Arguments,
) -> Result<(Vec<Recording>, Option<Recording>), Failure> {
    let bar = crate::progress::bar(
        arguments.running.quiet,
        &format!("simulating the {}", protocol.name()),
    );
    let cache = arguments.out.join("simulated");
    let progress = |done: f64| bar.set_position((100.0 * done) as u64);
    let set = cached(protocol, arguments.seed, &cache, &progress)
        .map_err(|e| Failure::other(e.to_string()))?;
    bar.finish_and_clear();
    let mut parts: Vec<Recording> = set
        .parts
        .into_iter()
        .map(|(_, recording)| recording)
        .collect();
    let heldout = parts.pop();
    Ok((parts, heldout))
}
