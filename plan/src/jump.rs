//! Jumps of a plan's positions.

use datasets::Recording;
use physics::robot::Robot;

/// Samples on either side of a step that it is compared with.
const NEAR: usize = 10;

/// Times by which a step has to differ from its neighbours more than these do from each other.
const SUDDEN: f64 = 10.0;

/// A step of position that the steps around it do not lead up to.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("joint {joint:?} jumps by {by:.4} {unit} from {from} to {to} s, between rows {row} and {}", .row + 1)]
pub struct Jump {
    joint: String,
    /// Change of position that is left when the mean of the steps before and after is taken off, in the joint's convention.
    by: f64,
    unit: &'static str,
    from: f64,
    to: f64,
    /// Row before the jump, from 1.
    row: usize,
}

/// The largest jump of a plan.
///
/// A jump makes one step differ from the steps before and after by nearly the same; a speed that begins or ends differs on one
/// side. All other steps around it change slowly against that.
pub fn largest(plan: &Recording, robot: &Robot) -> Option<Jump> {
    let mut found: Option<Jump> = None;
    for segment in plan.segments() {
        for (j, joint) in robot.joints().iter().enumerate() {
            let values: Vec<f64> = segment.clone().map(|row| plan.q[[row, j]]).collect();
            let Some((row, by)) = jump(&values) else {
                continue;
            };
            if found.as_ref().is_none_or(|f| by.abs() > f.by.abs()) {
                let row = segment.start + row;
                found = Some(Jump {
                    joint: joint.name.clone(),
                    by,
                    unit: if joint.kind.is_rotation() { "rad" } else { "m" },
                    from: plan.time[row],
                    to: plan.time[row + 1],
                    row: row + 1,
                });
            }
        }
    }
    found
}

/// The largest jump of one column: the index before it, and its size.
fn jump(values: &[f64]) -> Option<(usize, f64)> {
    let steps: Vec<f64> = values.windows(2).map(|w| w[1] - w[0]).collect();
    // Element k: how much step k + 1 differs from step k.
    let turns: Vec<f64> = steps.windows(2).map(|w| w[1] - w[0]).collect();
    let (before, after) = (turns.get(..turns.len().checked_sub(1)?)?, &turns[1..]);
    let mut largest: Option<(usize, f64)> = None;
    for (k, (into, out)) in before.iter().zip(after).enumerate() {
        let by = 0.5 * (into - out);
        let near = &turns[k.saturating_sub(NEAR)..(k + 2 + NEAR).min(turns.len())];
        let own = k - k.saturating_sub(NEAR);
        let others = near.iter().enumerate();
        let others = others.filter(|(i, _)| *i != own && *i != own + 1);
        let slow = others.fold(0.0_f64, |most, (_, turn)| most.max(turn.abs()));
        let sudden = into.abs().min(out.abs()) > SUDDEN * slow;
        if into * out < 0.0 && sudden && largest.is_none_or(|(_, most)| by.abs() > most.abs()) {
            largest = Some((k + 1, by));
        }
    }
    largest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_within_a_motion() {
        let smooth = |k: usize| (0.02 * k as f64).sin();
        let mut values: Vec<f64> = (0..200).map(smooth).collect();
        assert_eq!(jump(&values), None);
        values.iter_mut().skip(120).for_each(|v| *v -= 0.3);
        let (row, by) = jump(&values).unwrap();
        assert!(row == 119 && (by + 0.3).abs() < 1e-3, "{row} {by}");
    }

    #[test]
    fn speeds_that_begin_and_fast_motions_are_none() {
        let ramp: Vec<f64> = (0..60).map(|k| f64::from(k).max(20.0) * 0.1).collect();
        assert_eq!(jump(&ramp), None);
        let fast: Vec<f64> = (0..60).map(|k| 2.0 * (0.9 * f64::from(k)).sin()).collect();
        assert_eq!(jump(&fast), None);
        assert_eq!(jump(&[0.0, 1.0]), None);
    }
}
