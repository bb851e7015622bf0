//! Recording under examination, and the parts of a complaint's text.

use super::evidence::{Evidence, Fitted};
use datasets::Recording;
use datasets::check::{Ailment, Complaint, Severity};
use physics::robot::Robot;

/// Recording under examination, with its robot and the evidence on each joint's torque.
pub(super) struct Patient<'a> {
    /// Robot as described.
    pub robot: &'a Robot,
    /// Recording whose torque is examined.
    pub recording: &'a Recording,
    /// Evidence on the torque of each joint.
    pub joints: &'a [Evidence],
}

impl Patient<'_> {
    /// Joints with a model fitted to their torque, with their indices.
    pub fn fitted(&self) -> impl Iterator<Item = (usize, &Evidence, &Fitted)> {
        let all = self.joints.iter().enumerate();
        all.filter_map(|(j, e)| Some((j, e, e.fitted.as_ref()?)))
    }

    /// Indices of all joints.
    pub fn all(&self) -> Vec<usize> {
        (0..self.joints.len()).collect()
    }

    /// Names of these joints, joined; "all joints" where they are all.
    pub fn names(&self, joints: &[usize]) -> String {
        if joints.len() == self.joints.len() && joints.len() > 1 {
            return "all joints".to_owned();
        }
        let name = |&j: &usize| self.robot.joints()[j].name.as_str();
        joints.iter().map(name).collect::<Vec<_>>().join(", ")
    }
}

/// Complaint without lines for the drive file. The texts say what was seen, what it means, and what to do.
pub(super) fn complaint(
    ailment: Ailment,
    severity: Severity,
    joints: Vec<usize>,
    [seen, means, advice]: [String; 3],
) -> Complaint {
    Complaint {
        ailment,
        severity,
        joints,
        seen,
        means,
        drive: None,
        advice,
    }
}

/// Line of a drive file with one value per joint.
pub(super) fn list(key: &str, values: &[f64]) -> String {
    let each: Vec<String> = values.iter().map(|v| short(*v)).collect();
    format!("{key} = [{}]", each.join(", "))
}

/// Number as text, with four significant digits.
pub(super) fn short(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return "0".to_owned();
    }
    let digits = 3 - value.abs().log10().floor() as i32;
    let text = format!("{value:.*}", digits.clamp(0, 12) as usize);
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}
