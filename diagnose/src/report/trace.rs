//! Torque over time of the held-out recording, for plotters: measured, as given, corrected and what is left.

use crate::outcome::Outcome;
use datasets::write::Curves;

/// Curves of every joint that is judged, N·m (N); groups bear the joints' names.
pub(crate) fn curves(outcome: &Outcome) -> Curves<'_> {
    let frame = &outcome.frames.heldout;
    let motion = frame.samples();
    let (gap, left) = (&outcome.explanation.gap, &outcome.explanation.residual);
    let judged = |j: &usize| outcome.diagnosis.ladder[0].all.rmse[*j].is_some();
    let groups = (0..gap.ncols()).filter(judged).map(|j| {
        let measured = frame.tau.column(j);
        let curves = vec![
            ("measured", measured.to_vec()),
            ("as_given", (&measured - &gap.column(j)).to_vec()),
            ("corrected", (&measured - &left.column(j)).to_vec()),
            ("residual", left.column(j).to_vec()),
        ];
        (outcome.diagnosis.joints[j].clone(), curves)
    });
    Curves {
        topic: "torque",
        time: &motion.time,
        segments: &motion.segments,
        groups: groups.collect(),
    }
}
