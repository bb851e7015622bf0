//! Input control module: which columns the unit of a joint sees.

use serde::{Deserialize, Serialize};

/// Choice of a unit's input columns: the three that Wang et al. compare.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum InputSet {
    /// q, q̇, q̈ of the joint itself.
    Own,
    /// Motion q, q̇, q̈ of all joints.
    All,
    /// q, q̇, q̈ of the joint and of those further from the base: the torque of joint i does not depend on
    /// the dynamic parameters of the joints before it.
    Icm,
}

impl InputSet {
    /// Columns for `joint` of `joints` in a table [q₁ … q_N, q̇₁ … q̇_N, q̈₁ … q̈_N].
    pub fn columns(self, joint: usize, joints: usize) -> Vec<usize> {
        let seen = match self {
            Self::Own => joint..(joint + 1).min(joints),
            Self::All => 0..joints,
            Self::Icm => joint..joints,
        };
        (0..3)
            .flat_map(|block| seen.clone().map(move |j| block * joints + j))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joint_five_of_six_sees_joints_five_and_six() {
        assert_eq!(InputSet::Icm.columns(4, 6), [4, 5, 10, 11, 16, 17]);
        assert_eq!(InputSet::Own.columns(4, 6), [4, 10, 16]);
        assert_eq!(InputSet::All.columns(4, 6).len(), 18);
        assert_eq!(InputSet::Icm.columns(5, 6), InputSet::Own.columns(5, 6));
    }
}
