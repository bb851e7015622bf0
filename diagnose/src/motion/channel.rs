//! Delay of each joint's recorded torque, once a search has found it. All torque of the robot is recorded late by it.

use super::delay::Late;
use ndarray::{Array1, ArrayView1};
use physics::robot::Robot;
use signal::Motion;

/// Delay of the torque channel.
#[derive(Clone, Debug)]
pub struct Channel {
    /// Delay of the torque that is common to all joints.
    pub whole: Option<Late>,
    /// Further delay of each single joint's torque.
    pub own: Vec<Option<Late>>,
    /// The model as given, with which the undelayed torque is computed.
    pub given: Robot,
}

impl Channel {
    /// A joint's torque with the delay common to all joints.
    pub fn all(&self, motion: &Motion, x: ArrayView1<f64>) -> Array1<f64> {
        self.whole.map_or_else(|| x.to_owned(), |l| l.of(motion, x))
    }

    /// A joint's torque with both delays, as it is recorded.
    pub fn recorded(&self, motion: &Motion, joint: usize, x: ArrayView1<f64>) -> Array1<f64> {
        let shared = self.all(motion, x);
        match self.own[joint] {
            Some(late) => late.of(motion, shared.view()),
            None => shared,
        }
    }
}
