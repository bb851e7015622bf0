//! The arm from the side, with the joints that the causes lie on.

use crate::outcome::Outcome;
use crate::report::words::name;
use physics::dynamics::link_placements;
use physics::robot::{JointKind, Robot};
use report::Section;
use report::figure::Chain;

/// Section with the arm at the mean pose of the held-out recording. Causes that the held-out recording does not confirm
/// are left out.
pub(super) fn section(outcome: &Outcome, robot: &Robot) -> Section {
    let q = &outcome.frames.heldout.motion().q;
    let pose: Vec<f64> = q
        .columns()
        .into_iter()
        .map(|c| c.mean().unwrap_or(0.0))
        .collect();
    let up = -robot.gravity();
    let mut chain = Chain::new("The arm from the side", [up.x, up.y, up.z]);
    for (joint, place) in robot.joints().iter().zip(link_placements(robot, &pose)) {
        let p = place.translation;
        chain = chain.joint(
            &joint.name,
            [p.x, p.y, p.z],
            joint.kind == JointKind::Prismatic,
        );
    }
    for cause in outcome.diagnosis.causes.iter().filter(|c| c.confirmed) {
        chain = chain.cause(name(cause.effect), &cause.joints);
    }
    Section::new("Where on the arm").figure(chain.draw(
        "Joints at the mean pose of the held-out recording; filled: those that a confirmed cause lies on.",
    ))
}
