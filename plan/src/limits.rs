//! Limits of the robot over a whole plan.

use crate::motion::slowed;
use crate::torque::along;
use feedforward::Feedforward;
use ndarray::Array2;
use physics::robot::{Joint, Robot};
use signal::Motion;

/// Slowest speed that is tried, and the step between speeds, as parts of the plan's.
const SLOWEST: u32 = 5;
const STEP: f64 = 0.01;

/// A limit that a plan breaks.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("joint {joint:?} {what} {value:.4} {unit} at {time:.3} s, its limit is {limit:.4} {unit}")]
pub struct Broken {
    joint: String,
    what: &'static str,
    value: f64,
    limit: f64,
    unit: &'static str,
    time: f64,
    /// Whether another speed can mend it.
    pub by_speed: bool,
    /// Ratio of the value to its limit.
    excess: f64,
}

/// The limit that is broken most; positions first, for no speed mends them.
pub fn broken(robot: &Robot, motion: &Motion, torque: &Array2<f64>) -> Option<Broken> {
    let mut worst: Option<Broken> = None;
    for (j, joint) in robot.joints().iter().enumerate() {
        for row in 0..motion.time.len() {
            let values = [motion.q[[row, j]], motion.qd[[row, j]], torque[[row, j]]];
            for mut found in checks(joint, values).into_iter().flatten() {
                found.time = motion.time[row];
                let key = |b: &Broken| (!b.by_speed, b.excess);
                if worst.as_ref().is_none_or(|w| key(&found) > key(w)) {
                    worst = Some(found);
                }
            }
        }
    }
    worst
}

fn checks(joint: &Joint, [q, qd, tau]: [f64; 3]) -> [Option<Broken>; 3] {
    let limits = &joint.limits;
    let turns = joint.kind.is_rotation();
    let of = |what, value: f64, limit: f64, beyond: bool, units: [&'static str; 2], by_speed| {
        beyond.then(|| Broken {
            joint: joint.name.clone(),
            what,
            value,
            limit,
            unit: units[usize::from(!turns)],
            time: 0.0,
            by_speed,
            excess: if by_speed {
                value.abs() / limit
            } else {
                (value - limit).abs()
            },
        })
    };
    let end = if q < limits.lower {
        limits.lower
    } else {
        limits.upper
    };
    [
        of(
            "stands at",
            q,
            end,
            q < limits.lower || q > limits.upper,
            ["rad", "m"],
            false,
        ),
        of(
            "moves at",
            qd,
            limits.velocity,
            qd.abs() > limits.velocity,
            ["rad/s", "m/s"],
            true,
        ),
        of(
            "needs",
            tau,
            limits.effort,
            tau.abs() > limits.effort,
            ["N·m", "N"],
            true,
        ),
    ]
}

/// Advice for a broken limit, as a sentence: another speed, or another way.
pub fn advice(broken: &Broken, model: &mut Feedforward, motion: &Motion) -> String {
    if !broken.by_speed {
        return "No speed mends a position: plan another way, or in rad (m) where the plan is in degrees: a drive file says so.".into();
    }
    match largest(model, motion) {
        Some(factor) => format!("At {factor:.2} of its speed the plan keeps every limit."),
        None => format!(
            "Not even at {:.2} of its speed does the plan keep every limit: plan another way.",
            f64::from(SLOWEST) * STEP
        ),
    }
}

/// The largest part of its speed, in hundredths, at which the plan keeps every limit, by bisection between the slowest and the plan's
/// own.
fn largest(model: &mut Feedforward, motion: &Motion) -> Option<f64> {
    let (mut holds, mut breaks) = (None, (1.0 / STEP).round() as u32);
    let mut next = SLOWEST;
    loop {
        let factor = f64::from(next) * STEP;
        let slow = slowed(motion, factor, model.period());
        let (torque, _) = along(model, &slow);
        let robot = model.dynamics().robot();
        if broken(robot, &slow, &torque).is_none() {
            holds = Some(next);
        } else {
            breaks = next;
        }
        match holds {
            Some(low) if breaks - low > 1 => next = low.midpoint(breaks),
            _ => return holds.map(|low| f64::from(low) * STEP),
        }
    }
}
