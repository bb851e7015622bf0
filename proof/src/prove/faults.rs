//! Faults of a proof's answers: single effects that are not named first, and false causes.

use super::missed::Missed;
use super::rates::single;
use super::score::Score;
use report::{Cell, Column, Table};

/// Counts of names, the most frequent first, as "3 a, 1 b".
fn counted<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let mut counts = std::collections::BTreeMap::new();
    for name in names {
        *counts.entry(name).or_insert(0_usize) += 1;
    }
    let mut counts: Vec<(&str, usize)> = counts.into_iter().collect();
    counts.sort_by_key(|&(_, n)| std::cmp::Reverse(n));
    let parts = counts.iter().map(|(name, n)| format!("{n} {name}"));
    parts.collect::<Vec<_>>().join(", ")
}

/// Table of single effects that are not named first, by the reason; none where all are named first.
pub fn missed_table(scores: &[Score]) -> Option<Table> {
    let mut table = Table::new([
        Column::text("not named first"),
        Column::number("cases"),
        Column::text("of them"),
    ]);
    let lone = || scores.iter().filter(|s| single(s) && s.missed.is_some());
    for (why, name) in Missed::ALL {
        let own: Vec<&Score> = lone().filter(|s| s.missed == Some(why)).collect();
        if !own.is_empty() {
            let kinds = own.iter().filter_map(|s| s.kind.split(',').next());
            table.push([
                Cell::text(name),
                Cell::number(own.len() as f64, 0),
                Cell::text(counted(kinds)),
            ]);
        }
    }
    lone().next().is_some().then_some(table)
}

/// Table of false causes, the most frequent first, with their cases; none where no cause is false.
pub fn false_table(scores: &[Score]) -> Option<Table> {
    let mut table = Table::new([
        Column::text("false cause"),
        Column::number("named"),
        Column::number("beside an effect that the catalogue lacks"),
        Column::number("where inertials are off by up to 25 %"),
        Column::text("in cases of"),
    ]);
    let all: Vec<(&str, &Score)> = scores
        .iter()
        .flat_map(|s| s.false_causes.iter().map(move |name| (name.as_str(), s)))
        .collect();
    let mut names: Vec<&str> = all.iter().map(|(name, _)| *name).collect();
    names.sort_unstable();
    names.dedup();
    let of = |name: &str| {
        all.iter()
            .filter(|(n, _)| *n == name)
            .map(|(_, s)| *s)
            .collect::<Vec<&Score>>()
    };
    names.sort_by_key(|name| std::cmp::Reverse(of(name).len()));
    let mut push = |name: &str, own: &[&Score], kinds: String| {
        let count = |f: &dyn Fn(&Score) -> bool| own.iter().filter(|s| f(s)).count() as f64;
        table.push([
            Cell::text(name),
            Cell::number(own.len() as f64, 0),
            Cell::number(count(&|s| s.kind == "outside"), 0),
            Cell::number(
                count(&|s| s.drawn.is_some_and(|d| d.inertial_width > 0.2)),
                0,
            ),
            Cell::text(kinds),
        ]);
    };
    for name in &names {
        let own = of(name);
        push(name, &own, counted(own.iter().map(|s| s.kind.as_str())));
    }
    let every: Vec<&Score> = all.iter().map(|(_, s)| *s).collect();
    push("all", &every, String::new());
    (!all.is_empty()).then(|| table.emphasise_last())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn case(missed: Option<Missed>, false_causes: &[&str]) -> Score {
        Score {
            kind: "backlash, foreign gear".to_owned(),
            missed,
            false_causes: false_causes.iter().map(|&c| c.to_owned()).collect(),
            ..Score::default()
        }
    }

    #[test]
    fn misses_and_false_causes_are_counted() {
        let outside = Score {
            kind: "outside".to_owned(),
            ..case(None, &["torque_gain"])
        };
        let scores = [
            case(Some(Missed::InNoLine), &["torque_offset", "torque_gain"]),
            outside,
            case(Some(Missed::InNoLine), &[]),
            case(None, &[]),
        ];
        let text = missed_table(&scores).unwrap().to_text();
        assert!(
            text.contains("2 backlash") && !text.contains("absorbed"),
            "{text}"
        );
        assert!(missed_table(&scores[3..]).is_none() && false_table(&scores[2..]).is_none());
        let text = false_table(&scores).unwrap().to_text();
        let cells = |name: &str| {
            let line = text
                .lines()
                .find(|l| l.trim_start().starts_with(name))
                .unwrap_or_default();
            let words = line.split_whitespace().skip(1).take(3);
            words.map(str::to_owned).collect::<Vec<_>>()
        };
        assert_eq!(cells("torque_gain"), ["2", "1", "0"], "{text}");
        assert_eq!(cells("all"), ["3", "1", "0"], "{text}");
        let lines: Vec<&str> = text.lines().collect();
        let at = |name: &str| lines.iter().position(|l| l.contains(name));
        assert!(at("torque_gain") < at("torque_offset"), "{text}");
    }
}
