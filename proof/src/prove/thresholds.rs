//! Sensitivity of the results to the most important thresholds, at half and double their value, and to special
//! rules switched off, on the same cases.

use super::headline::Headline;
use super::score::{Score, judge};
use super::{ProveError, folder_of, json, same_draw};
use diagnose::settings::{Rule, Settings};
use diagnose::{DiagnoseError, NominalModel, Options, Outcome, Prepared, diagnose};
use physics::robot::Robot;
use rayon::prelude::*;
use report::{Cell, Column, Table};
use serde_json::{Value, json};
use std::path::Path;
use trials::cases::{Case, CaseSpec, draw, draw_hard, generate};

/// Names of the thresholds that are scaled.
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

/// Factors on each threshold.
const FACTORS: [f64; 2] = [0.5, 2.0];

/// Variant of the settings: one threshold scaled, or one rule off.
#[derive(Clone, Debug)]
struct Variant {
    name: String,
    /// Factor on a threshold; none for a rule.
    factor: Option<f64>,
    /// Rules that are switched off.
    rules: Vec<Rule>,
    options: Options,
}

/// Variants that are tried beside the defaults.
#[derive(Clone, Debug)]
pub enum Trial {
    /// Thresholds that matter most, at half and at double their value.
    Numbers,
    /// Special rules, each switched off alone.
    Off(Vec<Rule>),
    /// Several rules switched off together.
    OffTogether(Vec<Rule>),
}

/// Choice of the cases: every other one is hard.
#[derive(Clone, Copy, Debug)]
pub struct Cases {
    /// Number of cases to be drawn.
    pub count: u64,
    /// Seed from which the cases are drawn.
    pub seed: u64,
    /// Version of the generator.
    pub generator: u8,
    /// Largest number of joints of an arm: smaller arms are diagnosed sooner.
    pub joints: usize,
}

impl Cases {
    /// The cases in the order in which they are diagnosed: of either kind those that the seed deals first.
    pub fn made(self) -> impl Iterator<Item = Result<(CaseSpec, Case), ProveError>> {
        let dealt = move |hard: bool| {
            let draw = if hard { draw_hard } else { draw };
            let each = (0..).map(move |index| {
                let spec = draw(index, self.seed).by(self.generator);
                Ok((spec, generate(&spec, self.seed)?))
            });
            each.filter(move |made: &Result<(CaseSpec, Case), ProveError>| {
                let small = |(_, case): &(CaseSpec, Case)| case.truth.joints <= self.joints;
                made.as_ref().map_or(true, small)
            })
        };
        let (mut plain, mut hard) = (dealt(false), dealt(true));
        let next = move |k: u64| {
            if k.is_multiple_of(2) {
                plain.next()
            } else {
                hard.next()
            }
        };
        (0..self.count).filter_map(next)
    }
}

/// Score and headline of a report.
struct Judged {
    score: Score,
    headline: Headline,
}

/// Scores of all cases, with the default settings and with each variant.
pub struct Tried {
    usual: Vec<Judged>,
    variants: Vec<(Variant, Vec<Judged>)>,
}

/// Number of diagnoses that a run of `cases` cases takes.
pub fn diagnoses(cases: u64, trial: &Trial) -> u64 {
    cases * (1 + variants(&Options::default(), trial).len()) as u64
}

