//! Limits for drives that are given none, so that a limit can be sought there, too.

use crate::arm::Arm;
use crate::given::Given;
use crate::parameter::Parameter;
use crate::simulate::{Unstable, reached};
use crate::tracks::Replayed;

/// Supposed limit of a drive without one, as a multiple of the largest torque that it reaches as given. It stands for "never
/// met": whatever else is fitted, the torque that the recorded motion takes stays of its size.
const NEVER_MET: f64 = 10.0;

impl Given {
    /// Simulator in which drives without a limit have a supposed one, far above what they reach in the recorded motion.
    ///
    /// # Errors
    /// Drive that is unstable.
    pub(crate) fn limited(&self, replayed: &Replayed) -> Result<Self, Unstable> {
        let reached = reached(&self.arm, &replayed.blocks, self.limit())?;
        let limit = |j: usize| Parameter::new(self.limit(), j);
        let mut out = self.clone();
        // A drive that never gives a torque gets no limit.
        let none = |j: usize| self.arm.get(limit(j)).is_infinite() && reached[j] > 0.0;
        out.unlimited = (0..self.arm.dof()).map(none).collect();
        let supposed = (0..self.arm.dof()).filter(|j| out.unlimited[*j]);
        let values: Vec<(Parameter, f64)> = supposed
            .map(|j| (limit(j), NEVER_MET * reached[j]))
            .collect();
        // Limits change no rigid body.
        let _ = out.arm.set(&values);
        Ok(out)
    }

    /// Whether the joint's drive is given no limit.
    pub(crate) fn is_unlimited(&self, joint: usize) -> bool {
        self.unlimited.get(joint).copied().unwrap_or(false)
    }

    /// Arm without the supposed limits that were not fitted.
    pub(crate) fn released(&self, arm: &Arm) -> Arm {
        let mut out = arm.clone();
        let limits = (0..arm.dof()).map(|j| Parameter::new(self.limit(), j));
        let supposed =
            limits.filter(|p| self.is_unlimited(p.joint) && arm.get(*p) == self.arm.get(*p));
        let values: Vec<(Parameter, f64)> = supposed.map(|p| (p, f64::INFINITY)).collect();
        // Limits change no rigid body.
        let _ = out.set(&values);
        out
    }
}
