//! Before and after: simulated arms on two days between which one thing was changed, diagnosed from their files.

use super::sizes::size_error;
use super::{OUTSIDE, ProveError};
use diagnose::{Job, Subject};
use rayon::prelude::*;
use report::{Cell, Column, Table};
use serde_json::{Value, json};
use signal::proportion;
use signal::quantile::median;
use std::path::Path;
use trials::protocols::changed::{Change, Changed, changed};
use trials::protocols::payload::LoadedArm;

/// Outcome of a diagnosis on one pair of days.
#[derive(Clone, Debug)]
pub struct Told {
    /// Change of the robot between the two days.
    pub change: Change,
    /// Whether both days' motions are the same.
    pub again: bool,
    /// Whether the change is listed, on its joint where it has one; of no change, whether nothing is.
    pub right: bool,
    /// Whether any further cause of structure or friction is listed.
    pub more: bool,
    /// Whether the verdict is `unknown_effect`.
    pub unknown: bool,
    /// Error of the size, relative to the change; none where it was not listed, or of friction.
    pub error: Option<f64>,
}

/// Simulates and diagnoses `cases` pairs: every change on both arms, with the same motions and with others.
///
/// # Errors
/// The first pair that cannot be made, written or diagnosed.
pub fn run(cases: u64, seed: u64, done: impl Fn() + Sync) -> Result<Vec<Told>, ProveError> {
    let one = |index: u64| -> Result<Told, ProveError> {
        let change = Change::ALL[index as usize % Change::ALL.len()];
        let round = index as usize / Change::ALL.len();
        let arm = [LoadedArm::Ur5, LoadedArm::Seven][round % 2];
        let again = (round / 2).is_multiple_of(2);
        let own = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(index);
        let days = changed(arm, change, again, false, own)?;
        let folder = tempfile::tempdir().map_err(|source| trials::SimulateError::Write {
            path: std::env::temp_dir(),
            source,
        })?;
        days.write(folder.path())?;
        let report = diagnosed(folder.path()).map_err(|error| ProveError::Diagnose {
            case: format!("{} {index}", change.name()),
            error: Box::new(error),
        })?;
        done();
        Ok(judge(&days.truth, again, &report))
    };
    (0..cases).into_par_iter().map(one).collect()
}

fn diagnosed(folder: &Path) -> Result<Value, diagnose::DiagnoseError> {
    let at = |name: &str| folder.join(name);
    let robot = Subject::robot(at("robot.urdf").display().to_string());
    let job = Job {
        fast: true,
        ..Job::since(robot, vec![at("before.parquet")], vec![at("after.parquet")])
    };
    let done = job.run(|_| ())?;
    Ok(serde_json::from_str(&done.json()).expect("own JSON"))
}

/// Outcome of a report, judged against the true change.
fn judge(truth: &Changed, again: bool, report: &Value) -> Told {
    let empty = Vec::new();
    let causes = report["causes"].as_array().unwrap_or(&empty);
    let on_joint = |cause: &Value| {
        let joints = cause["joints"].as_array().unwrap_or(&empty);
        truth
            .joint
            .as_ref()
            .is_none_or(|j| joints.iter().any(|x| x == j))
    };
    let own = |cause: &&Value| cause["effect"] == truth.change.name() && on_joint(cause);
    let found = causes.iter().find(own);
    // Friction is one cause with all its joints.
    let wider = |cause: &Value| {
        let joints = cause["joints"].as_array().map_or(0, Vec::len);
        truth.joint.is_some() && joints > 1
    };
    Told {
        change: truth.change,
        again,
        right: found.is_some() || truth.change == Change::None && causes.is_empty(),
        more: causes.iter().any(|c| !own(&c)) || found.is_some_and(wider),
        unknown: report["verdict"] == "unknown_effect",
        error: found.and_then(|cause| size_error(&answer(truth), cause)),
    }
}

/// True change in the form in which a sealed case has an effect. Factors on friction are left out, for a report states
/// no such size.
fn answer(truth: &Changed) -> Value {
    let parameters = match (truth.change, truth.vector) {
        (Change::Payload, _) => json!({"mass": truth.size}),
        (Change::TorqueGain, _) => json!({"gain": truth.size}),
        (Change::EncoderOffset, _) => json!({"zero": truth.size}),
        (Change::BaseTilt, Some([x, y, _])) => json!({"tilt_x": x, "tilt_y": y}),
        _ => json!({}),
    };
    json!({"effect": truth.change.name(), "parameters": parameters})
}

/// The answers by change and motion.
pub fn table(told: &[Told]) -> Table {
    let mut table = Table::new([
        Column::text("change"),
        Column::text("motion"),
        Column::number("pairs"),
        Column::number("told"),
        Column::text("95 % interval"),
        Column::number("something else"),
        Column::number("unknown"),
        Column::number("error of the size, median"),
        Column::number("largest"),
    ]);
    for again in [true, false] {
        for change in Change::ALL {
            let own: Vec<&Told> = told
                .iter()
                .filter(|t| t.change == change && t.again == again)
                .collect();
            if own.is_empty() {
                continue;
            }
            let count = |of: fn(&Told) -> bool| own.iter().filter(|t| of(t)).count();
            let right = count(|t| t.right);
            let errors: Vec<f64> = own.iter().filter_map(|t| t.error).collect();
            let [low, high] = proportion::interval(right, own.len(), OUTSIDE);
            table.push([
                Cell::text(change.name()),
                Cell::text(if again { "the same" } else { "another" }),
                Cell::number(own.len() as f64, 0),
                Cell::number(right as f64, 0),
                Cell::text(format!("{low:.2}–{high:.2}")),
                Cell::number(count(|t| t.more) as f64, 0),
                Cell::number(count(|t| t.unknown) as f64, 0),
                Cell::optional(median(errors.clone()), 3),
                Cell::optional(errors.into_iter().reduce(f64::max), 3),
            ]);
        }
    }
    table
}
