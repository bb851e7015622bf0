//! The arm from the side, with the joints that the causes lie on.

use crate::outcome::Outcome;
use crate::report::words::name;
use model::page::arm;
use physics::robot::Robot;
use report::Section;

/// Section with the arm at the mean pose of the held-out recording. Causes that the held-out recording does not confirm
/// are left out.
pub(super) fn section(outcome: &Outcome, robot: &Robot) -> Section {
    let q = &outcome.frames.heldout.motion().q;
    let means = q.columns().into_iter().map(|c| c.mean().unwrap_or(0.0));
    let confirmed = outcome.diagnosis.causes.iter().filter(|c| c.confirmed);
    let causes = confirmed.map(|c| (name(c.effect), &c.joints[..]));
    arm(robot, &means.collect::<Vec<f64>>(), causes)
}
