//! The report as one self-contained HTML page.

use crate::diagnosis::Outcome;
use crate::report::{Cause, Verdict};
use crate::words::{closes, lines, plain, remedy, sentence, value};
use report::figure::{Bars, Ink, Panel, Plot, Waterfall};
use report::{Cell, Column, Figure, KeyFigure, Page, Section, Table, Tone};

/// Joints whose maps are drawn: those with most of the gap.
const MAPS: usize = 3;

/// Renders the page. `inputs` names robot and recordings.
pub fn render(outcome: &Outcome, inputs: &[(String, String)]) -> String {
    let d = &outcome.diagnosis;
    let said = lines(d);
    let nrmse = |n: usize| d.ladder.get(n).map_or(f64::NAN, |s| s.all.mean_nrmse);
    let last = d
        .ladder
        .iter()
        .rposition(|s| s.step != "repeatability")
        .unwrap_or(0);
    let tone = match d.verdict {
        Verdict::NoGap | Verdict::Explained => Tone::Good,
        Verdict::PartlyExplained => Tone::Warning,
        Verdict::UnknownEffect => Tone::Bad,
    };
    let mut page = Page::new("Where the simulator and the robot part")
        .subtitle(said.first().cloned().unwrap_or_default())
        .key_figure(KeyFigure::new("verdict", d.verdict.name().replace('_', " ")).tone(tone))
        .key_figure(KeyFigure::new(
            "mean NRMSE as given",
            format!("{:.3}", nrmse(0)),
        ))
        .key_figure(
            KeyFigure::new("mean NRMSE explained", format!("{:.3}", nrmse(last)))
                .note("on held-out data"),
        );
    if let Some(first) = d.causes.first() {
        page = page
            .key_figure(KeyFigure::new("biggest cause", plain(first.effect)).note(closes(first)));
    }
    page = page.section(
        Section::new("In words")
            .list(said.iter().skip(1).map(|l| l.trim().to_owned()))
            .paragraph("NRMSE is the root mean squared torque error over the standard deviation of the measured torque; all figures are measured on the held-out recording."),
    );
    page = page
        .section(ladder(outcome))
        .section(causes(outcome))
        .section(maps(outcome))
        .section(places(outcome));
    page = page.section(
        Section::new("What is left")
            .paragraph("Error with structure away from reversals, relative to each joint's torque, and what a flexible learner would still predict of it.")
            .table(d.unexplained.iter().fold(
                Table::new([Column::text("joint"), Column::number("structured error"), Column::number("learnable part")]),
                |t, u| t.row([Cell::text(&u.joint), Cell::number(u.nrmse, 4), Cell::number(u.learnable.max(0.0), 2)]),
            )),
    );
    let mut provenance: Vec<(String, String)> = inputs.to_vec();
    provenance.push(("version".to_owned(), env!("CARGO_PKG_VERSION").to_owned()));
    let mut about = Section::new("Data and caveats")
        .pairs(provenance)
        .list(d.notes.clone());
    if !d.not_identifiable.is_empty() {
        about = about.list(
            d.not_identifiable
                .iter()
                .map(|n| format!("{}: {}", plain(n.effect), n.reason)),
        );
    }
    page.section(about).render()
}

fn ladder(outcome: &Outcome) -> Section {
    let d = &outcome.diagnosis;
    let waterfall = d.ladder.iter().fold(
        Waterfall::new("Mean NRMSE on the held-out recording", "mean NRMSE"),
        |w, s| w.step(s.step.replace('_', " "), s.all.mean_nrmse),
    );
    let mut columns = vec![Column::text("step")];
    columns.extend(d.joints.iter().map(Column::number));
    columns.push(Column::number("mean"));
    let table = d.ladder.iter().fold(Table::new(columns), |t, s| {
        let mut cells = vec![Cell::text(s.step.replace('_', " "))];
        cells.extend(s.all.nrmse.iter().map(|v| Cell::optional(*v, 4)));
        cells.push(Cell::number(s.all.mean_nrmse, 4));
        t.row(cells)
    });
    Section::new("How far the gap shrinks")
        .figure(waterfall.draw("Each step adds one thing to the model before it."))
        .table(table.caption("NRMSE by joint"))
}

fn causes(outcome: &Outcome) -> Section {
    let causes = &outcome.diagnosis.causes;
    if causes.is_empty() {
        return Section::new("Causes").paragraph("None is listed.");
    }
    let shares = Bars::new(
        "Share of the gap by cause",
        "share",
        causes
            .iter()
            .map(|c| format!("{} · {}", plain(c.effect), c.joints.join(", "))),
    )
    .series(
        "share of what all causes remove",
        Ink::Series(0),
        &causes
            .iter()
            .map(|c| Some(c.share_of_gap))
            .collect::<Vec<_>>(),
    );
    let head = [
        Column::text("cause"),
        Column::number("share"),
        Column::number("confidence"),
        Column::text("size"),
        Column::text("in the simulator"),
    ];
    let table = causes.iter().fold(Table::new(head), |t, c| {
        t.row([
            Cell::text(plain(c.effect)),
            Cell::number(c.share_of_gap, 2),
            Cell::number(c.confidence, 2),
            Cell::text(
                c.parameters
                    .iter()
                    .map(value)
                    .collect::<Vec<_>>()
                    .join("; "),
            ),
            Cell::text(remedy(c)),
        ])
    });
    let say = |c: &Cause| format!("{}: {}.", sentence(c), closes(c));
    Section::new("Causes")
        .figure(shares.draw("Shapley shares of squared NRMSE."))
        .list(causes.iter().map(say))
        .table(table)
}

fn maps(outcome: &Outcome) -> Section {
    let gap = &outcome.explanation.gap;
    let left = &outcome.explanation.residual;
    let m = outcome.frames.heldout.samples();
    let names = &outcome.diagnosis.joints;
    let mut order: Vec<usize> = (0..gap.ncols()).collect();
    let size = |j: usize| outcome.diagnosis.ladder[0].all.nrmse[j].unwrap_or(0.0);
    order.sort_by(|a, b| size(*b).total_cmp(&size(*a)));
    let mut figures: Vec<Figure> = Vec::new();
    for &j in order.iter().take(MAPS) {
        let (before, after) = (gap.column(j).to_vec(), left.column(j).to_vec());
        for (what, unit, x) in [
            ("velocity", "rad/s", m.qd.column(j).to_vec()),
            ("position", "rad", m.q.column(j).to_vec()),
        ] {
            let panel = Panel::new("torque error / N·m")
                .binned("as given", Ink::Muted, &x, &before, 40)
                .binned("explained", Ink::Residual, &x, &after, 40);
            figures.push(
                Plot::new(
                    format!("{} against {what}", names[j]),
                    format!("{what} / {unit}"),
                )
                .half_width()
                .panel(panel)
                .draw("Means over bins with one standard deviation."),
            );
        }
    }
    Section::new("Maps").figures(figures)
}

fn places(outcome: &Outcome) -> Section {
    let head = [
        Column::text("joint"),
        Column::text("where"),
        Column::number("share of gap"),
        Column::number("share of time"),
    ];
    let table = outcome
        .diagnosis
        .places
        .iter()
        .fold(Table::new(head), |t, p| {
            t.row([
                Cell::text(&p.joint),
                Cell::text(format!(
                    "{} {:.3} … {:.3} {}",
                    p.coordinate, p.range[0], p.range[1], p.unit
                )),
                Cell::number(p.share_of_gap, 2),
                Cell::number(p.share_of_time, 2),
            ])
        });
    Section::new("Where the gap lies").table(table)
}
