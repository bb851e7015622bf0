//! Torque over time: measured, of the model as given, and of the model with its causes.

use super::maps::units;
use crate::outcome::Outcome;
use report::Section;
use report::figure::{Ink, Panel, Plot};
use std::ops::Range;

/// Number of joints whose curves are shown unfolded, those with the largest gap.
const SHOWN: usize = 3;

/// Section with torque curves of the held-out recording, joint by joint.
pub(super) fn section(outcome: &Outcome) -> Section {
    let frame = &outcome.frames.heldout;
    let motion = frame.samples();
    let start = motion.time.first().copied().unwrap_or(0.0);
    let time: Vec<f64> = motion.time.iter().map(|t| t - start).collect();
    let rows: Vec<Range<usize>> = motion.segments.clone();
    let (gap, left) = (&outcome.explanation.gap, &outcome.explanation.residual);
    let size = |j: usize| outcome.diagnosis.ladder[0].all.nrmse[j].unwrap_or(0.0);
    let mut order: Vec<usize> = (0..gap.ncols()).collect();
    order.sort_by(|a, b| size(*b).total_cmp(&size(*a)));
    let figure = |j: usize| {
        let measured = frame.tau.column(j);
        let [_, _, force] = units(outcome, j);
        let curve =
            |panel: Panel, name, ink, y: Vec<f64>| panel.segments(name, ink, &time, &y, &rows);
        let torque = Panel::new(format!("torque / {force}"));
        let torque = curve(
            torque,
            "as given",
            Ink::Muted,
            (&measured - &gap.column(j)).to_vec(),
        );
        let torque = curve(
            torque,
            "explained",
            Ink::Predicted,
            (&measured - &left.column(j)).to_vec(),
        );
        let torque = curve(torque, "measured", Ink::Measured, measured.to_vec());
        let error = Panel::new(format!("error / {force}")).height(110.0);
        let error = curve(error, "as given", Ink::Muted, gap.column(j).to_vec());
        let error = curve(error, "explained", Ink::Predicted, left.column(j).to_vec());
        Plot::new(outcome.diagnosis.joints[j].clone(), "time / s")
            .zoomable()
            .panel(torque)
            .panel(error)
            .draw("")
    };
    let (first, others) = order.split_at(SHOWN.min(order.len()));
    let section = Section::new("Torque over time").paragraph(
        "The held-out recording. Drag over a curve to see a part of it, with Shift to move along, and double-click to see all again; the \
         joints move together.",
    );
    let drawn = |section: Section, joints: &[usize]| {
        joints.iter().fold(section, |s, &j| s.figure(figure(j)))
    };
    let section = drawn(section, first);
    if others.is_empty() {
        return section;
    }
    section.details(drawn(Section::new("Joints with a smaller gap"), others))
}
