//! What of a recording explains a failed identification, or makes a successful one doubtful: the manual's reasons (its
//! "review of the possible reasons" and "how to assess"), each judged from the data.

mod factor;
mod model;
mod motion;
mod reason;
mod torque;

pub use reason::{Kind, Reason};

use crate::MachineError;
use crate::identification::Identified;
use datasets::Recording;

/// The reasons that hold, those about a wrong description first.
///
/// # Errors
/// The equations cannot be solved.
pub fn find(identified: &Identified, recording: &Recording) -> Result<Vec<Reason>, MachineError> {
    let mut found: Vec<Reason> = model::wrong_model(identified)?.into_iter().collect();
    if found.is_empty() {
        found.extend(factor::torque_factor(identified)?);
    }
    for axis in 0..identified.machine.dof() {
        found.extend(torque::saturated(identified, axis));
        found.extend(torque::noise(identified, axis));
        found.extend(motion::of_axis(identified, recording, axis));
    }
    Ok(found)
}