/// Diagnoses cases with every variant. Reports are written to `out`, a folder for each variant; an existing
/// report is scored unchanged.
///
/// # Errors
/// The first case that fails.
pub fn run(
    cases: impl Iterator<Item = Result<(CaseSpec, Case), ProveError>>,
    trial: &Trial,
    out: Option<&Path>,
    done: impl Fn() + Sync,
) -> Result<Tried, ProveError> {
    let usual = Options {
        surrogates: 0,
        ..Options::default()
    };
    let variants = variants(&usual, trial);
    let mut tried = Tried {
        usual: Vec::new(),
        variants: variants.into_iter().map(|v| (v, Vec::new())).collect(),
    };
    for made in cases {
        let (spec, case) = made?;
        let case = OneCase { spec, case, out };
        let robot = Robot::from_urdf_str(&case.case.urdf).map_err(|e| case.fails(e.into()))?;
        let model = NominalModel::new(robot);
        let (usual, prepared) = case.usual(&model, &usual)?;
        // The recordings are prepared once for all rules; thresholds may be those of the preparation.
        let prepared = prepared.filter(|_| !matches!(trial, Trial::Numbers));
        done();
        let each = tried.variants.par_iter().map(|(v, _)| {
            // A rule that decided nothing changes nothing.
            let same = !v.rules.is_empty() && !v.rules.iter().any(|r| usual.decided(*r));
            let report = if same {
                Ok(usual.clone())
            } else {
                case.report(&v.folder(), &v.options, |options| match &prepared {
                    Some(prepared) => prepared.diagnose(options),
                    None => case.diagnosed(&model, options),
                })
            };
            done();
            report.map(|r| r.judged())
        });
        let others: Vec<Judged> = each.collect::<Result<_, ProveError>>()?;
        tried.usual.push(usual.judged());
        for ((_, all), one) in tried.variants.iter_mut().zip(others) {
            all.push(one);
        }
    }
    Ok(tried)
}

/// A case, and where its reports are kept.
struct OneCase<'a> {
    spec: CaseSpec,
    case: Case,
    out: Option<&'a Path>,
}

fn variants(usual: &Options, trial: &Trial) -> Vec<Variant> {
    let with = |name: &str, factor, rules: &[Rule], settings| Variant {
        name: name.to_owned(),
        factor,
        rules: rules.to_vec(),
        options: Options {
            settings,
            ..usual.clone()
        },
    };
    let settings = &usual.settings;
    match trial {
        Trial::Numbers => {
            let of = |name: &'static str| {
                FACTORS.map(|factor| {
                    let scaled = settings.scaled(name, factor);
                    let scaled = scaled.unwrap_or_else(|| unreachable!("{name} is a setting"));
                    with(name, Some(factor), &[], scaled)
                })
            };
            NUMBERS.into_iter().flat_map(of).collect()
        }
        Trial::Off(rules) => {
            let each = rules.iter();
            each.map(|r| with(r.name(), None, &[*r], settings.without(*r)))
                .collect()
        }
        Trial::OffTogether(rules) => {
            let off = |settings: Settings, rule: &Rule| settings.without(*rule);
            let names: Vec<&str> = rules.iter().map(|r| r.name()).collect();
            let all = rules.iter().fold(settings.clone(), off);
            vec![with(&names.join("+"), None, rules, all)]
        }
    }
}

impl Variant {
    /// Name of the folder for this variant's reports.
    fn folder(&self) -> String {
        match self.factor {
            Some(factor) => format!("{}_{factor}", self.name),
            None => format!("off_{}", self.name),
        }
    }
}

/// Report on a case, with the answer and the special rules that decided.
#[derive(Clone)]
struct Report(Value);

