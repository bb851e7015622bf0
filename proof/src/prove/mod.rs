//! The proof: sealed simulated cases with a withheld effect, diagnosed and scored.

mod answer;
pub(crate) mod by_drawn;
mod calibration;
pub mod changed;
mod drawn;
mod error;
mod faults;
pub mod given;
mod headline;
pub(crate) mod missed;
mod named;
pub(crate) mod rates;
mod reliability;
mod score;
mod sizes;
pub mod thresholds;
mod withheld;

use diagnose::{Choice, Effect, NominalModel, Options, diagnose};
use physics::robot::Robot;
use rayon::prelude::*;
use report::{Cell, Column, Table};
use serde::Serialize;
use serde_json::Value;
use signal::quantile::median;
use std::path::{Path, PathBuf};
use trials::cases::{
    Case, CaseSpec, EFFECTS, Kind, Sensors, draw, draw_hard, draw_without, generate, generate_with,
    name, write,
};

pub use by_drawn::table as drawn_table;
pub use calibration::{left_out, table as weights_table};
pub use drawn::Drawn;
pub use error::ProveError;
pub use faults::{false_table, missed_table};
pub use headline::{Headline, Stored, StoredCase};
pub use missed::Missed;
pub use named::Named;
pub use rates::table as rates_table;
pub use reliability::{said, table as reliability_table};
pub use score::{Score, judge, mean};
pub use sizes::detected_from;
pub use withheld::{Instead, LeftOut, table as withheld_table};

/// Probability that the interval of a rate does not contain the true rate.
const OUTSIDE: f64 = 0.05;

/// Kinds of case that withhold none, several or an unlisted effect.
const NO_SINGLE: [&str; 4] = ["none", "outside", "two", "two_same_joint"];

/// Choice of the cases that a proof draws.
#[derive(Debug, Clone, Copy)]
pub struct Draw<'a> {
    /// Number of cases to be drawn.
    pub cases: u64,
    /// Seed from which the cases are drawn.
    pub seed: u64,
    /// Whether the cases come nearer to real recordings.
    pub hard: bool,
    /// Kind of case, by name, to which the run is limited: as many of that kind, as a longer run of the same seed has them.
    pub only: Option<&'a str>,
    /// Effect that is not drawn, as before it entered the catalogue: an index into [`EFFECTS`].
    pub without: Option<usize>,
    /// Version of the generator.
    pub generator: u8,
    /// Sensors beyond the motors' own.
    pub sensors: Sensors,
}

/// Draws, simulates, diagnoses and scores cases. With `out` it writes `cases/`, `truth/` and `reports/` into
/// it. An existing report there is scored unchanged, so that an interrupted run continues.
///
/// # Errors
/// The first case that fails, or a kind that does not exist.
pub fn prove(
    wanted: &Draw,
    options: &Options,
    out: Option<&Path>,
    done: impl Fn() + Sync,
) -> Result<Vec<Score>, ProveError> {
    let (seed, sensors) = (wanted.seed, wanted.sensors);
    let specs = specs(wanted)?;
    if let Some(out) = out {
        folder_of(&out.join("reports"))?;
    }
    specs
        .into_par_iter()
        .map(|spec| {
            let id = name(&spec, seed);
            if let Some(out) = out
                && let Some((truth, _)) = stored(out, &id)
            {
                same_draw(&truth, out, &id, &spec)?;
            }
            let score = scored(out, &id, || {
                let case = generate_with(&spec, seed, sensors)?;
                let found = report_of(&case, options)?;
                if let Some(out) = out {
                    write(&case, out)?;
                }
                Ok((json(&case.truth), found))
            })?;
            done();
            Ok(score)
        })
        .collect()
}

/// Cases of a draw.
///
/// # Errors
/// A kind that does not exist.
pub(crate) fn specs(wanted: &Draw) -> Result<Vec<CaseSpec>, ProveError> {
    let Draw {
        cases,
        seed,
        hard,
        only,
        without,
        generator,
        ..
    } = *wanted;
    let draw = |index| match hard {
        true => draw_hard(index, seed),
        false => draw_without(index, seed, without),
    };
    let kinds: &[&str] = if hard {
        &["none", "outside", "two_same_joint", "contact_at_rest"]
    } else {
        &["none", "outside", "two"]
    };
    let drawn = EFFECTS.iter().enumerate();
    let drawn = drawn.filter(|(i, _)| Some(*i) != without);
    let kinds = drawn.map(|(_, effect)| effect).chain(kinds).copied();
    if let Some(name) = only.filter(|name| !kinds.clone().any(|k| k == *name)) {
        return Err(ProveError::Kind {
            name: name.to_owned(),
            kinds: kinds.collect::<Vec<_>>().join(", "),
        });
    }
    Ok((0..)
        .map(|index| draw(index).by(generator))
        .filter(|spec| only.is_none_or(|name| spec.kind.name() == name))
        .take(cases as usize)
        .collect())
}

