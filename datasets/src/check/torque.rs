//! What of a torque channel is worth a sentence.

use super::finding::{Finding, Kind, Severity};
use crate::channel::{ChannelEstimate, JointChannel, SHORT_DELAY};

/// Scales that errors of a described robot and of a nominal torque constant explain. An interval that reaches into this
/// range makes no finding.
const USUAL_SCALE: [f64; 2] = [0.8, 1.25];
/// Scales beyond which the torque's unit is in doubt.
const UNIT_SCALE: [f64; 2] = [1.0 / 3.0, 3.0];

impl ChannelEstimate {
    /// Findings on the channel. `names` are the joints', base first.
    pub fn findings(&self, names: &[String]) -> Vec<Finding> {
        let mut found = self.scale_findings(names);
        found.extend(self.delay_finding());
        found
    }

    fn delay_finding(&self) -> Option<Finding> {
        let (value, [low, high]) = (self.delay.value?, self.delay.interval?);
        let outside = self.delay.lies_outside(SHORT_DELAY);
        outside.then(|| {
            let (near, far) = (low.abs().min(high.abs()), low.abs().max(high.abs()));
            let message = format!(
                "the torque is {:.1} ms ({:.1} to {:.1}) {} than the motion: a filter or another clock; fit and score allow \
                 for it, a controller needs no such shift",
                1e3 * value.abs(),
                1e3 * near,
                1e3 * far,
                if value > 0.0 { "later" } else { "earlier" }
            );
            finding(Kind::TorqueShift, Severity::Note, None, value, message)
        })
    }

    /// Scales, judged joint by joint; where most joints are far from one, a single finding speaks for all.
    fn scale_findings(&self, names: &[String]) -> Vec<Finding> {
        let remedy = "give gear ratios and torque constants by --drive, or multiply the column";
        let far: Vec<bool> = self
            .joints
            .iter()
            .map(|j| j.scale.lies_outside(UNIT_SCALE))
            .collect();
        let known: Vec<f64> = self.joints.iter().filter_map(|j| j.scale.value).collect();
        let text = |j: &JointChannel| {
            j.scale.value.zip(j.scale.interval).map_or_else(
                || "unknown".to_owned(),
                |(v, [a, b])| format!("{v:.3} ({a:.3} to {b:.3})"),
            )
        };
        let count = far.iter().filter(|f| **f).count();
        if count > 1 && 2 * count > known.len() {
            let list: Vec<String> = self.joints.iter().map(text).collect();
            let middle = signal::quantile::median(known).unwrap_or(f64::NAN);
            let turned = UNIT_SCALE[0] <= -middle && -middle <= UNIT_SCALE[1];
            let guess = if turned {
                "torque of the opposite sign"
            } else if middle.abs() < 1.0 {
                "motor current in A or motor-side torque, not joint torque in N·m"
            } else {
                "another unit than N·m"
            };
            let message = format!(
                "the recorded torque is {} times what the model expects, joint by joint: it looks like {guess}; {remedy}",
                list.join(", ")
            );
            return vec![finding(
                Kind::TorqueScale,
                Severity::Severe,
                None,
                middle,
                message,
            )];
        }
        let each = self.joints.iter().zip(&far).enumerate();
        each.filter_map(|(j, (joint, far))| {
            let value = joint.scale.value?;
            if !joint.scale.lies_outside(USUAL_SCALE) {
                return None;
            }
            let name = names.get(j).map_or("a joint", String::as_str);
            let doubt = if joint.sign == Some(-1) {
                "check its sign"
            } else {
                "check gear ratio, torque constant and unit, or the described masses"
            };
            let severity = if *far {
                Severity::Severe
            } else {
                Severity::Warning
            };
            let message = format!(
                "{name}: the torque is {} times what the model expects; {doubt}; {remedy}",
                text(joint)
            );
            Some(finding(
                Kind::TorqueScale,
                severity,
                Some(j),
                value,
                message,
            ))
        })
        .collect()
    }
}

fn finding(
    kind: Kind,
    severity: Severity,
    joint: Option<usize>,
    value: f64,
    message: String,
) -> Finding {
    Finding {
        kind,
        severity,
        joint,
        row: None,
        value,
        parameters: Vec::new(),
        message,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::channel::Estimate95;

    fn channel(delay: [f64; 2], scales: &[[f64; 2]]) -> ChannelEstimate {
        let middle = |[a, b]: [f64; 2]| Estimate95::new(0.5 * (a + b), [a, b]);
        ChannelEstimate {
            delay: middle(delay),
            joints: scales
                .iter()
                .map(|s| JointChannel {
                    scale: middle(*s),
                    sign: Some(if s[0] > 0.0 { 1 } else { -1 }),
                    ..JointChannel::UNKNOWN
                })
                .collect(),
        }
    }

    #[test]
    fn words_only_where_the_interval_excludes_what_is_usual() {
        let names: Vec<String> = ["a", "b"].map(String::from).to_vec();
        let said = |c: ChannelEstimate| -> Vec<(Kind, Severity)> {
            let found = c.findings(&names);
            found.iter().map(|f| (f.kind, f.severity)).collect()
        };
        assert!(said(channel([-0.01, 0.03], &[[0.2, 2.0], [0.9, 1.2]])).is_empty());
        assert!(said(channel([0.0002, 0.0004], &[[0.99, 1.01], [0.3, 0.9]])).is_empty());
        assert_eq!(
            said(channel([0.018, 0.021], &[[0.55, 0.63], [0.9, 1.2]])),
            [
                (Kind::TorqueScale, Severity::Warning),
                (Kind::TorqueShift, Severity::Note)
            ]
        );
        let current = channel([-0.01, 0.01], &[[0.05, 0.08], [0.06, 0.07]]).findings(&names);
        assert_eq!(current.len(), 1);
        assert_eq!(
            (current[0].joint, current[0].severity),
            (None, Severity::Severe)
        );
        assert!(current[0].message.contains("motor current"), "{current:?}");
        let turned = channel([-0.01, 0.01], &[[-1.05, -0.95], [-1.01, -0.9]]).findings(&names);
        assert!(turned[0].message.contains("opposite sign"), "{turned:?}");
        assert!(ChannelEstimate::unknown(2).findings(&names).is_empty());
    }
}
