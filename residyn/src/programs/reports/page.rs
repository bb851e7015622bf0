//! Two runs side by side as one self-contained HTML page.

use super::comparison::Comparison;
use super::read::Cause;
use super::words::{self, NAMES, short};
use report::figure::{Bars, Ink};
use report::{KeyFigure, Page, Section};

/// Renders the page.
pub fn render(c: &Comparison) -> String {
    let kind = c.runs[0].kind;
    let [a, b] = [0, 1].map(|run: usize| c.runs[run].path.display().to_string());
    let mut page = Page::new("Two runs side by side").subtitle(format!(
        "Reports of {}. A is {a}, B is {b}. Every figure is of the recording that the run was scored on.",
        kind.program()
    ));
    for (name, run) in NAMES.iter().zip(&c.runs) {
        if let Some(verdict) = &run.verdict {
            page = page.key_figure(KeyFigure::new(format!("verdict of {name}"), verdict));
        }
    }
    for [a, b] in &c.gaps {
        if let (Some(from), Some(to)) = (a.mean, b.mean) {
            let figure = KeyFigure::new(&a.name, format!("{from:.3} → {to:.3}"));
            page = page.key_figure(figure.note(format!("mean {}, A → B", kind.measure())));
        }
    }
    page.section(Section::new("What changed").list(words::lines(c)))
        .section(errors(c))
        .section(causes(c))
        .footer(format!("Made by residyn {}.", program::VERSION))
        .render()
}

fn errors(c: &Comparison) -> Section {
    let kind = c.runs[0].kind;
    let section = Section::new("Error by joint");
    c.gaps
        .iter()
        .zip(words::errors(c))
        .fold(section, |section, ([a, b], table)| {
            let bars = Bars::new(
                format!("{} by joint, {}", kind.measure(), a.name),
                kind.measure(),
                &c.runs[0].joints,
            );
            let bars = bars
                .decimals(3)
                .series(NAMES[0], Ink::Series(0), &a.by_joint)
                .series(NAMES[1], Ink::Series(1), &b.by_joint);
            section.figure(bars.draw("")).table(table)
        })
}

fn causes(c: &Comparison) -> Section {
    let section = Section::new("Causes");
    let Some(table) = words::causes(c) else {
        let none = "Neither run lists one.";
        let scores = "Reports of eval hold none.";
        let known = c.runs[0].verdict.is_some();
        return section.paragraph(if known { none } else { scores });
    };
    // A run that does not list a cause has no bar of it.
    let closed = |cause: Option<&Cause>| match cause {
        Some(cause) => {
            let point = [cause.gap_closed; 2];
            (cause.gap_closed, cause.gap_closed_interval.unwrap_or(point))
        }
        None => (f64::NAN, [f64::NAN; 2]),
    };
    let series = |run: usize| -> Vec<_> {
        let pairs = c.causes.iter();
        pairs.map(|pair| closed(pair.0[run].as_ref())).collect()
    };
    let bars = Bars::new(
        "Part of its joints' error that each cause removes",
        "part closed, with 90 % interval",
        c.causes.iter().map(short),
    )
    .series_with_intervals(NAMES[0], Ink::Series(0), &series(0))
    .series_with_intervals(NAMES[1], Ink::Series(1), &series(1));
    let section = section.figure(bars.draw("")).table(table);
    match words::sizes(c) {
        Some(sizes) => section.table(sizes),
        None => section,
    }
}