/// Score of a case, by the report that an earlier run has left in a folder, or else by the answer and report that are `made`, which is written
/// into its `reports`.
fn scored(
    folder: Option<&Path>,
    id: &str,
    made: impl FnOnce() -> Result<(Value, Value), ProveError>,
) -> Result<Score, ProveError> {
    if let Some((truth, found)) = folder.and_then(|f| stored(f, id)) {
        return Ok(Score {
            stored: true,
            ..judge(&truth, &found)
        });
    }
    let (truth, found) = made()?;
    if let Some(folder) = folder {
        let path = folder.join("reports").join(format!("{id}.json"));
        report::write_atomic(&path, format!("{found:#}"))?;
    }
    Ok(judge(&truth, &found))
}

/// Refuses a folder whose case of that name is of another kind or by another generator: other draws deal other cases under the same names.
pub(crate) fn same_draw(
    truth: &Value,
    folder: &Path,
    id: &str,
    spec: &CaseSpec,
) -> Result<(), ProveError> {
    let generator = truth["generator"].as_u64().unwrap_or(1);
    if truth["kind"] == spec.kind.name() && generator == u64::from(spec.generator) {
        return Ok(());
    }
    Err(ProveError::Other {
        path: folder.display().to_string(),
        case: id.to_owned(),
        kind: truth["kind"].as_str().unwrap_or_default().to_owned(),
        generator,
    })
}

/// A folder that is there from now on.
pub(crate) fn folder_of(path: &Path) -> Result<PathBuf, ProveError> {
    let made = std::fs::create_dir_all(path).map_err(|error| ProveError::Folder {
        path: path.display().to_string(),
        error,
    });
    made.map(|()| path.to_owned())
}

/// Answer of a case and report on it, where an earlier run has left both: the report is written last.
pub(crate) fn stored(folder: &Path, id: &str) -> Option<(Value, Value)> {
    let read = |kind: &str| {
        let path = folder.join(kind).join(format!("{id}.json"));
        serde_json::from_str(&std::fs::read_to_string(path).ok()?).ok()
    };
    Some((read("truth")?, read("reports")?))
}

/// Scores of all cases that an earlier run has left in a folder, by name of the case.
///
/// # Errors
/// A folder without any.
pub fn kept(folder: &Path) -> Result<Vec<Score>, ProveError> {
    let fail = |error| ProveError::Kept {
        path: folder.display().to_string(),
        error,
    };
    let files = std::fs::read_dir(folder.join("reports")).map_err(fail)?;
    let paths = files.filter_map(|f| Some(f.ok()?.path()));
    let mut ids: Vec<String> = paths
        .filter_map(|p| Some(p.file_stem()?.to_str()?.to_owned()))
        .collect();
    ids.sort_unstable();
    let answers = ids.iter().filter_map(|id| stored(folder, id));
    let scores: Vec<Score> = answers
        .map(|(truth, found)| judge(&truth, &found))
        .collect();
    if scores.is_empty() {
        return Err(fail(std::io::ErrorKind::NotFound.into()));
    }
    Ok(scores)
}

/// The cases with one effect, each diagnosed with that effect's candidates taken out of the catalogue. Changes of
/// parameters stay in: they are not candidates of the catalogue.
///
/// # Errors
/// The first case that fails.
pub fn leave_one_out(
    cases: u64,
    seed: u64,
    generator: u8,
    done: impl Fn() + Sync,
) -> Result<Vec<LeftOut>, ProveError> {
    let of = |index: u64| -> Result<Option<LeftOut>, ProveError> {
        let spec = draw(index, seed).by(generator);
        let Some(effect) = single(spec.kind).filter(|e| !e.info().parameter) else {
            done();
            return Ok(None);
        };
        let case = generate(&spec, seed)?;
        let options = Options {
            effects: Choice::Without(effect),
            ..Options::default()
        };
        let found = report_of(&case, &options)?;
        done();
        Ok(Some(withheld::judge(effect, &json(&case.truth), &found)))
    };
    let all: Result<Vec<Option<LeftOut>>, _> = (0..cases).into_par_iter().map(of).collect();
    Ok(all?.into_iter().flatten().collect())
}

pub(crate) fn single(kind: Kind) -> Option<Effect> {
    let Kind::Single(e) = kind else { return None };
    Effect::ALL.into_iter().find(|x| x.name() == EFFECTS[e])
}

