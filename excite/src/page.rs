//! HTML page of a design.

use crate::judged::torques;
use crate::motion::Labelled;
use crate::screen::{COLLISIONS, conditions, coverage, effects, headline, parameters};
use crate::summary::Summary;
use ndarray::Array2;
use physics::robot::Robot;
use report::figure::{Ink, Panel, Plot};
use report::{Figure, KeyFigure, Page, Section, Tone};

/// Number of trajectories that are drawn.
const DRAWN: usize = 6;

/// HTML page of a designed motion.
pub fn page(summary: &Summary, robot: &Robot, labelled: &Labelled) -> Page {
    let c = &summary.conditions;
    let mut page = Page::new(format!("Motion of {}", summary.robot))
        .subtitle(headline(summary))
        .key_figure(KeyFigure::new("cond(Y)", format!("{:.0}", c.plain.whole)))
        .key_figure(
            KeyFigure::new("cond(Y*)", format!("{:.0}", c.weighted.whole))
                .note("rows over their noise"),
        );
    if let Some(plan) = &summary.plan {
        let shown = plan.parameters.iter().filter(|p| p.shows).count();
        let all = plan.parameters.len();
        page = page.key_figure(
            KeyFigure::new("parameters that show", format!("{shown} of {all}"))
                .note("told from zero at 95 %"),
        );
    }
    let mut limits = Section::new("Limits")
        .callout(Tone::Warning, "Collisions", COLLISIONS)
        .paragraph("Largest values over their limits; torque of the robot as described, over what its description allows.")
        .table(coverage(&summary.joints))
        .table(conditions(summary));
    if !summary.notes.is_empty() {
        limits = limits.list(summary.notes.iter().cloned());
    }
    page = page.section(limits);
    let tau = torques(robot, &labelled.motion);
    let mut curves = Section::new("Trajectories");
    if labelled.labels.len() > DRAWN {
        curves = curves.paragraph(format!("The first {DRAWN} of {}.", labelled.labels.len()));
    }
    for k in 0..labelled.labels.len().min(DRAWN) {
        curves = curves.figure(figure(robot, labelled, &tau, k));
    }
    page = page.section(curves);
    if let Some(plan) = &summary.plan {
        page = page
            .section(
                Section::new("Base parameters")
                    .paragraph("Standard deviations by the information of the motion, white torque noise of the size given in each sample; a parameter shows from 1.96 of them.")
                    .table(parameters(plan)),
            )
            .section(
                Section::new("Effects")
                    .paragraph("Size from which the diagnosis would accept each effect, by joint, everything else being as described. Missing: no size up to three times the joint's torque.")
                    .table(effects(plan, summary.joints.len()))
                    .list(plan.not_judged.iter().map(|n| format!("{}: {}", n.effect, n.reason))),
            );
    }
    page.footer(format!("excite {}", env!("CARGO_PKG_VERSION")))
}

/// One trajectory over time.
fn figure(robot: &Robot, labelled: &Labelled, tau: &Array2<f64>, k: usize) -> Figure {
    let rows = labelled.motion.segments[k].clone();
    let motion = &labelled.motion;
    let time = &motion.time[rows.clone()];
    let panel = |name: &str, table: &Array2<f64>| {
        let joints = robot.joints().iter().enumerate();
        joints.fold(Panel::new(name).height(150.0), |panel, (j, joint)| {
            let column = table.column(j);
            let values: Vec<f64> = rows.clone().map(|i| column[i]).collect();
            panel.line(&joint.name, Ink::Series(j), time, &values)
        })
    };
    Plot::new(format!("Trajectory {}", labelled.labels[k]), "time / s")
        .panel(panel("position / rad", &motion.q))
        .panel(panel("velocity / rad/s", &motion.qd))
        .panel(panel("acceleration / rad/s²", &motion.qdd))
        .panel(panel("torque / N·m", tau))
        .draw("Position, velocity, acceleration, and the torque of the robot as described; m and N for sliding joints.")
}
