//! Whether a confidence is what it says: of the causes that were named with it, so many have to be right.

use super::score::Score;
use crate::settings::ConfidenceSettings;
use report::{Cell, Column, Table};
use statrs::distribution::{Beta, ContinuousCDF};

/// Bins of equal count.
const BINS: usize = 5;
/// Chance that a bin's interval does not hold its share.
const OUTSIDE: f64 = 0.01;

/// Confidence of each structural cause by the weights of the settings, whatever its report was written with, and whether effect and
/// joint are right. Empty where the settings have no weights.
pub fn said(scores: &[Score], settings: &ConfidenceSettings) -> Vec<(f64, bool)> {
    let named = scores.iter().flat_map(|s| &s.named);
    let said = named.filter_map(|n| Some((n.support.confidence(settings)?, n.right)));
    said.collect()
}

/// Reliability in bins of equal count, and the Brier score beside the one of a confidence that is the share of right names whatever the
/// cause.
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
        let [low, high] = interval(right, of.len());
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

/// Interval of a share (Clopper and Pearson 1934).
fn interval(hits: usize, of: usize) -> [f64; 2] {
    let quantile = |a: usize, b: usize, p: f64| {
        Beta::new(a as f64, b as f64).map_or(f64::NAN, |d| d.inverse_cdf(p))
    };
    [
        if hits == 0 {
            0.0
        } else {
            quantile(hits, of - hits + 1, OUTSIDE / 2.0)
        },
        if hits == of {
            1.0
        } else {
            quantile(hits + 1, of - hits, 1.0 - OUTSIDE / 2.0)
        },
    ]
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

    #[test]
    fn intervals_are_those_of_tables() {
        // 99 % of 9 in 10: 0.456 to 0.9995.
        let [low, high] = interval(9, 10);
        assert!(
            (low - 0.456).abs() < 1e-3 && (high - 0.9995).abs() < 1e-4,
            "{low} {high}"
        );
        // 0 in 5: up to 1 − 0.005^(1/5).
        assert!((interval(0, 5)[1] - (1.0 - 0.005f64.powf(0.2))).abs() < 1e-6);
    }
}
