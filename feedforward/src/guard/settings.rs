//! Settings of a guard.

/// Limits and times of a [`Guard`](super::Guard).
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Largest torque of each joint, N·m or N; infinite without a limit.
    pub torque: Vec<f64>,
    /// Fastest change of each joint's torque, N·m/s or N/s; infinite without a limit.
    pub rate: Vec<f64>,
    /// Time in which the torque grows to the model's after a start, and goes to zero after a stop, s.
    pub ramp: f64,
    /// Longest time that an old torque may stand, while the input is bad or no tick comes, s.
    pub hold: f64,
    /// Delay of the drive, s. The model is asked for the motion so much later, extrapolated by velocity and
    /// acceleration.
    pub drive_delay: f64,
    /// Whether the drive adds gravity's torque itself; limits are then of what is sent to it.
    pub drive_adds_gravity: bool,
}

impl Settings {
    /// Half a second: slow for a drive's torque loop, short for a person. A choice, not a measurement.
    pub const RAMP: f64 = 0.5;
    /// Time for which libfranka's robot continues without a command: 20 lost packets of 1 ms.
    pub const HOLD: f64 = 0.02;

    /// `torque` as limits, no limit of the rate, the times above.
    pub fn new(torque: Vec<f64>) -> Self {
        Self {
            rate: vec![f64::INFINITY; torque.len()],
            torque,
            ramp: Self::RAMP,
            hold: Self::HOLD,
            drive_delay: 0.0,
            drive_adds_gravity: false,
        }
    }

    pub(super) fn check(&self, joints: usize) -> Result<(), SettingsError> {
        for (what, list) in [("torque", &self.torque), ("rate", &self.rate)] {
            if list.len() != joints {
                return Err(SettingsError::Length {
                    what,
                    found: list.len(),
                    joints,
                });
            }
            // NaN is no limit.
            if let Some(joint) = list.iter().position(|limit| limit.is_nan() || *limit < 0.0) {
                return Err(SettingsError::Limit {
                    what,
                    joint: joint + 1,
                    value: list[joint],
                });
            }
        }
        let times = [
            ("ramp", self.ramp),
            ("hold", self.hold),
            ("drive_delay", self.drive_delay),
        ];
        for (what, time) in times {
            if !(time >= 0.0 && time.is_finite()) {
                return Err(SettingsError::Time { what, time });
            }
        }
        Ok(())
    }
}

/// Reason why settings are refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SettingsError {
    /// List with another number of values than joints.
    #[error("{found} limits of {what} for {joints} joints")]
    Length {
        /// Name of the list of limits.
        what: &'static str,
        /// Number of values that were given.
        found: usize,
        /// Number of joints of the robot.
        joints: usize,
    },
    /// A negative limit, or NaN.
    #[error("the limit of {what} of joint {joint} is {value}")]
    Limit {
        /// Name of the limit that is refused.
        what: &'static str,
        /// Number of its joint, from 1.
        joint: usize,
        /// Value of the limit as given, N·m (N) or that per s.
        value: f64,
    },
    /// A time that is negative or not finite.
    #[error("the time `{what}` is {time} s")]
    Time {
        /// Name of the setting for that time.
        what: &'static str,
        /// Value of the time as given, s.
        time: f64,
    },
}
