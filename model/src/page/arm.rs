//! The arm from the side, with the joints that the causes lie on.

use physics::dynamics::link_placements;
use physics::robot::{JointKind, Robot};
use report::Section;
use report::figure::Chain;

/// Section with the arm at `pose`, the mean one of the held-out recording, rad (m). `causes` are the words and the joint names of each
/// confirmed cause.
pub fn arm<'a>(
    robot: &Robot,
    pose: &[f64],
    causes: impl IntoIterator<Item = (impl Into<String>, &'a [String])>,
) -> Section {
    let up = -robot.gravity();
    let mut chain = Chain::new("The arm from the side", [up.x, up.y, up.z]);
    for (joint, place) in robot.joints().iter().zip(link_placements(robot, pose)) {
        let p = place.translation;
        let slides = joint.kind == JointKind::Prismatic;
        chain = chain.joint(&joint.name, [p.x, p.y, p.z], slides);
    }
    for (words, joints) in causes {
        chain = chain.cause(words, joints);
    }
    Section::new("Where on the arm").figure(chain.draw(
        "Joints at the mean pose of the held-out recording; filled: those that a confirmed cause lies on.",
    ))
}
