//! Output of `train doctor`.

use super::outcome::{Counted, Figures, Kind};
use report::{Cell, Column, Table, say, say_text};
use trials::channels::Fault;

/// Prints the table, and with `every` the recordings that were not recognised rightly.
pub fn print(figures: &Figures, every: bool) {
    let mut table = Table::new([
        Column::text("torque"),
        Column::number("recordings"),
        Column::number("recognised"),
        Column::number("95 % interval"),
        Column::number("something else, too"),
        Column::number("mended"),
    ]);
    for kind in &figures.kinds {
        table.push(row(kind));
    }
    say_text!(table.to_markdown());
    if every {
        figures.kinds.iter().for_each(wrong);
    }
}

fn row(kind: &Counted) -> Vec<Cell> {
    let [low, high] = kind.interval;
    let [tried, mended] = kind.mended;
    let name = match kind.kind {
        Kind::Channel(Fault::None) => "healthy (recognised: nothing said)".to_owned(),
        Kind::Channel(fault) => fault.name().to_owned(),
        Kind::Description(wrong) => {
            format!(
                "healthy, {} (recognised: no fault said alone)",
                wrong.name()
            )
        }
    };
    vec![
        Cell::text(name),
        Cell::text(kind.outcomes.len().to_string()),
        Cell::text(kind.right.to_string()),
        Cell::text(format!("{low:.3} to {high:.3}")),
        Cell::text(kind.more.to_string()),
        Cell::text(match tried {
            0 => "–".to_owned(),
            _ => format!("{mended} of {tried}"),
        }),
    ]
}

fn wrong(kind: &Counted) {
    let expected = usize::from(kind.kind != Kind::Channel(Fault::None));
    for outcome in &kind.outcomes {
        let alone = outcome.right && outcome.complaints.len() == expected;
        if alone && outcome.mended != Some(false) {
            continue;
        }
        say!(
            "{} {}: joints {:?}, mended {:?}",
            kind.kind.name(),
            outcome.index,
            outcome.joints,
            outcome.mended
        );
        let first = outcome.complaints.iter().map(|c| ("", c));
        let left = outcome.left.iter().map(|c| ("behind the remedy, ", c));
        for (when, complaint) in first.chain(left) {
            say!(
                "  {when}{} of {:?}: {}",
                complaint.ailment.name(),
                complaint.joints,
                complaint.seen
            );
        }
    }
}
