//! Tables of scores over many cases.

use super::score::{Score, tempering};
use report::{Cell, Column, Table};
use signal::proportion::interval;
use signal::quantile::median;

/// Probability that the confidence interval of a rate does not contain the true rate.
const OUTSIDE: f64 = 0.05;

/// Kinds of case that do not withhold a single effect of the catalogue.
const NO_SINGLE: [&str; 3] = ["none", "two", "outside"];

/// Table by kind of case: number of cases, right reports, false causes, and median unexplained ratio as given and
/// corrected.
pub fn kinds(scores: &[Score]) -> Table {
    let mut names: Vec<&str> = scores.iter().map(|s| s.sealed.kind.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    let mut table = Table::new([
        Column::text("withheld"),
        Column::number("cases"),
        Column::number("right"),
        Column::number("causes beside"),
        Column::number("as given"),
        Column::number("corrected"),
    ]);
    for name in names {
        let own: Vec<&Score> = scores.iter().filter(|s| s.sealed.kind == name).collect();
        let middle = |k: usize| {
            let all: Vec<f64> = own.iter().map(|s| s.unexplained[k]).collect();
            median(all).unwrap_or(f64::NAN)
        };
        table.push([
            Cell::text(name),
            Cell::text(own.len().to_string()),
            Cell::text(own.iter().filter(|s| s.right).count().to_string()),
            Cell::text(own.iter().map(|s| s.extra.len()).sum::<usize>().to_string()),
            Cell::number(middle(0), 3),
            Cell::number(middle(1), 3),
        ]);
    }
    table
}

/// Table of success rates with their 95 % intervals, for each simulator.
pub fn rates(scores: &[Score]) -> Table {
    let mut table = Table::new([
        Column::text("simulator"),
        Column::text("rate"),
        Column::number("of"),
        Column::number("share"),
        Column::text("95 % interval"),
    ]);
    let mut simulators: Vec<&str> = scores.iter().map(|s| s.sealed.simulator.as_str()).collect();
    simulators.sort_unstable();
    simulators.dedup();
    for simulator in simulators {
        let own: Vec<&Score> = scores
            .iter()
            .filter(|s| s.sealed.simulator == simulator)
            .collect();
        let mut add = |name: &str, hits: Vec<bool>| {
            if hits.is_empty() {
                return;
            }
            let right = hits.iter().filter(|h| **h).count();
            let [low, high] = interval(right, hits.len(), OUTSIDE);
            table.push([
                Cell::text(simulator),
                Cell::text(name),
                Cell::text(hits.len().to_string()),
                Cell::text(format!("{:.2}", right as f64 / hits.len() as f64)),
                Cell::text(format!("{low:.2} to {high:.2}")),
            ]);
        };
        let of = |keep: &dyn Fn(&Score) -> bool, hit: &dyn Fn(&Score) -> bool| -> Vec<bool> {
            own.iter().filter(|s| keep(s)).map(|s| hit(s)).collect()
        };
        let single = |s: &Score| !NO_SINGLE.contains(&s.sealed.kind.as_str());
        add("first cause of single effects", of(&single, &|s| s.right));
        add(
            "false cause where none is withheld",
            of(&|s| s.sealed.kind == "none", &|s| !s.right),
        );
        add(
            "one of two named first",
            of(&|s| s.sealed.kind == "two", &|s| s.right),
        );
        add(
            "outside said to be unknown",
            of(&|s| s.sealed.kind == "outside", &|s| s.right),
        );
        add(
            "single effects with a cause beside",
            of(&single, &|s| !s.extra.is_empty()),
        );
        let covered = |kind: &str| -> Vec<bool> {
            let all = own.iter().flat_map(|s| &s.covered);
            all.filter(|(name, _)| (name == "controller kp") == (kind == "kp"))
                .map(|c| c.1)
                .collect()
        };
        add("90 % intervals of what was withheld", covered("withheld"));
        add("90 % intervals of gains", covered("kp"));
        let near = |s: &Score| s.delay_error <= (0.1 * s.sealed.period).max(2e-3);
        add(
            "delays within 2 ms or a tenth of the period",
            of(&|_| true, &near),
        );
        let gains = own.iter().filter_map(|s| s.gain_error);
        add("every kp within 5 %", gains.map(|e| e <= 0.05).collect());
        let all = |of: &dyn Fn(&Score) -> Vec<bool>| own.iter().flat_map(|s| of(s)).collect();
        add(
            "a kp within 5 % that the motion shows to 2 %",
            all(&|s| s.shown_gains.clone()),
        );
        let of_doubt = |kind: &str| {
            let each = own.iter().flat_map(|s| &s.doubts);
            each.filter(|d| d.0 == kind).map(|d| d.1).collect()
        };
        add("said to be inseparable that is", of_doubt("inseparable"));
        add("said to be hardly shown that is", of_doubt("little"));
        add("inseparable pairs that are said", all(&|s| s.pairs.clone()));
    }
    table
}

/// Table of the cases whose report is wrong, lists a false cause or misses an effect.
pub fn misses(scores: &[Score]) -> Table {
    let mut table = Table::new(
        [
            "case",
            "withheld",
            "first cause",
            "beside",
            "missed",
            "verdict",
        ]
        .map(Column::text),
    );
    for s in scores
        .iter()
        .filter(|s| !s.right || !s.extra.is_empty() || !s.missed.is_empty())
    {
        let place = |w: &super::effects::Withheld| {
            format!("{} {}", w.effect, w.joint.as_deref().unwrap_or("arm"))
        };
        let withheld: Vec<String> = s.sealed.withheld.iter().map(place).collect();
        let kind = if withheld.is_empty() {
            s.sealed.kind.clone()
        } else {
            withheld.join(", ")
        };
        table.push([
            Cell::text(s.id.clone()),
            Cell::text(kind),
            Cell::text(s.first.clone()),
            Cell::text(s.extra.join("; ")),
            Cell::text(s.missed.join("; ")),
            Cell::text(s.verdict.clone()),
        ]);
    }
    table
}

/// Table of how often causes of some confidence were withheld, and the exponent for their odds (see [`tempering`]).
pub fn calibration(scores: &[Score]) -> (Table, Option<f64>) {
    let said: Vec<(f64, bool)> = scores.iter().flat_map(|s| s.said.iter().copied()).collect();
    let mut table = Table::new([
        Column::text("confidence"),
        Column::number("causes"),
        Column::number("said"),
        Column::number("right"),
    ]);
    for [low, high] in [[0.5, 0.7], [0.7, 0.9], [0.9, 0.99], [0.99, 1.01]] {
        let own: Vec<&(f64, bool)> = said.iter().filter(|s| s.0 >= low && s.0 < high).collect();
        if own.is_empty() {
            continue;
        }
        let count = own.len() as f64;
        let right = own.iter().filter(|s| s.1).count() as f64;
        table.push([
            Cell::text(format!("{low} to {}", high.min(1.0))),
            Cell::text(own.len().to_string()),
            Cell::text(format!(
                "{:.2}",
                own.iter().map(|s| s.0).sum::<f64>() / count
            )),
            Cell::text(format!("{:.2}", right / count)),
        ]);
    }
    (table, tempering(&said))
}
