//! What the numbers that matter most do at half and at double their value, on the same cases.

use super::score::{Score, judge};
use super::{ProveError, folder_of, json, report_of};
use diagnose::Options;
use rayon::prelude::*;
use report::{Cell, Column, Table};
use serde_json::Value;
use std::path::Path;
use std::sync::OnceLock;
use trials::SimulateError;
use trials::cases::{Case, CaseSpec, draw, draw_hard, generate, name};

/// Those numbers.
const NUMBERS: [&str; 10] = [
    "search.enough",
    "search.cost",
    "search.inertial_tolerance",
    "search.friction_tolerance",
    "search.memories",
    "search.leftover",
    "search.visible",
    "search.plainly",
    "traces.contact.height",
    "measure.verdict.clear",
];

/// What each is multiplied by.
const FACTORS: [f64; 2] = [0.5, 2.0];

/// A number that is another.
#[derive(Clone, Debug)]
struct Variant {
    name: &'static str,
    factor: f64,
    options: Options,
}

/// Scores of all cases, with the numbers as they are and with each at half and at double.
pub struct Tried {
    usual: Vec<Score>,
    variants: Vec<(Variant, Vec<Score>)>,
}

/// How many diagnoses a run of some cases takes.
pub fn diagnoses(cases: u64) -> u64 {
    cases * (1 + NUMBERS.len() * FACTORS.len()) as u64
}

/// Diagnoses cases, every other one hard, with every variant. Reports go into `out`, a folder for each variant, and one that is
/// there already is scored as it is.
///
/// # Errors
/// The first case that fails.
pub fn run(
    cases: u64,
    seed: u64,
    out: Option<&Path>,
    done: impl Fn() + Sync,
) -> Result<Tried, ProveError> {
    let usual = Options {
        surrogates: 0,
        ..Options::default()
    };
    let variants = variants(&usual);
    let mut tried = Tried {
        usual: Vec::new(),
        variants: variants.into_iter().map(|v| (v, Vec::new())).collect(),
    };
    for index in 0..cases {
        let spec = match index % 2 {
            0 => draw(index / 2, seed),
            _ => draw_hard(index / 2, seed),
        };
        let case = OneCase {
            id: name(&spec, seed),
            spec,
            seed,
            made: OnceLock::new(),
            out,
        };
        let score = |folder: &str, options: &Options| {
            let scored = case.scored(folder, options);
            done();
            scored
        };
        let others = || {
            let each = tried.variants.par_iter();
            each.map(|(v, _)| score(&format!("{}_{}", v.name, v.factor), &v.options))
                .collect::<Result<Vec<Score>, _>>()
        };
        let (own, others) = rayon::join(|| score("usual", &usual), others);
        tried.usual.push(own?);
        for ((_, scores), score) in tried.variants.iter_mut().zip(others?) {
            scores.push(score);
        }
    }
    Ok(tried)
}

/// A case that is made once something has to be diagnosed on it.
struct OneCase<'a> {
    id: String,
    spec: CaseSpec,
    seed: u64,
    made: OnceLock<Result<Box<Case>, SimulateError>>,
    out: Option<&'a Path>,
}

fn variants(usual: &Options) -> Vec<Variant> {
    let of = |name: &'static str| {
        FACTORS.map(|factor| {
            let settings = usual.settings.scaled(name, factor);
            Variant {
                name,
                factor,
                options: Options {
                    settings: settings.unwrap_or_else(|| unreachable!("{name} is a setting")),
                    ..usual.clone()
                },
            }
        })
    };
    NUMBERS.into_iter().flat_map(of).collect()
}

impl OneCase<'_> {
    /// Its score, from the report in `folder` where there is one.
    fn scored(&self, folder: &str, options: &Options) -> Result<Score, ProveError> {
        let folder = self.out.map(|out| out.join(folder));
        let file = folder.as_ref().map(|f| f.join(format!("{}.json", self.id)));
        let kept = file.as_ref().and_then(|f| std::fs::read_to_string(f).ok());
        let kept: Option<Value> = kept.and_then(|text| serde_json::from_str(&text).ok());
        if let Some(kept) = kept {
            return Ok(judge(&kept["truth"], &kept["report"]));
        }
        let made = self
            .made
            .get_or_init(|| generate(&self.spec, self.seed).map(Box::new));
        let case = made.as_ref().map_err(|e| ProveError::Made {
            case: self.id.clone(),
            error: e.to_string(),
        })?;
        let (truth, found) = (json(&case.truth), report_of(case, options)?);
        if let (Some(folder), Some(file)) = (&folder, &file) {
            folder_of(folder)?;
            let both = serde_json::json!({"truth": truth, "report": found});
            report::write_atomic(file, format!("{both:#}"))?;
        }
        Ok(judge(&truth, &found))
    }
}

/// Scores with each number at half and at double, and in how many cases the first name, leniently, becomes right and wrong.
pub fn table(tried: &Tried) -> Table {
    let mut table = Table::new([
        Column::text("number"),
        Column::number("times"),
        Column::number("top-1*"),
        Column::number("lenient"),
        Column::number("becomes right"),
        Column::number("becomes wrong"),
        Column::number("false causes"),
        Column::number("unknown found"),
        Column::number("false unknown"),
    ]);
    let lenient = |s: &Score| s.lenient;
    let mut push = |name: &str, factor: Option<f64>, scores: &[Score]| {
        let all: Vec<&Score> = scores.iter().collect();
        let sum = |of: fn(&Score) -> Option<f64>| scores.iter().filter_map(of).sum::<f64>();
        let pairs = tried.usual.iter().zip(scores);
        let pairs = pairs.filter_map(|(a, b)| Some((lenient(a)?, lenient(b)?)));
        let (better, worse) = pairs.fold((0, 0), |(better, worse), (a, b)| {
            (better + usize::from(b > a), worse + usize::from(b < a))
        });
        let changed = |n: usize| match factor {
            Some(_) => Cell::number(n as f64, 0),
            None => Cell::missing(),
        };
        table.push([
            Cell::text(name),
            Cell::optional(factor, 1),
            Cell::optional(super::mean(&all, |s| s.top1), 2),
            Cell::optional(super::mean(&all, lenient), 2),
            changed(better),
            changed(worse),
            Cell::number(sum(|s| s.extra), 0),
            Cell::number(sum(|s| s.unknown_found), 0),
            Cell::number(sum(|s| s.false_unknown), 0),
        ]);
    };
    push("as they are", None, &tried.usual);
    for (variant, scores) in &tried.variants {
        push(variant.name, Some(variant.factor), scores);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_is_a_setting() {
        let variants = variants(&Options::default());
        assert_eq!(variants.len(), 20);
        let enough = Options::default().settings.search.enough;
        assert_eq!(variants[0].options.settings.search.enough, 0.5 * enough);
    }

    #[test]
    fn what_changes_is_counted_case_by_case() {
        let score = |lenient| Score {
            lenient: Some(lenient),
            ..Score::default()
        };
        let usual = vec![score(1.0), score(0.0), score(0.0)];
        let other = vec![score(0.0), score(1.0), score(1.0)];
        let variant = variants(&Options::default()).remove(0);
        let text = table(&Tried {
            usual,
            variants: vec![(variant, other)],
        })
        .to_text();
        let row = text.lines().find(|l| l.contains("search.enough")).unwrap();
        let cells: Vec<&str> = row.split_whitespace().collect();
        assert_eq!(&cells[..2], ["search.enough", "0.5"], "{text}");
        assert!(cells.windows(2).any(|w| w == ["2", "1"]), "{text}");
    }
}
