//! The arm from the side, with the joints that the causes lie on.

use crate::catalogue::Effect;
use crate::diagnosis::Outcome;
use crate::tracks::Replayed;
use physics::dynamics::link_placements;
use physics::robot::JointKind;
use report::Section;
use report::figure::Chain;

/// Section with the arm at the mean pose of the held-out recording. Causes that the held-out recording does not confirm
/// are left out.
pub(super) fn section(outcome: &Outcome, heldout: &Replayed) -> Section {
    let robot = &outcome.given.robot;
    let rows = |j: usize| {
        heldout
            .whole
            .iter()
            .flat_map(move |t| t.q.column(j).to_vec())
    };
    let mean = |j: usize| rows(j).sum::<f64>() / rows(j).count().max(1) as f64;
    let pose: Vec<f64> = (0..robot.dof()).map(mean).collect();
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
    for cause in outcome.report.causes.iter().filter(|c| c.confirmed) {
        let words = Effect::ALL.iter().find(|e| e.name() == cause.effect);
        chain = chain.cause(words.map_or(cause.effect, |e| e.words()), &cause.joints);
    }
    Section::new("Where on the arm").figure(chain.draw(
        "Joints at the mean pose of the held-out recording; filled: those that a confirmed cause lies on.",
    ))
}
