//! Scores of hard cases by the properties that were drawn beside the effect.

use super::rates::{interval, single};
use super::score::{Score, mean};
use report::{Cell, Column, Table};

/// Shares of the joint's torque from which an effect counts as middling, and as large.
const SHARES: [f64; 2] = [0.08, 0.15];

/// Groups of a case, one for each property that was drawn.
pub(crate) fn groups(score: &Score) -> Vec<String> {
    let Some(drawn) = score.drawn else {
        return Vec::new();
    };
    let mut groups = vec![
        format!(
            "inertials off by up to {:2.0} %",
            100.0 * drawn.inertial_width
        ),
        format!(
            "friction off by up to a factor of {:.1}",
            drawn.friction_width
        ),
        String::from(match drawn.one_filter {
            true => "torque: one filter for all joints",
            false => "torque: to each joint a filter",
        }),
    ];
    if let (true, Some((share, _))) = (single(score), score.detection) {
        let [middling, large] = SHARES.map(|s| 100.0 * s);
        groups.push(match SHARES.partition_point(|s| *s <= share) {
            0 => format!("share of its joint under {middling:.0} %"),
            1 => format!("share of its joint {middling:.0} to {large:.0} %"),
            _ => format!("share of its joint {large:.0} % and more"),
        });
    }
    groups
}

/// Table of scores by drawn property, with intervals: scores of single effects, and false causes of all. None without hard cases.
pub fn table(scores: &[Score]) -> Option<Table> {
    let mut names: Vec<String> = scores.iter().flat_map(groups).collect();
    names.sort_unstable();
    names.dedup();
    let mut table = Table::new([
        Column::text("drawn"),
        Column::number("single"),
        Column::number("top-1*"),
        Column::text("95 % interval"),
        Column::number("lenient"),
        Column::number("cases"),
        Column::number("extra"),
    ]);
    for name in &names {
        let own = scores.iter().filter(|s| groups(s).contains(name));
        let own: Vec<&Score> = own.collect();
        let lone: Vec<&Score> = own.iter().copied().filter(|s| single(s)).collect();
        let hits: f64 = lone.iter().filter_map(|s| s.top1).sum();
        let [low, high] = interval(hits, lone.len());
        table.push([
            Cell::text(name),
            Cell::number(lone.len() as f64, 0),
            Cell::optional(mean(&lone, |s| s.top1), 2),
            Cell::text(format!("{low:.2}–{high:.2}")),
            Cell::optional(mean(&lone, |s| s.lenient), 2),
            Cell::number(own.len() as f64, 0),
            Cell::optional(mean(&own, |s| s.extra), 2),
        ]);
    }
    (!names.is_empty()).then_some(table)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prove::drawn::Drawn;
    use serde_json::json;

    #[test]
    fn cases_are_counted_by_what_was_drawn() {
        let truth = |width: f64| json!({"hard": {"inertial_width": width, "friction_width": 2.0, "lowpass": {"same": true}}});
        let case = |kind: &str, width: f64, top1, share: f64| Score {
            kind: kind.to_owned(),
            top1,
            extra: Some(0.0),
            drawn: Drawn::of(&truth(width)),
            detection: Some((share, true)),
            ..Score::default()
        };
        let scores = [
            case("payload", 0.25, Some(0.0), 0.05),
            case("payload", 0.25, Some(1.0), 0.2),
            case("payload", 0.03, Some(1.0), 0.1),
            case("none", 0.25, None, 0.0),
        ];
        let text = table(&scores).unwrap().to_text();
        let row = |name: &str| {
            let line = text.lines().find(|l| l.contains(name)).unwrap_or_default();
            let cells: Vec<&str> = line.trim_start_matches(name).split_whitespace().collect();
            cells.iter().map(|c| (*c).to_owned()).collect::<Vec<_>>()
        };
        assert_eq!(row("inertials off by up to 25 %")[..2], ["2", "0.50"]);
        assert_eq!(row("inertials off by up to 25 %")[4], "3", "{text}");
        assert_eq!(row("inertials off by up to  3 %")[..2], ["1", "1.00"]);
        assert_eq!(row("share of its joint under 8 %")[..2], ["1", "0.00"]);
        assert_eq!(row("share of its joint 15 % and more")[..2], ["1", "1.00"]);
        assert!(table(&[Score::default()]).is_none(), "no hard case");
    }
}