impl OneCase<'_> {
    /// The report with the defaults, and the prepared recordings where it was not there already.
    fn usual<'m>(
        &'m self,
        model: &'m NominalModel,
        options: &Options,
    ) -> Result<(Report, Option<Prepared<'m>>), ProveError> {
        let mut kept = None;
        let pair = [&self.case.train, &self.case.test];
        let report = self.report("usual", options, |options| {
            let (prepared, outcome) = Prepared::new(model, pair, options)?;
            kept = Some(prepared);
            Ok(outcome)
        })?;
        Ok((report, kept))
    }

    fn diagnosed(&self, model: &NominalModel, options: &Options) -> Result<Outcome, DiagnoseError> {
        diagnose(model, &self.case.train, &self.case.test, options)
    }

    /// The report in `folder` where there is one, else a new one by `diagnose`.
    fn report(
        &self,
        folder: &str,
        options: &Options,
        diagnose: impl FnOnce(&Options) -> Result<Outcome, DiagnoseError>,
    ) -> Result<Report, ProveError> {
        let id = &self.case.id;
        let file = self
            .out
            .map(|out| out.join(folder).join(format!("{id}.json")));
        let kept = file.as_ref().and_then(|f| std::fs::read_to_string(f).ok());
        let kept: Option<Value> = kept.and_then(|text| serde_json::from_str(&text).ok());
        if let (Some(kept), Some(out)) = (kept, self.out) {
            same_draw(&kept["truth"], out, id, &self.spec)?;
            return Ok(Report(kept));
        }
        let options = Options {
            settings: options.settings.afresh(),
            ..options.clone()
        };
        let outcome = diagnose(&options).map_err(|e| self.fails(e))?;
        let off = &options.settings.search.off;
        let decided = Rule::ALL.into_iter().filter(|r| off.decided(*r));
        let decided: Vec<&str> = decided.map(Rule::name).collect();
        let (truth, found) = (json(&self.case.truth), json(&outcome.diagnosis));
        let report = Report(json!({"truth": truth, "decided": decided, "report": found}));
        if let (Some(out), Some(file)) = (self.out, &file) {
            folder_of(&out.join(folder))?;
            report::write_atomic(file, format!("{:#}", report.0))?;
        }
        Ok(report)
    }

    fn fails(&self, error: DiagnoseError) -> ProveError {
        ProveError::Diagnose {
            case: self.case.id.clone(),
            error: Box::new(error),
        }
    }
}

impl Report {
    /// Whether a rule decided anything.
    fn decided(&self, rule: Rule) -> bool {
        let all = self.0["decided"].as_array();
        all.is_none_or(|all| all.iter().any(|r| r == rule.name()))
    }

    fn judged(&self) -> Judged {
        let (truth, report) = (&self.0["truth"], &self.0["report"]);
        Judged {
            score: judge(truth, report),
            headline: Headline::of(report),
        }
    }
}

