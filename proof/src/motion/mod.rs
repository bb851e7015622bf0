//! Proof of `replay`: sealed cases of motion under drives are diagnosed, and the reports are scored.
//!
//! The robot that really moves is the project's plant, with mechanisms other than the fitted ones. Cases of another
//! simulator are scored from a folder with the same layout.

mod case;
mod command_line;
mod diagnosis;
mod effects;
mod files;
mod real;
mod score;
mod shown;
mod tables;

pub use case::{Case, Sealed, kind, make};
pub use command_line::{command, command_line};
pub use score::{REFUSED, Score, judge, tempering};
pub use shown::{Information, Shown};
pub use tables::{calibration, kinds, misses, rates};

use datasets::Part;
use rayon::prelude::*;
use replay::diagnosis::diagnose;
use replay::input::InputError;
use replay::simulate::Unstable;
use replay::{Options, Subject};
use serde_json::json;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Reason why a proof of `replay` cannot be run.
#[derive(Debug, thiserror::Error)]
pub enum MotionError {
    /// Case for which no robot was found that follows its commands and shows the effect; the number is its index.
    #[error(
        "no robot was found that shows what case {0} withholds; take another --seed or more --joints"
    )]
    None(u64),
    /// Bodies that make no robot.
    #[error(transparent)]
    Robot(#[from] physics::robot::RobotError),
    /// Recording that cannot be written.
    #[error(transparent)]
    Recording(#[from] datasets::WriteError),
    /// File that cannot be written.
    #[error(transparent)]
    Write(#[from] report::WriteError),
    /// File or folder that cannot be read or made.
    #[error("{}: {error}", path.display())]
    File {
        /// Path of the file or folder.
        path: PathBuf,
        /// Error of the operating system.
        error: std::io::Error,
    },
    /// Folder without any case.
    #[error("{}: no cases; cases/NAME with robot.urdf or robot.xml, train.parquet and test.parquet, and truth/NAME.json are needed", .0.display())]
    Empty(PathBuf),
    /// Case that `replay` refuses.
    #[error("case {case}: {error}")]
    Refused {
        /// Name of the case.
        case: String,
        /// Reason of the refusal.
        error: Box<InputError>,
    },
    /// Case whose simulator as given is unstable.
    #[error("case {case}: {error}")]
    Unstable {
        /// Name of the case.
        case: String,
        /// Instability that was found.
        error: Unstable,
    },
}

impl MotionError {
    /// Error for a file or folder.
    fn file(path: &Path, error: std::io::Error) -> Self {
        Self::File {
            path: path.to_owned(),
            error,
        }
    }
}

/// Draws cases, writes them into `folder`, diagnoses them and scores the reports. Cases that are there already are
/// kept. `done` is called with the name of each scored case.
///
/// # Errors
/// First case that fails.
pub fn prove(
    cases: u64,
    seed: u64,
    joints: usize,
    folder: &Path,
    done: impl Fn(&str) + Sync,
) -> Result<Vec<Score>, MotionError> {
    (0..cases).into_par_iter().try_for_each(|i| {
        let id = name(i);
        if folder.join("truth").join(format!("{id}.json")).is_file() {
            return Ok(());
        }
        write(&make(i, seed, joints)?, &id, folder)
    })?;
    let names: Vec<String> = (0..cases).map(name).collect();
    score_named(folder, &names, done)
}

/// Name of the case with index `i`.
fn name(i: u64) -> String {
    format!("motion-{i:04}")
}

/// Scores of all cases of a folder, sorted by name. Reports go into `folder/reports`; a report that is there already is
/// scored as it is. `done` is called with the name of each scored case.
///
/// # Errors
/// First case that fails.
pub fn score(folder: &Path, done: impl Fn(&str) + Sync) -> Result<Vec<Score>, MotionError> {
    let entries = std::fs::read_dir(folder.join("truth"));
    let entries = entries.map_err(|error| MotionError::file(&folder.join("truth"), error))?;
    let mut names: Vec<String> = entries
        .filter_map(|e| {
            Some(
                e.ok()?
                    .file_name()
                    .to_str()?
                    .strip_suffix(".json")?
                    .to_owned(),
            )
        })
        .collect();
    names.sort_unstable();
    if names.is_empty() {
        return Err(MotionError::Empty(folder.to_owned()));
    }
    score_named(folder, &names, done)
}

/// Scores of the named cases of a folder.
fn score_named(
    folder: &Path,
    names: &[String],
    done: impl Fn(&str) + Sync,
) -> Result<Vec<Score>, MotionError> {
    let reports = folder.join("reports");
    std::fs::create_dir_all(&reports).map_err(|error| MotionError::file(&reports, error))?;
    let of = |name: &String| {
        let score = one(folder, name)?;
        done(name);
        Ok(score)
    };
    names.par_iter().map(of).collect()
}

/// Score of one case, whose report is made and written unless it is there.
fn one(folder: &Path, name: &str) -> Result<Score, MotionError> {
    let read = |path: &Path| -> Result<String, MotionError> {
        std::fs::read_to_string(path).map_err(|error| MotionError::file(path, error))
    };
    let path = folder.join("truth").join(format!("{name}.json"));
    let invalid = |path: &Path, error: serde_json::Error| {
        MotionError::file(path, std::io::Error::other(error))
    };
    let sealed: Sealed = serde_json::from_str(&read(&path)?).map_err(|e| invalid(&path, e))?;
    let kept = folder.join("reports").join(format!("{name}.json"));
    if kept.is_file() {
        let report = serde_json::from_str(&read(&kept)?).map_err(|e| invalid(&kept, e))?;
        return Ok(judge(name, &sealed, &report, f64::NAN));
    }
    let started = Instant::now();
    let report = match said(&folder.join("cases").join(name), name) {
        Ok(report) => serde_json::to_value(&report).expect("a report is plain data"),
        // A recording in order that is refused is a wrong answer, and the proof goes on.
        Err(MotionError::Refused { error, .. }) => {
            json!({"verdict": REFUSED, "refusal": error.to_string(), "causes": []})
        }
        Err(error) => return Err(error),
    };
    let text = serde_json::to_string_pretty(&report).expect("a report is plain data");
    report::write_atomic(&kept, text)?;
    Ok(judge(
        name,
        &sealed,
        &report,
        started.elapsed().as_secs_f64(),
    ))
}

/// Report of `replay` on the case in the folder `case`.
fn said(case: &Path, name: &str) -> Result<replay::schema::Report, MotionError> {
    let refused = |error| MotionError::Refused {
        case: name.to_owned(),
        error: Box::new(error),
    };
    let robot = ["robot.urdf", "robot.xml"].map(|f| case.join(f));
    let robot = robot.iter().find(|p| p.is_file());
    let robot = robot.ok_or_else(|| MotionError::Empty(case.to_owned()))?;
    let drive = case.join("drive.toml");
    let drive = drive.is_file().then_some(drive.as_path());
    let subject = Subject::read(&robot.display().to_string(), &[], drive, None).map_err(refused)?;
    let recording = |file: &str, part: Part| -> Result<_, InputError> {
        let recordings = subject.recordings(&[case.join(file)], part)?;
        Ok(subject.prepared(&recordings)?.expect("one recording"))
    };
    let data = recording("train.parquet", Part::Train).map_err(refused)?;
    let heldout = recording("test.parquet", Part::Test).map_err(refused)?;
    let options = Options::default().fast(true);
    let outcome = diagnose(&subject.given, &data, &heldout, options, |_| ());
    let outcome = outcome.map_err(|error| MotionError::Unstable {
        case: name.to_owned(),
        error,
    })?;
    Ok(outcome.report)
}

/// Writes `cases/ID/{robot.urdf,drive.toml,train.parquet,test.parquet}` and `truth/ID.json` into `folder`.
///
/// # Errors
/// File that cannot be written.
pub fn write(case: &Case, id: &str, folder: &Path) -> Result<(), MotionError> {
    let (open, sealed) = (folder.join("cases").join(id), folder.join("truth"));
    for path in [&open, &sealed] {
        std::fs::create_dir_all(path).map_err(|error| MotionError::file(path, error))?;
    }
    for (name, recording) in ["train.parquet", "test.parquet"]
        .iter()
        .zip(&case.recordings)
    {
        datasets::write(recording, &open.join(name))?;
    }
    report::write_atomic(&open.join("robot.urdf"), &case.urdf)?;
    report::write_atomic(&open.join("drive.toml"), &case.drive)?;
    let text = serde_json::to_string_pretty(&case.sealed).expect("plain data");
    report::write_atomic(&sealed.join(format!("{id}.json")), text)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The plant's motors and those of the fit are coupled in different ways: its friction stays at the joints.
    #[test]
    fn a_withheld_coupling_is_found_with_its_driver() {
        let case = make(24, 704, 5).expect("a case");
        let withheld = &case.sealed.withheld[0];
        assert_eq!(withheld.effect, "joint_coupling");
        let folder = tempfile::tempdir().expect("a folder");
        write(&case, "coupled", folder.path()).expect("writable");
        let report = said(&folder.path().join("cases").join("coupled"), "coupled");
        let report = report.expect("a report");
        let cause = &report.causes[0];
        assert_eq!(
            (cause.effect, &cause.driver),
            ("joint_coupling", &withheld.driver)
        );
        assert_eq!(cause.joints[..], [withheld.joint.clone().expect("a joint")]);
        let (found, truth) = (cause.parameters[0].value, withheld.parameters[0].value);
        assert!(
            (found - truth).abs() < 0.05 * truth.abs(),
            "{found}, {truth}"
        );
        assert!(report.places.len() > 1 && cause.gap_closed > 0.5);
        // Its page and words say what drives it.
        let text = replay::words::lines(&report, |_| "coupling").join("\n");
        assert!(text.contains(&format!(
            "driven by {}",
            withheld.driver.as_deref().expect("a driver")
        )));
    }
}
