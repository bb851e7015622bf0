//! Choice of the preparation of recordings for a fit, from these recordings alone.

use crate::preparation::channel;
use crate::preparation::cutoff::{self, CutoffChoice, CutoffError};
use datasets::Recording;
use datasets::channel::Estimate95;
use datasets::prepare::PrepareOptions;
use physics::robot::Robot;

/// Options for preparing recordings of `robot`, the choice of the cut-off, and the torque's delay. The delay is
/// used where it is certain and lowers the error of rigid body and friction on rows left out. Then the cut-off
/// is chosen again: without the delay, too low a cut-off would explain a late torque best.
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
