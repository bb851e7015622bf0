//! What can be wrong with a closed loop or a collision detector.

use ::model::failure::Failure;

/// Every message says what is wrong and what to do.
#[derive(Debug, thiserror::Error)]
pub enum ControlError {
    /// The model directory's physics.
    #[error(transparent)]
    Model(#[from] physics::torque_model::TorqueModelError),
    /// The model directory's run-time.
    #[error(transparent)]
    Load(#[from] feedforward::LoadError),
    /// A robot.
    #[error(transparent)]
    Robot(#[from] physics::robot::RobotError),
    /// A simulated robot.
    #[error(transparent)]
    Simulate(#[from] trials::SimulateError),
    /// A machine.
    #[error(transparent)]
    Machine(#[from] machines::MachineError),
    /// A designed motion.
    #[error(transparent)]
    Motion(#[from] identify::excitation::ExcitationError),
    /// A robot of which there is no simulated one.
    #[error("there is no simulated {0}; there are {1}")]
    NoSubject(String, String),
    /// A line that a machine cannot follow.
    #[error("{0}: the tool cannot follow the line; its ends or its middle are out of reach")]
    OutOfReach(String),
    /// A loop that ran away.
    #[error("{robot}, {mode}: the simulated loop is unstable")]
    Unstable {
        /// The robot.
        robot: String,
        /// What the controller added.
        mode: &'static str,
    },
    /// A recording too short for a threshold.
    #[error(
        "{file}: {seconds:.1} s of torque and motion; thresholds take at least {needed:.0} s, record longer"
    )]
    TooShort {
        /// The recording.
        file: String,
        /// Its length, s.
        seconds: f64,
        /// The least, s.
        needed: f64,
    },
}

impl From<ControlError> for Failure {
    fn from(error: ControlError) -> Self {
        let hint = match &error {
            ControlError::NoSubject(..) => {
                "Train on one of these, or run eval --closed-loop without --model."
            }
            ControlError::Load(_) | ControlError::Model(_) => {
                "Give a directory that train has written, whole and by this version."
            }
            ControlError::Unstable { .. } => {
                "Try --withheld friction or nothing: stiff gears; a model that fits its robot keeps it stable."
            }
            _ => "",
        };
        Self::input(error.to_string(), hint)
    }
}
