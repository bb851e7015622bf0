//! How far a proof's shares are known from its number of cases.

use super::score::Score;
use super::{NO_SINGLE, OUTSIDE};
use report::{Cell, Column, Table};
use signal::proportion;

/// A score, and whether it is that of single effects only.
type Rate = (&'static str, bool, fn(&Score) -> Option<f64>);

const RATES: [Rate; 7] = [
    ("top-1*, single", true, |s| s.top1),
    ("lenient, single", true, |s| s.lenient),
    ("top-3, single", true, |s| s.top3),
    ("extra", false, |s| s.extra),
    ("false alarm", false, |s| s.false_alarm),
    ("unknown found", false, |s| s.unknown_found),
    ("false unknown", false, |s| s.false_unknown),
];

/// Shares with the intervals of Clopper and Pearson. A half hit is none for the lower end and a whole one for the upper end.
pub fn table(scores: &[Score]) -> Table {
    let mut table = Table::new([
        Column::text("rate"),
        Column::number("of"),
        Column::number("cases"),
        Column::number("share"),
        Column::text("95 % interval"),
    ]);
    for (name, single, of) in RATES {
        let asked = scores
            .iter()
            .filter(|s| !single || !NO_SINGLE.contains(&s.kind.as_str()));
        let hits: Vec<f64> = asked.filter_map(of).collect();
        if hits.is_empty() {
            continue;
        }
        let (sum, n) = (hits.iter().sum::<f64>(), hits.len());
        let [low, _] = proportion::interval(sum.floor() as usize, n, OUTSIDE);
        let [_, high] = proportion::interval(sum.ceil() as usize, n, OUTSIDE);
        let places = if sum.fract() == 0.0 { 0 } else { 1 };
        table.push([
            Cell::text(name),
            Cell::number(sum, places),
            Cell::number(n as f64, 0),
            Cell::number(sum / n as f64, 3),
            Cell::text(format!("{low:.3}–{high:.3}")),
        ]);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_half_hit_widens_the_interval_on_both_sides() {
        let score = |kind: &str, top1| Score {
            kind: kind.to_owned(),
            top1,
            ..Score::default()
        };
        let mut scores: Vec<Score> = vec![score("payload", Some(1.0)); 9];
        scores.push(score("payload", Some(0.5)));
        // Neither counts: two effects, and none.
        scores.push(score("two", Some(0.0)));
        scores.push(score("none", None));
        let text = table(&scores).to_text();
        let row = text.lines().find(|l| l.contains("top-1*")).unwrap();
        // 9 of 10 from below, 10 of 10 from above.
        assert!(row.contains("9.5") && row.contains("0.950"), "{text}");
        assert!(row.contains("0.555–1.000"), "{text}");
        assert!(!text.contains("false alarm"), "no case of it: {text}");
    }
}
