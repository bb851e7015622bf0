//! How recordings are prepared for a fit, chosen from them alone.

use crate::preparation::channel;
use crate::preparation::cutoff::{self, CutoffChoice, CutoffError};
use datasets::Recording;
use datasets::channel::Estimate95;
use datasets::prepare::PrepareOptions;
use physics::robot::Robot;

/// How to prepare recordings of `robot`: the cut-off, how it was chosen, and the torque's delay where it is certain and
/// rigid body and friction are better with it on rows left out. The cut-off is chosen again with it: a torque
/// that is late is explained best by too slow a motion.
///
/// # Errors
/// Recordings that cannot be prepared, or not fitted.
pub fn choose(
    robot: &Robot,
    data: &[Recording],
    options: &PrepareOptions,
) -> Result<(PrepareOptions, Option<CutoffChoice>, Option<Estimate95>), CutoffError> {
    let (chosen, choice) = cutoff::choose(robot, data, options)?;
    let Some(delay) = channel::certain_delay(robot, data, options)? else {
        return Ok((chosen, choice, None));
    };
    let later = PrepareOptions {
        torque_delay: delay.value.unwrap_or(0.0),
        ..*options
    };
    let (late, late_choice) = cutoff::choose(robot, data, &later)?;
    Ok(if cutoff::explains_better(robot, data, &late, &chosen)? {
        (late, late_choice, Some(delay))
    } else {
        (chosen, choice, None)
    })
}
