//! Size of the state space.

use serde::{Deserialize, Serialize};

/// Settings of [`super::LinearForward::fit`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ForwardSettings {
    /// Number of states. The benchmark paper chooses two per joint: 12.
    pub order: usize,
    /// Past and future samples of the subspace projection. Default 20: 2 s of the benchmark, several
    /// times what a joint needs to follow its torque.
    pub horizon: usize,
    /// Whether torque acts on position within the same sample (D ≠ 0). Default false, as in the KR300 benchmark paper:
    /// a mass does not jump.
    pub feedthrough: bool,
}

impl ForwardSettings {
    /// Settings of the KR300 benchmark paper for a robot with this many joints.
    pub fn for_joints(joints: usize) -> Self {
        Self {
            order: 2 * joints,
            horizon: 20,
            feedthrough: false,
        }
    }
}
