//! The page of a closed loop.

use super::experiment::{Demonstration, Experiment};
use super::tables::{compared, errors};
use report::figure::{Ink, Panel, Plot};
use report::{Figure, Page, Section};

/// Tables and errors over time.
pub fn page(demonstration: &Demonstration) -> Page {
    let mut page = Page::new("Closed loop")
        .subtitle("Simulated robots under a drive's cascade, with and without a torque model.");
    if let Some(table) = compared(demonstration) {
        page = page.section(Section::new("Published figures").table(table));
    }
    for experiment in &demonstration.experiments {
        let title = format!("{}, {}", experiment.robot, experiment.motion);
        let mut section = Section::new(title).table(errors(experiment));
        section = section.paragraph(loop_words(experiment));
        for figure in figures(experiment) {
            section = section.figure(figure);
        }
        page = page.section(section);
    }
    page.section(Section::new("What the figures depend on").list(demonstration.notes.clone()))
}

fn loop_words(experiment: &Experiment) -> String {
    let s = &experiment.settings;
    format!(
        "Plant and drive every {:.0} µs, set-points and additive torque every {:.0} ms; the drive acts on a set-point {} cycles after its \
         time, the additive torque is held back {} cycles. Velocity loop: gain inertia · ω, crossover {} Hz, integral and position loop at \
         ω/4, inertia by the model where the motion starts; the same in every mode.",
        1e6 * s.step,
        1e3 * s.period(),
        s.command_delay,
        s.additive_delay,
        s.crossover_hz
    )
}

/// The joint of the largest error without a model, and the tool.
fn figures(experiment: &Experiment) -> Vec<Figure> {
    let Some(first) = experiment.outcomes.first() else {
        return Vec::new();
    };
    let size = |j: &usize| first.tracking.joints[*j].rms;
    let worst = (0..experiment.joints.len()).max_by(|a, b| size(a).total_cmp(&size(b)));
    let j = worst.unwrap_or(0);
    let mut plots = vec![(
        format!("Position error of {}", experiment.joints[j]),
        Panel::new(format!("error / m{}", experiment.units[j])),
    )];
    if !first.trace.tool.is_empty() {
        plots.push((
            "Distance of the tool".to_owned(),
            Panel::new("distance / mm"),
        ));
    }
    let mut figures = Vec::new();
    for (k, (title, mut panel)) in plots.into_iter().enumerate() {
        for (i, outcome) in experiment.outcomes.iter().enumerate() {
            let trace = &outcome.trace;
            let y: Vec<f64> = if k == 0 {
                trace
                    .error
                    .iter()
                    .skip(j)
                    .step_by(trace.dof)
                    .map(|e| 1e3 * e)
                    .collect()
            } else {
                trace.tool.iter().map(|d| 1e3 * d).collect()
            };
            panel = panel.line(outcome.mode.words(), Ink::Series(i), &trace.time, &y);
        }
        let caption = format!(
            "The motion ends at {:.3} s; what follows is settling.",
            first.trace.duration
        );
        figures.push(
            Plot::new(title, "time / s")
                .panel(panel.height(300.0))
                .draw(caption),
        );
    }
    figures
}
