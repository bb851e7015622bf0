//! The report as one self-contained HTML page.

mod causes;
mod chain;
mod data;
mod maps;
mod torque;

use crate::advice::patch::Patch;
use crate::outcome::Outcome;
use crate::report::words::{closes, corrected, joined, lines, name, next, worst_findings};
use crate::schema::{Diagnosis, Step, Verdict};
use physics::robot::Robot;
use report::figure::{Bars, Ink, Waterfall};
use report::{Cell, Column, KeyFigure, Page, Section, Table, Tone};
use std::cmp::Ordering;
use std::path::PathBuf;

/// Renders the page. `robot` is the model as given; `inputs` names it and the recordings; `patch` holds the changes of the model by
/// the causes, and `patched` are the paths of its files, the description first.
pub fn render(
    outcome: &Outcome,
    robot: &Robot,
    inputs: &[(String, String)],
    patch: &Patch,
    patched: &[PathBuf],
) -> String {
    let d = &outcome.diagnosis;
    let [title, subtitle] = match d.compared {
        None => [
            "Where the simulator and the robot part",
            "Torque of a simulator's model against a recording of the real robot; every figure is measured on the held-out recording.",
        ],
        Some(_) => [
            "What has changed on the robot",
            "Torque of a later recording against the robot's own earlier ones; every figure is measured on what was held out of the later one.",
        ],
    };
    let mut page = Page::new(title)
        .subtitle(subtitle)
        .key_figure(KeyFigure::new("verdict", d.verdict.name().replace('_', " ")).tone(tone(d)));
    let nrmse = |at: Option<usize>| {
        let mean = at.and_then(|n| d.ladder[n].all.mean_nrmse);
        mean.map_or("–".to_owned(), |m| format!("{m:.3}"))
    };
    let last = d
        .ladder
        .iter()
        .rposition(|s| s.step != "learned" && s.step != "repeatability");
    let note = |at: Option<usize>| {
        let most = at.and_then(|n| largest(outcome, n));
        most.map_or("mean NRMSE".to_owned(), |m| format!("mean NRMSE; {m}"))
    };
    page = page
        .key_figure(KeyFigure::new("error as given", nrmse(Some(0))).note(note(Some(0))))
        .key_figure(KeyFigure::new("error explained", nrmse(last)).note(note(last)));
    if let Some(first) = d.causes.iter().find(|c| c.confirmed) {
        page = page.key_figure(
            KeyFigure::new("biggest cause", name(first.effect))
                .note(format!("on {}", first.joints.join(", "))),
        );
    }
    page.section(words(d, patch, patched))
        .section(chain::section(outcome, robot))
        .section(ladder(outcome))
        .section(torque::section(outcome))
        .section(causes::section(outcome))
        .section(causes::simulators(d, patch, patched))
        .section(motion(d))
        .section(maps::places(d))
        .section(maps::maps(outcome))
        .section(data::left(d))
        .section(data::recordings(d))
        .section(data::provenance(inputs))
        .footer(format!(
            "Made by residyn {} (schema {}).",
            env!("CARGO_PKG_VERSION"),
            d.schema
        ))
        .render()
}

/// Error of a step of the ladder on the joint that is furthest off as given, in its own unit.
fn largest(outcome: &Outcome, step: usize) -> Option<String> {
    let d = &outcome.diagnosis;
    let given = |j: usize| d.ladder[0].all.rmse[j];
    let judged = (0..d.joints.len()).filter(|j| given(*j).is_some());
    let worst =
        judged.max_by(|a, b| given(*a).partial_cmp(&given(*b)).unwrap_or(Ordering::Equal))?;
    let size = d.ladder[step].all.rmse[worst]?;
    let decimals = (1.0 - size.max(1e-6).log10().floor()).clamp(0.0, 6.0) as usize;
    let [_, _, unit] = maps::units(outcome, worst);
    Some(format!("{size:.decimals$} {unit} on {}", d.joints[worst]))
}

