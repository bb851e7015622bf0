//! Uncertainty of a proof's shares from the number of its cases.

use super::score::Score;
use super::{NO_SINGLE, OUTSIDE};
use report::{Cell, Column, Table};
use signal::proportion;

/// Rate in a table: its name, the cases that it counts, and the score of each.
pub(crate) type Rate = (&'static str, fn(&Score) -> bool, fn(&Score) -> Option<f64>);

/// Rates of a proof.
pub(crate) const RATES: [Rate; 12] = [
    ("top-1*, single", single, |s| s.top1),
    ("lenient, single", single, |s| s.lenient),
    ("top-3, single", single, |s| s.top3),
    (
        "top-1*, elasticity",
        |s| of("joint_elasticity", s),
        |s| s.top1,
    ),
    ("top-1*, play", |s| of("backlash", s), |s| s.top1),
    (
        "lenient, contact",
        |s| of("external_contact", s) || of("contact_at_rest", s),
        |s| s.lenient,
    ),
    (
        "found, two on one joint",
        |s| of("two_same_joint", s),
        |s| s.found,
    ),
    ("extra", any, |s| s.extra),
    ("false alarm", any, |s| s.false_alarm),
    ("unknown found", any, |s| s.unknown_found),
    ("false unknown", any, |s| s.false_unknown),
    ("size in its 90 % interval", any, |s| s.covered),
];

fn any(_: &Score) -> bool {
    true
}

/// Whether a case withholds one listed effect.
pub(crate) fn single(score: &Score) -> bool {
    !NO_SINGLE.contains(&score.kind.as_str())
}

/// Whether a case is of a kind, a gear of whatever laws.
fn of(kind: &str, score: &Score) -> bool {
    score.kind.split(',').next() == Some(kind)
}

/// Clopper-Pearson interval of a share. Half a hit counts as no hit for the lower end, as a whole one for the upper.
pub(crate) fn interval(hits: f64, cases: usize) -> [f64; 2] {
    let [low, _] = proportion::interval(hits.floor() as usize, cases, OUTSIDE);
    let [_, high] = proportion::interval(hits.ceil() as usize, cases, OUTSIDE);
    [low, high]
}

/// Shares with their intervals.
pub fn table(scores: &[Score]) -> Table {
    let mut table = Table::new([
        Column::text("rate"),
        Column::number("of"),
        Column::number("cases"),
        Column::number("share"),
        Column::text("95 % interval"),
    ]);
    for (name, asked, value) in RATES {
        let asked = scores.iter().filter(|s| asked(s));
        let hits: Vec<f64> = asked.filter_map(value).collect();
        if hits.is_empty() {
            continue;
        }
        let (sum, n) = (hits.iter().sum::<f64>(), hits.len());
        let [low, high] = interval(sum, n);
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
