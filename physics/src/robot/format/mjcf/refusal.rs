//! How this format says that it cannot be used.

use crate::robot::RobotError;

/// An MJCF that cannot be used, and what to do.
pub(super) fn refused(reason: impl Into<String>) -> RobotError {
    RobotError::Mjcf {
        reason: reason.into(),
    }
}
