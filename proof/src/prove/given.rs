//! Cases that stand in a folder, by whatever simulator.

use super::score::Score;
use super::{ProveError, folder_of, scored};
use diagnose::{Job, Subject};
use rayon::prelude::*;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Descriptions that a case may have, the first that is there being taken.
const DESCRIPTIONS: [&str; 2] = ["robot.urdf", "robot.xml"];

/// Names of the cases in a folder, `cases/NAME` with an answer `truth/NAME.json`.
///
/// # Errors
/// A folder without any.
pub fn names(folder: &Path) -> Result<Vec<String>, ProveError> {
    let fail = |error| ProveError::Given {
        path: folder.display().to_string(),
        error,
    };
    let entries = std::fs::read_dir(folder.join("cases")).map_err(fail)?;
    let mut names: Vec<String> = entries
        .filter_map(|e| e.ok()?.file_name().into_string().ok())
        .filter(|name| truth(folder, name).is_file())
        .collect();
    names.sort_unstable();
    if names.is_empty() {
        return Err(fail(std::io::ErrorKind::NotFound.into()));
    }
    Ok(names)
}

fn truth(folder: &Path, name: &str) -> PathBuf {
    folder.join("truth").join(format!("{name}.json"))
}

/// Diagnoses the cases of a folder and scores the reports by `truth/NAME.json`. Each case is
/// `cases/NAME/{robot.urdf or robot.xml, train.parquet, test.parquet}` and perhaps a `drive.toml`. Reports are
/// written to `folder/reports`; an existing report is scored unchanged.
///
/// # Errors
/// The first case that fails.
pub fn given(
    folder: &Path,
    names: &[String],
    fast: bool,
    done: impl Fn() + Sync,
) -> Result<Vec<Score>, ProveError> {
    folder_of(&folder.join("reports"))?;
    let of = |name: &String| {
        let score = scored(Some(folder), name, || one(folder, name, fast))?;
        done();
        Ok(score)
    };
    names.par_iter().map(of).collect()
}

/// Answer of a case and the report on it.
fn one(folder: &Path, name: &str, fast: bool) -> Result<(Value, Value), ProveError> {
    let case = folder.join("cases").join(name);
    let read = |path: &Path| {
        let text = std::fs::read_to_string(path)?;
        serde_json::from_str(&text).map_err(std::io::Error::other)
    };
    let path = truth(folder, name);
    let truth = read(&path).map_err(|error| ProveError::Given {
        path: path.display().to_string(),
        error,
    })?;
    let described = DESCRIPTIONS.map(|file| case.join(file));
    let robot = described
        .iter()
        .find(|p| p.is_file())
        .unwrap_or(&described[0]);
    let drive = case.join("drive.toml");
    let subject = Subject::robot(robot.display().to_string());
    let job = Job {
        drive: drive.is_file().then_some(drive),
        fast,
        ..Job::new(
            subject,
            vec![case.join("train.parquet")],
            case.join("test.parquet"),
        )
    };
    let outcome = job.run(|_| ()).map_err(|error| ProveError::Diagnose {
        case: name.to_owned(),
        error: Box::new(error),
    })?;
    Ok((truth, super::json(&outcome.outcome.diagnosis)))
}
