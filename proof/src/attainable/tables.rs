//! Scores of a diagnosis beside those of the observer, on the same cases.

use super::Known;
use crate::prove::by_drawn::groups;
use crate::prove::rates::{RATES, interval, single};
use crate::prove::{Score, mean};
use report::{Cell, Column, Table};
use signal::quantile::median;

/// Scores of a case by the diagnosis, and the observer's answer.
pub type Pair<'a> = (&'a Score, &'a Known);

/// Rates of both with intervals of 95 %, and the part of the observer's that the diagnosis reaches. A rate counts the cases where it
/// applies to both.
pub fn rates(pairs: &[Pair]) -> Table {
    let mut table = Table::new([
        Column::text("rate"),
        Column::number("cases"),
        Column::number("diagnosis"),
        Column::text("95 % interval"),
        Column::number("attainable"),
        Column::text("95 % interval"),
        Column::number("part of it"),
    ]);
    for (name, asked, value) in RATES {
        let both = pairs.iter().filter(|(ours, _)| asked(ours));
        let both: Vec<[f64; 2]> = both
            .filter_map(|(ours, known)| Some([value(ours)?, value(&known.score)?]))
            .collect();
        // The observer gives no size's interval.
        if both.is_empty() {
            continue;
        }
        let n = both.len();
        let sums = [0, 1].map(|i| both.iter().map(|b| b[i]).sum::<f64>());
        let told = sums.map(|sum| {
            let [low, high] = interval(sum, n);
            format!("{low:.3}–{high:.3}")
        });
        let [first, second] = told;
        let part = (sums[1] > 0.0).then(|| sums[0] / sums[1]);
        table.push([
            Cell::text(name),
            Cell::number(n as f64, 0),
            Cell::number(sums[0] / n as f64, 3),
            Cell::text(first),
            Cell::number(sums[1] / n as f64, 3),
            Cell::text(second),
            Cell::optional(part, 2),
        ]);
    }
    table
}

/// First names and false causes of both by a property of the case.
fn by(pairs: &[Pair], head: &str, of: impl Fn(&Score) -> Vec<String>) -> Option<Table> {
    let mut names: Vec<String> = pairs.iter().flat_map(|(ours, _)| of(ours)).collect();
    names.sort_unstable();
    names.dedup();
    let mut columns = vec![Column::text(head), Column::number("cases")];
    for score in ["top-1*", "lenient", "extra"] {
        columns.push(Column::number(score));
        columns.push(Column::number(format!("{score} attainable")));
    }
    columns.push(Column::number("probability of the choice"));
    columns.extend(["lead, nats", "least lead", "left"].map(Column::number));
    let mut table = Table::new(columns);
    for name in &names {
        let own: Vec<&Pair> = pairs.iter().filter(|p| of(p.0).contains(name)).collect();
        let scores: [fn(&Score) -> Option<f64>; 3] = [|s| s.top1, |s| s.lenient, |s| s.extra];
        let mut cells = vec![Cell::text(name.as_str()), Cell::number(own.len() as f64, 0)];
        for score in scores {
            let [ours, known]: [Vec<&Score>; 2] = [
                own.iter().map(|p| p.0).collect(),
                own.iter().map(|p| &p.1.score).collect(),
            ];
            cells.push(Cell::optional(mean(&ours, score), 2));
            cells.push(Cell::optional(mean(&known, score), 2));
        }
        let probability = own.iter().map(|p| p.1.probability).sum::<f64>() / own.len() as f64;
        cells.push(Cell::number(probability, 2));
        let leads: Vec<f64> = own.iter().filter_map(|p| p.1.lead).collect();
        let least = leads.iter().copied().reduce(f64::min);
        cells.push(Cell::optional(median(leads), 0));
        cells.push(Cell::optional(least, 0));
        cells.push(Cell::optional(
            median(own.iter().filter_map(|p| p.1.left).collect()),
            2,
        ));
        table.push(cells);
    }
    (!names.is_empty()).then_some(table)
}

/// Scores of both by kind of case.
pub fn by_kind(pairs: &[Pair]) -> Option<Table> {
    by(pairs, "truth", |s| vec![s.kind.clone()])
}

/// Scores of both of single effects by the properties that a hard case was drawn with; none without hard cases.
pub fn by_drawn(pairs: &[Pair]) -> Option<Table> {
    let own: Vec<Pair> = pairs.iter().copied().filter(|p| single(p.0)).collect();
    by(&own, "drawn", groups)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_are_counted_on_the_same_cases() {
        let score = |top1: Option<f64>| Score {
            kind: "payload".to_owned(),
            top1,
            extra: Some(0.0),
            ..Score::default()
        };
        let (ours, known) = (
            [score(Some(0.0)), score(Some(1.0)), score(None)],
            [score(Some(1.0)), score(Some(1.0)), score(Some(1.0))],
        );
        let known = known.map(|score| Known {
            score,
            probability: 0.9,
            lead: Some(20.0),
            left: Some(1.0),
        });
        let pairs: Vec<Pair> = ours.iter().zip(&known).collect();
        let text = rates(&pairs).to_text();
        let row = text.lines().find(|l| l.contains("top-1*, single")).unwrap();
        let cells: Vec<&str> = row.split_whitespace().collect();
        assert_eq!(cells[2..4], ["2", "0.500"], "{text}");
        assert!(
            row.contains("1.000") && row.trim_end().ends_with("0.50"),
            "{text}"
        );
        let text = by_kind(&pairs).unwrap().to_text();
        assert!(text.contains("top-1* attainable"), "{text}");
        assert!(by_drawn(&pairs).is_none(), "no hard case");
    }
}
