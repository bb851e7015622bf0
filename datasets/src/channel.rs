//! Estimates of the channel that a recorded torque came through: delay, and factors joint by joint.

use serde::{Deserialize, Serialize};

/// A value with its interval of 95 %; both null where the recording does not determine it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Estimate95 {
    /// Best estimate of the value, in its own unit.
    pub value: Option<f64>,
    /// Lower and upper end of the 95 % interval.
    pub interval: Option<[f64; 2]>,
}

impl Estimate95 {
    /// An estimate that is not determined.
    pub const NONE: Self = Self {
        value: None,
        interval: None,
    };

    /// A value with its interval; not determined where either is not finite.
    pub fn new(value: f64, interval: [f64; 2]) -> Self {
        if value.is_finite() && interval.iter().all(|v| v.is_finite()) {
            Self {
                value: Some(value),
                interval: Some(interval),
            }
        } else {
            Self::NONE
        }
    }

    /// Whether the interval is there and lies wholly outside `[low, high]`.
    pub fn lies_outside(&self, [low, high]: [f64; 2]) -> bool {
        self.interval.is_some_and(|[a, b]| b < low || a > high)
    }
}

/// The channel of one joint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct JointChannel {
    /// Delay of the recorded torque after the motion, s.
    pub delay: Estimate95,
    /// Ratio of the recorded torque to that of the described robot.
    pub scale: Estimate95,
    /// Offset: recorded torque less that of the described robot with its friction, N·m (N).
    pub offset: Estimate95,
    /// Sign of the ratio `scale`: 1 or −1 where its whole interval is on one side of zero.
    pub sign: Option<i8>,
}

impl JointChannel {
    /// A joint of whose channel nothing is determined.
    pub const UNKNOWN: Self = Self {
        delay: Estimate95::NONE,
        scale: Estimate95::NONE,
        offset: Estimate95::NONE,
        sign: None,
    };
}

/// The torque channel of a recording.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ChannelEstimate {
    /// Delay of the recorded torque after the motion, common to all joints, s.
    pub delay: Estimate95,
    /// Channel of each joint, base first.
    pub joints: Vec<JointChannel>,
}

/// Negligible delay, s: an interval that lies wholly within these limits changes no torque measurably. Such a
/// delay is written to the file but not mentioned to the user.
pub const SHORT_DELAY: [f64; 2] = [-2e-3, 2e-3];

impl ChannelEstimate {
    /// Estimates for `joints` joints of which nothing is determined.
    pub fn unknown(joints: usize) -> Self {
        Self {
            delay: Estimate95::NONE,
            joints: vec![JointChannel::UNKNOWN; joints],
        }
    }
}
