//! Errors of identification.

use ::identify::feasible::FeasibilityError;
use ::identify::iterative::IterativeError;
use ::identify::least_squares::LeastSquaresError;

/// Reason why identification failed.
#[derive(Debug, thiserror::Error)]
pub enum IdentifyError {
    /// Recording without torque.
    #[error("{0} has no torque: nothing can be identified from it")]
    NoTorque(String),
    /// Recordings with another number of joints than the robot.
    #[error("the recordings have {found} joints, the robot has {expected}")]
    Joints {
        /// Number of joints of the recordings.
        found: usize,
        /// Number of joints of the robot.
        expected: usize,
    },
    /// Recordings in which no joint moves, so that no sample is left to fit.
    #[error("no joint moves in these recordings: nothing can be identified")]
    NothingMoves,
    /// Least-squares problem that cannot be solved.
    #[error(transparent)]
    LeastSquares(#[from] LeastSquaresError),
    /// Parts of the model that do not fit together.
    #[error(transparent)]
    Model(#[from] physics::torque_model::TorqueModelError),
    /// Parameters that do not fit the robot.
    #[error(transparent)]
    Robot(#[from] physics::robot::RobotError),
    /// Iterative estimator that failed.
    #[error(transparent)]
    Iterative(#[from] IterativeError),
    /// Failed search for physically possible links.
    #[error(transparent)]
    Feasibility(#[from] FeasibilityError),
    /// Prior that belongs to another robot.
    #[error("the model of {prior} given as prior has other base parameters than {robot}")]
    Prior {
        /// Name of the robot that the prior belongs to.
        prior: String,
        /// Name of the robot to identify.
        robot: String,
    },
}
