//! Reliability of the confidence: share of right names among causes that were named with a given confidence.

use super::score::Score;
use diagnose::settings::ConfidenceSettings;
use report::{Cell, Column, Table};
use signal::proportion;

/// Number of bins of equal count.
const BINS: usize = 5;
/// Probability that a bin's interval does not contain its true share.
const OUTSIDE: f64 = 0.01;

/// Confidence of each structural cause by the weights of the settings, whatever its report was written with, and whether effect and
/// joint are right. Empty where the settings have no weights.
pub fn said(scores: &[Score], settings: &ConfidenceSettings) -> Vec<(f64, bool)> {
    let named = scores.iter().flat_map(|s| &s.named);
    let said = named.filter_map(|n| Some((n.support.confidence(settings)?, n.right)));
    said.collect()
}

/// Table of reliability in bins of equal count, and the Brier score. Beside it the Brier score of a constant
/// confidence, the share of right names over all causes.
pub fn table(said: &[(f64, bool)]) -> Table {
    let mut sorted = said.to_vec();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut table = Table::new([
        Column::text("confidence"),
        Column::number("causes"),
        Column::number("mean confidence"),
        Column::number("right"),
        Column::text("99 % interval"),
        Column::number("Brier score"),
        Column::number("of their share"),
    ]);
    let mut push = |name: String, of: &[(f64, bool)]| {
        let n = of.len() as f64;
        let right = of.iter().filter(|c| c.1).count();
        let share = right as f64 / n;
        let [low, high] = proportion::interval(right, of.len(), OUTSIDE);
        let square = |c: &(f64, bool)| (c.0 - f64::from(u8::from(c.1))).powi(2);
        table.push([
            Cell::text(name),
            Cell::number(n, 0),
            Cell::number(of.iter().map(|c| c.0).sum::<f64>() / n, 3),
            Cell::number(share, 3),
            Cell::text(format!("{low:.2}–{high:.2}")),
            Cell::number(of.iter().map(square).sum::<f64>() / n, 3),
            Cell::number(share * (1.0 - share), 3),
        ]);
    };
    let count = sorted.len();
    for b in 0..BINS {
        let of = &sorted[b * count / BINS..(b + 1) * count / BINS];
        if let (Some(first), Some(last)) = (of.first(), of.last()) {
            push(format!("{:.3}–{:.3}", first.0, last.0), of);
        }
    }
    if count > 0 {
        push("all".to_owned(), &sorted);
    }
    table.emphasise_last()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_row_says_how_good_a_confidence_is() {
        let text = table(&[(0.9, true), (0.4, false), (0.7, true)]).to_text();
        let last = text.lines().last().unwrap();
        // (0.01 + 0.16 + 0.09)/3, and 2/3 · 1/3.
        assert!(last.contains("0.087") && last.contains("0.222"), "{text}");
    }
}