/// Table of scores by variant. It counts the cases in which the first name, leniently, becomes right or wrong,
/// and those in which any other cause or the verdict changes.
pub fn table(tried: &Tried) -> Table {
    let mut table = Table::new([
        Column::text("other"),
        Column::number("times"),
        Column::number("top-1*"),
        Column::number("lenient"),
        Column::number("becomes right"),
        Column::number("becomes wrong"),
        Column::number("first changed"),
        Column::number("answer changed"),
        Column::number("false causes"),
        Column::number("unknown found"),
        Column::number("false unknown"),
    ]);
    let lenient = |s: &Score| s.lenient;
    let mut push = |variant: Option<&Variant>, all: &[Judged]| {
        let scores: Vec<&Score> = all.iter().map(|j| &j.score).collect();
        let sum = |of: fn(&Score) -> Option<f64>| scores.iter().filter_map(|s| of(s)).sum::<f64>();
        let pairs = || tried.usual.iter().zip(all);
        let names = pairs().filter_map(|(a, b)| Some((lenient(&a.score)?, lenient(&b.score)?)));
        let (better, worse) = names.fold((0, 0), |(better, worse), (a, b)| {
            (better + usize::from(b > a), worse + usize::from(b < a))
        });
        let first = |(a, b): &(&Judged, &Judged)| a.headline.first() != b.headline.first();
        let any = |(a, b): &(&Judged, &Judged)| a.headline != b.headline;
        let changed = |n: usize| match variant {
            Some(_) => Cell::number(n as f64, 0),
            None => Cell::missing(),
        };
        table.push([
            Cell::text(variant.map_or("as it is", |v| &v.name)),
            Cell::optional(variant.and_then(|v| v.factor), 1),
            Cell::optional(super::mean(&scores, |s| s.top1), 2),
            Cell::optional(super::mean(&scores, lenient), 2),
            changed(better),
            changed(worse),
            changed(pairs().filter(first).count()),
            changed(pairs().filter(any).count()),
            Cell::number(sum(|s| s.extra), 0),
            Cell::number(sum(|s| s.unknown_found), 0),
            Cell::number(sum(|s| s.false_unknown), 0),
        ]);
    };
    push(None, &tried.usual);
    for (variant, all) in &tried.variants {
        push(Some(variant), all);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_is_a_setting() {
        let variants = variants(&Options::default(), &Trial::Numbers);
        assert_eq!(variants.len(), 20);
        let enough = Options::default().settings.search.enough;
        assert_eq!(variants[0].options.settings.search.enough, 0.5 * enough);
        assert_eq!(variants[0].folder(), "search.enough_0.5");
    }

    #[test]
    fn rules_are_off_alone_or_together() {
        let off = |v: &Variant, rule| v.options.settings.search.off.holds(rule);
        let rules = vec![Rule::Trace, Rule::Barred];
        let alone = variants(&Options::default(), &Trial::Off(rules.clone()));
        assert_eq!(alone.len(), 2);
        assert!(off(&alone[1], Rule::Barred) && !off(&alone[1], Rule::Trace));
        assert_eq!(alone[1].folder(), "off_barred");
        let [both] = &variants(&Options::default(), &Trial::OffTogether(rules))[..] else {
            panic!("one variant")
        };
        assert!(off(both, Rule::Barred) && off(both, Rule::Trace));
        assert_eq!(both.folder(), "off_trace+barred");
    }

    #[test]
    fn recordings_prepared_once_give_the_same_report() {
        let cases = Cases {
            count: 1,
            seed: 31,
            generator: 1,
            joints: 3,
        };
        let (_, case) = cases.made().next().unwrap().unwrap();
        let model = NominalModel::new(Robot::from_urdf_str(&case.urdf).unwrap());
        let usual = Options {
            surrogates: 0,
            ..Options::default()
        };
        let off = Options {
            settings: usual.settings.without(Rule::LinkPriors),
            ..usual.clone()
        };
        let pair = [&case.train, &case.test];
        let (prepared, outcome) = Prepared::new(&model, pair, &usual).unwrap();
        let anew = |options| {
            json(
                &diagnose(&model, pair[0], pair[1], options)
                    .unwrap()
                    .diagnosis,
            )
        };
        assert_eq!(json(&outcome.diagnosis), anew(&usual));
        let again = prepared.diagnose(&off).unwrap();
        assert_eq!(json(&again.diagnosis), anew(&off));
    }

    #[test]
    fn what_changes_is_counted_case_by_case() {
        let judged = |lenient, causes: &[&str]| Judged {
            score: Score {
                lenient: Some(lenient),
                ..Score::default()
            },
            headline: Headline {
                verdict: "explained".to_owned(),
                causes: causes.iter().map(|c| (*c).to_owned()).collect(),
            },
        };
        let usual = vec![
            judged(1.0, &["payload: a"]),
            judged(0.0, &["backlash: a"]),
            judged(0.0, &[]),
        ];
        let other = vec![
            judged(0.0, &["payload: a", "backlash: b"]),
            judged(1.0, &["payload: a"]),
            judged(1.0, &[]),
        ];
        let variant = variants(&Options::default(), &Trial::Numbers).remove(0);
        let text = table(&Tried {
            usual,
            variants: vec![(variant, other)],
        })
        .to_text();
        let row = text.lines().find(|l| l.contains("search.enough")).unwrap();
        let cells: Vec<&str> = row.split_whitespace().collect();
        assert_eq!(&cells[..2], ["search.enough", "0.5"], "{text}");
        // Becomes right, becomes wrong, first changed, answer changed.
        assert_eq!(&cells[4..8], ["2", "1", "1", "2"], "{text}");
    }
}