fn tone(d: &Diagnosis) -> Tone {
    match d.verdict {
        Verdict::NoGap | Verdict::Explained => Tone::Good,
        Verdict::PartlyExplained | Verdict::CannotTell => Tone::Warning,
        Verdict::UnknownEffect => Tone::Bad,
    }
}

/// Section with the verdict and its consequences, in the words of the terminal.
fn words(d: &Diagnosis, patch: &Patch, patched: &[PathBuf]) -> Section {
    let findings = worst_findings(d);
    // Lines that belong together in the terminal are one item here.
    let mut said: Vec<String> = Vec::new();
    // The remedy stands under what to do next.
    let (head, mut remedy) = (format!("  In the {}:", corrected(d)), false);
    for line in lines(d).iter().filter(|l| !findings.contains(l)) {
        remedy = line.starts_with(&head) || (remedy && line.starts_with(' '));
        match said.last_mut() {
            _ if remedy => {}
            Some(last) if line.starts_with(' ') => {
                *last = joined(last, line);
            }
            _ => said.push(line.clone()),
        }
    }
    let verdict = said.first().map_or("", |v| v.trim_end_matches('.'));
    let most = d.causes.iter().find(|c| c.confirmed);
    let most = most.filter(|c| c.gap_closed > 0.05);
    let most = most.map_or(String::new(), |c| {
        format!("The biggest cause, {}, {}.", name(c.effect), closes(c))
    });
    let mut section = Section::new("In words").callout(tone(d), verdict, most);
    for finding in &findings {
        section = section.callout(Tone::Bad, "Look at the recording first", finding.clone());
    }
    section = section
        .heading("What to do next")
        .list(next(d, patch.code.is_some(), patched))
        .heading("What was found");
    section.list(said.iter().skip(1).cloned()).paragraph(
        "NRMSE: root mean squared torque error over the standard deviation of the measured torque, joint by joint; the mean is \
         over joints.",
    )
}

fn ladder(outcome: &Outcome) -> Section {
    let d = &outcome.diagnosis;
    let steps = by_cause(d);
    let mut waterfall = Waterfall::new("Mean NRMSE on the held-out recording", "mean NRMSE");
    for (label, step) in &steps {
        let Some(mean) = step.all.mean_nrmse else {
            continue;
        };
        waterfall = if step.step == "repeatability" {
            waterfall.floor("repeatability", mean)
        } else {
            waterfall.step(label, mean)
        };
    }
    let table = |steps: &[(String, &Step)], moving: bool| {
        let mut columns = vec![Column::text("step")];
        columns.extend(d.joints.iter().map(Column::number));
        columns.push(Column::number("mean"));
        steps.iter().fold(Table::new(columns), |t, (label, step)| {
            let figures = if moving { &step.moving } else { &step.all };
            let mut cells = vec![Cell::text(label)];
            cells.extend(figures.nrmse.iter().map(|v| Cell::optional(*v, 4)));
            cells.push(Cell::optional(figures.mean_nrmse, 4));
            t.row(cells)
        })
    };
    Section::new("How far the gap shrinks")
        .figure(waterfall.draw(
            "Each step adds one thing to the model before it: the causes, largest first, then the model's other parameters, fitted again. \
             Per cent are of the mean over joints. In the words above, a cause closes a part of its own joints' error, with all other causes in place.",
        ))
        .table(table(&steps, false).caption("NRMSE by joint, all samples"))
        .details(
            Section::new("In motion alone")
                .table(table(&steps, true).caption("NRMSE by joint, samples with |q̇| > 0.01 rad/s (m/s)")),
        )
        .details(
            Section::new("Parameters first")
                .paragraph(
                    "The order of `ladder` in the JSON file: the model's own parameters are fitted before any cause is named. They take the \
                     place of what they can absorb, as the inertia of the last links does a payload's.",
                )
                .table(table(&parameters_first(outcome), false).caption("NRMSE by joint, all samples")),
        )
        .details(moved(d))
}

