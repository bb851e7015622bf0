//! The arm from the side, with the joints that the causes lie on.

use crate::diagnosis::Outcome;
use crate::tracks::Replayed;
use model::page::arm;
use report::Section;

/// Section with the arm at the mean pose of the held-out recording. Causes that the held-out recording does not confirm
/// are left out. `words` turns an effect's name into plain words.
pub(super) fn section(
    outcome: &Outcome,
    heldout: &Replayed,
    words: fn(&str) -> &'static str,
) -> Section {
    let robot = &outcome.given.robot;
    let rows = |j: usize| {
        let all = heldout.whole.iter();
        all.flat_map(move |t| t.q.column(j).to_vec())
    };
    let mean = |j: usize| rows(j).sum::<f64>() / rows(j).count().max(1) as f64;
    let pose: Vec<f64> = (0..robot.dof()).map(mean).collect();
    let confirmed = outcome.report.causes.iter().filter(|c| c.confirmed);
    let causes = confirmed.map(|c| (words(c.effect), &c.joints[..]));
    arm(robot, &pose, causes)
}
