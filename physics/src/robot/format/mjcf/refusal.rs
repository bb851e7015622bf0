//! Error of an MJCF that cannot be used.

use crate::robot::RobotError;

/// Error of an MJCF that cannot be used, with the remedy.
pub(super) fn refused(reason: impl Into<String>) -> RobotError {
    RobotError::Mjcf {
        reason: reason.into(),
    }
}
