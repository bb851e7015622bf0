//! The torque channel of a recording: delay, scale, offset and sign, each with a 95 % interval.
//!
//! Motion is known up to noise, torque through a channel of unknown delay, gain and offset. Simple estimates
//! fail in three ways. A correlation peaks at the end of its search where nothing depends on the delay; noise
//! of q̈ biases a regression on the model's torque low; friction and an offset look like scale on a joint with
//! little load. Here the delay is that of the whole model (base parameters, friction and offset refitted at
//! each delay). Columns and torque pass one low-pass that removes the noise of q̈. The scale is fitted beside
//! friction, offset, rotor inertia and a robot whose inertials differ from the described ones by a tolerance
//! that the recording determines. Quantities that the recording does not determine are null.

mod delay;
mod fit;
mod rows;
pub(in crate::preparation) mod systems;

use crate::preparation::cutoff::{self, CutoffError};
use datasets::Recording;
use datasets::channel::{ChannelEstimate, Estimate95, JointChannel, SHORT_DELAY};
use datasets::prepare::{PrepareOptions, Prepared, prepare};
use fit::{Fitted, Found, Moments};
use physics::robot::Robot;
use systems::Systems;

/// Half width of a delay's interval beyond which it counts as undetermined, s: then it is as wide as the search.
const WIDEST_DELAY: f64 = 0.06;
/// Relative half width of a scale's interval beyond which not even its sign is determined.
const WIDEST_SCALE: f64 = 1.0;

/// Least part of a joint's described torque from the last link for which a scale may be due to a tool.
const CARRIED: f64 = 0.5;
/// Largest scale, recorded over described torque, that a tool can cause.
const TOOL: f64 = 30.0;

/// Estimates the channel of a recording of `robot`, whose described inertials are taken as nearly right.
/// `prepared` is the prepared `recording`. All null without torque.
///
/// Everything is fitted twice: with friction that may bend and build up after reversals, which gives the
/// estimate, and with viscous and Coulomb friction alone. The difference of the two is added to the interval,
/// since the friction of the robot at hand is not known.
pub fn estimate(robot: &Robot, recording: &Recording, prepared: &Prepared) -> ChannelEstimate {
    let n = robot.dof();
    let Some(systems) = Systems::new(robot, recording, prepared) else {
        return ChannelEstimate::unknown(n);
    };
    let start = delay::guess(&systems);
    let Some(rich) = fit::all(robot, &systems, start) else {
        return ChannelEstimate::unknown(n);
    };
    let plain = fit::all(robot, &systems.with_plain_friction(), start);
    let common = common(&rich);
    let other = plain.as_ref().map(|p| self::common(p).mean);
    let apart = other.map_or(0.0, |o| o - common.mean);
    let joints = (0..n).map(|j| {
        let other = plain.as_ref().and_then(|p| p.joints[j]);
        rich.joints[j].map_or(JointChannel::UNKNOWN, |found| {
            let carried = systems.joints[j].as_ref().map_or(1.0, |s| s.carried);
            of_joint(&rich, found, other, common.between, carried)
        })
    });
    ChannelEstimate {
        delay: common.estimate(apart),
        joints: joints.collect(),
    }
}

/// Delay of the torque of some recordings made with one channel, s, where it is certain: its interval excludes
/// delays that change no torque. `options` are those of the preparation.
///
/// # Errors
/// Recordings that cannot be prepared.
pub fn certain_delay(
    robot: &Robot,
    recordings: &[Recording],
    options: &PrepareOptions,
) -> Result<Option<Estimate95>, CutoffError> {
    let mut known = Vec::new();
    for recording in recordings {
        let prepared =
            prepare(recording, &cutoff::for_recording(options, recording)).map_err(|source| {
                CutoffError::Prepare {
                    file: recording.source.clone(),
                    source,
                }
            })?;
        let delay = estimate(robot, recording, &prepared).delay;
        if let (Some(value), Some([low, high])) = (delay.value, delay.interval) {
            let std = 0.25 * (high - low);
            known.push(Moments {
                value,
                variance: std * std,
            });
        }
    }
    let delay = match known.as_slice() {
        [] => return Ok(None),
        [one] => {
            let half = 2.0 * one.variance.sqrt();
            Estimate95::new(one.value, [one.value - half, one.value + half])
        }
        several => delay::common(several, several.len()).estimate(0.0),
    };
    Ok(Some(delay).filter(|d| d.lies_outside(SHORT_DELAY)))
}

/// Common delay of all joints whose delay is determined.
fn common(fitted: &Fitted) -> delay::Common {
    let known: Vec<Moments> = fitted
        .joints
        .iter()
        .flatten()
        .map(|f| f.delay)
        .filter(|d| fitted.half_width(d.variance) < WIDEST_DELAY)
        .collect();
    delay::common(&known, fitted.blocks)
}

/// Channel of one joint. `found` is its fit, `plain` the one with plain friction, `between` the variance of
/// delays between joints, `carried` the part of its described torque from the last link.
fn of_joint(
    fitted: &Fitted,
    found: Found,
    plain: Option<Found>,
    between: f64,
    carried: f64,
) -> JointChannel {
    let with = |of: fn(&Found) -> Moments, more: f64| {
        let here = of(&found);
        let apart = plain.as_ref().map_or(0.0, |p| of(p).value - here.value);
        let half = fitted.half_width(here.variance + more).hypot(apart);
        (here.value, half)
    };
    let interval = |(value, half): (f64, f64)| Estimate95::new(value, [value - half, value + half]);
    let delay = with(|f| f.delay, between);
    let scale = with(|f| f.scale, 0.0);
    let determined = fitted.half_width(found.delay.variance) < WIDEST_DELAY;
    // A tool that nobody described makes torque larger, as a scale would, on a joint that turns little else.
    let tool = carried > CARRIED && scale.0 - scale.1 > 1.0 && scale.0 < TOOL;
    let sized = scale.1 < WIDEST_SCALE * scale.0.abs() && !tool;
    JointChannel {
        delay: if determined {
            interval(delay)
        } else {
            Estimate95::NONE
        },
        scale: if sized {
            interval(scale)
        } else {
            Estimate95::NONE
        },
        offset: interval(with(|f| f.offset, 0.0)),
        sign: sized.then_some(if scale.0 > 0.0 { 1 } else { -1 }),
    }
}