/// Report of a diagnosis of one case, as JSON.
pub(crate) fn report_of(case: &Case, options: &Options) -> Result<Value, ProveError> {
    let fail = |error| ProveError::Diagnose {
        case: case.id.clone(),
        error: Box::new(error),
    };
    let robot = Robot::from_urdf_str(&case.urdf).map_err(|e| fail(e.into()))?;
    let model = NominalModel::new(robot);
    let outcome = diagnose(&model, &case.train, &case.test, options).map_err(fail)?;
    Ok(json(&outcome.diagnosis))
}

/// A report or an answer as the scores read it.
fn json(of: &impl Serialize) -> Value {
    serde_json::to_value(of).expect("fields with names, numbers and strings")
}

/// Scores by kind of case, singles together, and the rates that only some kinds have.
pub fn table(scores: &[Score]) -> Table {
    let mut kinds: Vec<&str> = scores.iter().map(|s| s.kind.as_str()).collect();
    kinds.sort_unstable();
    kinds.dedup();
    let heads = [
        "top-1*",
        "lenient",
        "top-3",
        "found",
        "joint",
        "closure",
        "extra",
        "false alarm",
        "unknown found",
        "false unknown",
        "false no gap",
        "size error",
        "size off, deviations",
        "size covered",
        "found from %",
    ];
    let mut columns = vec![Column::text("truth"), Column::number("cases")];
    columns.extend(heads.map(Column::number));
    let mut table = Table::new(columns);
    let mut push = |name: &str, of: Vec<&Score>| {
        let cell = |f: fn(&Score) -> Option<f64>| Cell::optional(mean(&of, f), 2);
        table.push([
            Cell::text(name),
            Cell::number(of.len() as f64, 0),
            cell(|s| s.top1),
            cell(|s| s.lenient),
            cell(|s| s.top3),
            cell(|s| s.found),
            cell(|s| s.joint),
            cell(|s| s.closure),
            cell(|s| s.extra),
            cell(|s| s.false_alarm),
            cell(|s| s.unknown_found),
            cell(|s| s.false_unknown),
            cell(|s| s.false_no_gap),
            Cell::optional(median(of.iter().filter_map(|s| s.size).collect()), 2),
            Cell::optional(
                median(of.iter().filter_map(|s| s.off.map(f64::abs)).collect()),
                2,
            ),
            cell(|s| s.covered),
            Cell::optional(
                detected_from(of.iter().filter_map(|s| s.detection).collect()).map(|s| 100.0 * s),
                0,
            ),
        ]);
    };
    for kind in kinds {
        push(kind, scores.iter().filter(|s| s.kind == kind).collect());
    }
    push(
        "all single",
        scores
            .iter()
            .filter(|s| !NO_SINGLE.contains(&s.kind.as_str()))
            .collect(),
    );
    push("all", scores.iter().collect());
    table.emphasise_last()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_earlier_run_is_scored_where_answer_and_report_are_there() {
        let folder = tempfile::tempdir().unwrap();
        assert!(matches!(kept(folder.path()), Err(ProveError::Kept { .. })));
        for kind in ["truth", "reports"] {
            std::fs::create_dir(folder.path().join(kind)).unwrap();
        }
        let file = |kind: &str, id: &str, text: &str| {
            let path = folder.path().join(kind).join(format!("{id}.json"));
            std::fs::write(path, text).unwrap();
        };
        file("truth", "a", r#"{"kind": "none", "effects": []}"#);
        file("reports", "a", r#"{"verdict": "no_gap", "causes": []}"#);
        file("reports", "b", r#"{"verdict": "no_gap", "causes": []}"#);
        let scores = kept(folder.path()).unwrap();
        assert_eq!((scores.len(), scores[0].false_alarm), (1, Some(0.0)));

        // Another draw deals other kinds under the same names.
        let spec = |kind, generator| CaseSpec {
            index: 0,
            kind,
            hard: false,
            without: None,
            generator,
        };
        let none = spec(Kind::None, 1);
        let (truth, _) = stored(folder.path(), "a").unwrap();
        assert!(stored(folder.path(), "b").is_none(), "no answer");
        assert!(same_draw(&truth, folder.path(), "a", &none).is_ok());
        for other in [spec(Kind::Outside, 1), spec(Kind::None, 2)] {
            let refused = same_draw(&truth, folder.path(), "a", &other);
            assert!(matches!(refused, Err(ProveError::Other { .. })));
        }
    }

    #[test]
    fn a_kind_that_is_left_out_is_not_drawn_for_ever() {
        let draw = Draw {
            cases: 1,
            seed: 1,
            hard: false,
            only: Some("payload"),
            without: trials::cases::effect_index("payload"),
            generator: 1,
            sensors: Sensors::default(),
        };
        let refused = prove(&draw, &Options::default(), None, || ());
        assert!(matches!(refused, Err(ProveError::Kind { .. })));
    }
}
