//! How late each joint's torque is recorded, where a search has said so: everything that the robot does is recorded late.

use super::delay::Late;
use ndarray::{Array1, ArrayView1};
use physics::robot::Robot;
use signal::Motion;

/// What the recorded torque went through.
#[derive(Clone, Debug)]
pub struct Channel {
    /// Of all joints.
    pub whole: Option<Late>,
    /// Of a joint beside that.
    pub own: Vec<Option<Late>>,
    /// The model as given, whose torque is not late.
    pub given: Robot,
}

impl Channel {
    /// A torque of one joint as all joints' lateness shows it.
    pub fn all(&self, motion: &Motion, x: ArrayView1<f64>) -> Array1<f64> {
        self.whole.map_or_else(|| x.to_owned(), |l| l.of(motion, x))
    }

    /// A torque of one joint as it is recorded.
    pub fn recorded(&self, motion: &Motion, joint: usize, x: ArrayView1<f64>) -> Array1<f64> {
        let shared = self.all(motion, x);
        match self.own[joint] {
            Some(late) => late.of(motion, shared.view()),
            None => shared,
        }
    }
}