/// Table of parameters of the given structure that moved.
fn moved(d: &Diagnosis) -> Section {
    let head = [
        Column::text("parameter"),
        Column::text("joint"),
        Column::number("given"),
        Column::number("fitted"),
        Column::text("unit"),
        Column::number("deviations"),
    ];
    let table = d.moved_parameters.iter().fold(Table::new(head), |t, m| {
        t.row([
            Cell::text(&m.name),
            Cell::text(&m.joint),
            Cell::significant(m.given, 4),
            Cell::with_std(m.value, m.std),
            Cell::text(m.unit),
            Cell::number(m.deviations, 0),
        ])
    });
    Section::new("Parameters that moved")
        .paragraph("With the causes in place, near the given values where the data cannot say.")
        .table(table)
}

/// Steps in the order of the causes, with their names; then what is learned on top, and the floor.
fn by_cause(d: &Diagnosis) -> Vec<(String, &Step)> {
    let mut causes = d.causes.iter();
    let steps = d.by_cause.iter().map(|step| {
        let label = match step.step.as_str() {
            "as_given" => "as given".to_owned(),
            "reidentified" if d.causes.is_empty() => "parameters fitted again".to_owned(),
            "reidentified" => "other parameters fitted again".to_owned(),
            effect => causes.next().map_or(effect.replace('_', " "), |cause| {
                let joint = match &cause.joints[..] {
                    [joint] => format!(" · {joint}"),
                    _ => String::new(),
                };
                format!("{}{joint}", name(cause.effect))
            }),
        };
        (label, step)
    });
    let beyond = d.ladder.iter().filter_map(|step| match step.step.as_str() {
        "learned" => Some(("learned on top".to_owned(), step)),
        "repeatability" => Some(("repeatability".to_owned(), step)),
        _ => None,
    });
    let mut steps: Vec<_> = steps.collect();
    steps.extend(beyond);
    steps
}

/// Steps of the ladder with their names: the parameters first, then the effects with their joints.
fn parameters_first(outcome: &Outcome) -> Vec<(String, &Step)> {
    let d = &outcome.diagnosis;
    let found = &outcome.findings;
    let mut structure = (0..found.accepted.len())
        .map(|c| found.candidate(c))
        .filter(|c| !c.effect.info().parameter);
    let mut label = |step: &str| match step {
        "as_given" => "as given".to_owned(),
        "reidentified" => "parameters fitted again".to_owned(),
        "learned" => "learned on top".to_owned(),
        "repeatability" => "repeatability".to_owned(),
        effect => structure
            .next()
            .filter(|c| c.effect.name() == effect)
            .map_or(effect.replace('_', " "), |c| {
                let joint = match c.joints[..] {
                    [j] => format!(" · {}", d.joints[j]),
                    _ => String::new(),
                };
                format!("{}{joint}", name(c.effect))
            }),
    };
    d.ladder.iter().map(|s| (label(&s.step), s)).collect()
}

fn motion(d: &Diagnosis) -> Section {
    let section = Section::new("What it means in motion");
    let Some(s) = &d.simulation else {
        return section.paragraph("Not simulated.");
    };
    let degrees = |x: &[f64]| -> Vec<Option<f64>> { x.iter().map(|v| Some(1e3 * v)).collect() };
    let tracking = Bars::new(
        "Tracking error with the model's torque as feed-forward",
        "root mean square error / mrad (mm)",
        &d.joints,
    )
    .series("as given", Ink::Muted, &degrees(&s.closed_loop.before))
    .series("explained", Ink::Predicted, &degrees(&s.closed_loop.after));
    let table = Table::new([
        Column::text("model"),
        Column::number("follows the real robot for / s"),
    ])
    .row([Cell::text("as given"), Cell::number(s.free.before_s, 2)])
    .row([Cell::text("explained"), Cell::number(s.free.after_s, 2)]);
    section
        .figure(tracking.draw(format!(
            "{:.0} s of the held-out motion, tracked by a simulated robot that has all of the real one's torque, under position \
             feedback of {:.0} Hz.",
            s.seconds, s.closed_loop.bandwidth_hz
        )))
        .table(table.caption(format!(
            "Simulated under the recorded torque from the recorded state on, until a joint is 0.035 rad (0.01 m) away: median of \
             {} runs of at most {:.0} s.",
            s.free.starts, s.free.longest_s
        )))
}
