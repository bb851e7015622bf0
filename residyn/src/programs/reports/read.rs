//! Reports of `diagnose`, `replay` and `eval`, as far as two of them are compared.

use serde::Deserialize;
use std::path::{Path, PathBuf};

/// What a report is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A gap in torque, by `diagnose`.
    Torque,
    /// A gap in motion, by `replay`.
    Motion,
    /// Scores of a model, by `eval`.
    Scores,
}

impl Kind {
    /// Kind of a report by its schema.
    fn of(schema: &str) -> Option<Self> {
        match schema {
            "diagnosis/1" => Some(Self::Torque),
            "replay/1" => Some(Self::Motion),
            "eval/1" => Some(Self::Scores),
            _ => None,
        }
    }

    /// Program that writes such a report.
    pub fn program(self) -> &'static str {
        match self {
            Self::Torque => "diagnose",
            Self::Motion => "replay",
            Self::Scores => "eval",
        }
    }

    /// Measure of the error, by joint.
    pub fn measure(self) -> &'static str {
        match self {
            Self::Torque | Self::Scores => "NRMSE",
            Self::Motion => "unexplained part",
        }
    }
}

/// A report, as far as it is compared.
#[derive(Clone, Debug)]
pub struct Run {
    /// File of the report.
    pub path: PathBuf,
    /// What the report is of.
    pub kind: Kind,
    /// Names of the robot's joints, base first.
    pub joints: Vec<String>,
    /// Verdict in words; none of scores.
    pub verdict: Option<String>,
    /// Errors: as given and as corrected, or one per scored model.
    pub gaps: Vec<Gap>,
    /// Causes, largest share first.
    pub causes: Vec<Cause>,
}

/// Gap of one model, as two reports are compared: its name, and its relative error by joint and on average. Reports of
/// `diagnose` and `replay` measure it on the held-out recording, those of `eval` on the recording scored.
/// `Kind::measure` names the error: NRMSE, or the unexplained part of motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Gap {
    /// Name of the model.
    pub name: String,
    /// Error of each joint, relative; none for a joint that is not judged.
    pub by_joint: Vec<Option<f64>>,
    /// Mean over joints.
    pub mean: Option<f64>,
}

/// A cause, as the report lists it.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Cause {
    /// Name of the effect.
    pub effect: String,
    /// Names of the joints that it touches.
    pub joints: Vec<String>,
    /// Name of the joint that drives a coupling.
    pub driver: Option<String>,
    /// Part of what all causes remove.
    pub share_of_gap: f64,
    /// Part of its joints' squared error that it removes.
    pub gap_closed: f64,
    /// 90 % interval of `gap_closed`.
    pub gap_closed_interval: Option<[f64; 2]>,
    /// Whether the held-out recording shows it.
    pub confirmed: bool,
    /// Sizes.
    pub parameters: Vec<Size>,
}

/// A parameter of a cause.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Size {
    /// Name of the parameter.
    pub name: String,
    /// Joint that it belongs to, where it belongs to one.
    pub joint: Option<String>,
    /// Value, in `unit`.
    pub value: f64,
    /// Standard deviation, in `unit`; none where it was not estimated.
    pub std: Option<f64>,
    /// Unit.
    pub unit: String,
}

/// A report that cannot be compared.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The file cannot be read.
    #[error("{}: {source}", path.display())]
    Open {
        /// File of the report.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The file holds no JSON, or a report that lacks something.
    #[error("{}: not a report that --json of diagnose, replay or eval writes: {source}", path.display())]
    Content {
        /// File of the report.
        path: PathBuf,
        /// What is wrong, with line and column.
        source: serde_json::Error,
    },
    /// The file is of another format.
    #[error("{}: reports of diagnose, replay and eval are compared, and the schema here is {schema:?}", path.display())]
    Schema {
        /// File of the report.
        path: PathBuf,
        /// Schema that stands in the file.
        schema: String,
    },
    /// A list by joint has another length than the list of joints.
    #[error("{}: {found} values stand in {place} for {expected} joints", path.display())]
    Joints {
        /// File of the report.
        path: PathBuf,
        /// Name of the step or row.
        place: String,
        /// Number of values there.
        found: usize,
        /// Number of joints.
        expected: usize,
    },
}

#[derive(Deserialize)]
struct Head {
    schema: String,
}

/// Reports of `diagnose` and of `replay`.
#[derive(Deserialize)]
struct Diagnosed {
    joints: Vec<String>,
    verdict: String,
    ladder: Vec<Step>,
    causes: Vec<Cause>,
}

#[derive(Deserialize)]
struct Step {
    step: String,
    #[serde(alias = "unexplained")]
    nrmse: Vec<Option<f64>>,
    #[serde(alias = "mean_unexplained")]
    mean_nrmse: Option<f64>,
}

#[derive(Deserialize)]
struct Scored {
    joints: Vec<String>,
    rows: Vec<Row>,
}

#[derive(Deserialize)]
struct Row {
    name: String,
    scope: String,
    nrmse: Vec<Option<f64>>,
    mean_nrmse: Option<f64>,
}

/// Reads a report.
///
/// # Errors
/// The file cannot be read, is no report of a kind that is compared, or is damaged.
pub fn read(path: &Path) -> Result<Run, ReadError> {
    let text = std::fs::read_to_string(path).map_err(|source| ReadError::Open {
        path: path.to_owned(),
        source,
    })?;
    let content = |source| ReadError::Content {
        path: path.to_owned(),
        source,
    };
    let head: Head = serde_json::from_str(&text).map_err(content)?;
    let kind = Kind::of(&head.schema).ok_or_else(|| ReadError::Schema {
        path: path.to_owned(),
        schema: head.schema.clone(),
    })?;
    let run = match kind {
        Kind::Scores => scored(path, serde_json::from_str(&text).map_err(content)?),
        _ => diagnosed(path, kind, serde_json::from_str(&text).map_err(content)?),
    };
    for gap in &run.gaps {
        if gap.by_joint.len() != run.joints.len() {
            return Err(ReadError::Joints {
                path: path.to_owned(),
                place: gap.name.clone(),
                found: gap.by_joint.len(),
                expected: run.joints.len(),
            });
        }
    }
    Ok(run)
}

/// Steps of a ladder that are no corrected model.
const NO_MODEL: [&str; 2] = ["learned", "repeatability"];

fn diagnosed(path: &Path, kind: Kind, raw: Diagnosed) -> Run {
    let gap = |name: &str, step: &Step| Gap {
        name: name.to_owned(),
        by_joint: step.nrmse.clone(),
        mean: step.mean_nrmse,
    };
    let last = raw.ladder.iter().rfind(|s| !NO_MODEL.contains(&&*s.step));
    let first = raw.ladder.first().map(|s| gap("as given", s));
    Run {
        path: path.to_owned(),
        kind,
        gaps: first
            .into_iter()
            .chain(last.map(|s| gap("with the causes", s)))
            .collect(),
        joints: raw.joints,
        verdict: Some(raw.verdict.replace('_', " ")),
        causes: raw.causes,
    }
}

fn scored(path: &Path, raw: Scored) -> Run {
    let all = raw.rows.into_iter().filter(|row| row.scope == "all");
    Run {
        path: path.to_owned(),
        kind: Kind::Scores,
        gaps: all
            .map(|row| Gap {
                name: row.name.replace('_', " "),
                by_joint: row.nrmse,
                mean: row.mean_nrmse,
            })
            .collect(),
        joints: raw.joints,
        verdict: None,
        causes: Vec::new(),
    }
}
