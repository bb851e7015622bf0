//! Preparation of every recording of a sum.

use crate::physics_fit::FitError;
use crate::preparation::cutoff;
use datasets::Recording;
use datasets::prepare::{Derivatives, PrepareOptions};
use physics::robot::Robot;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Preparation that all workers share. The torque counts as undelayed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Preparation {
    /// Cut-off of the motion's low-pass, Hz; none for recordings too slow for one.
    pub cutoff_hz: Option<f64>,
    /// Whether recorded velocity is ignored.
    pub position_alone: bool,
}

impl Preparation {
    /// Preparation with a given cut-off, Hz.
    pub fn given(cutoff_hz: f64) -> Self {
        Self {
            cutoff_hz: Some(cutoff_hz),
            position_alone: false,
        }
    }

    /// Preparation that `train` would choose for this recording alone.
    ///
    /// # Errors
    /// A recording that cannot be prepared, or not fitted.
    pub fn chosen(robot: &Robot, recording: &Recording) -> Result<Self, FitError> {
        let one = std::slice::from_ref(recording);
        let (options, _) = cutoff::choose(robot, one, &PrepareOptions::default())?;
        Ok(Self {
            cutoff_hz: options.cutoff_hz,
            position_alone: options.derivatives == Derivatives::FromPosition,
        })
    }

    /// Options for [`datasets::prepare::prepare`].
    pub fn options(&self) -> PrepareOptions {
        let mut options = PrepareOptions {
            cutoff_hz: self.cutoff_hz,
            ..PrepareOptions::default()
        };
        if self.position_alone {
            options.derivatives = Derivatives::FromPosition;
        }
        options
    }
}

impl fmt::Display for Preparation {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self.cutoff_hz {
            Some(hz) => write!(f, "a cut-off of {hz} Hz")?,
            None => write!(f, "no low-pass")?,
        }
        if self.position_alone {
            write!(f, ", derivatives of position alone")?;
        }
        Ok(())
    }
}
