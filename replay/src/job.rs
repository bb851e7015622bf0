//! A diagnosis of motion from files: what the program and the Python package both run.

use crate::catalogue::Effect;
use crate::diagnosis::{Outcome, diagnose, earlier};
use crate::input::{InputError, Subject};
use crate::patch::{Patch, PatchError, patch};
use crate::schema::Compared;
use crate::simulate::Unstable;
use crate::tracks::Replayed;
use crate::{page, words};
use datasets::Part;
use model::preparation::setup::refuse_overlap;
use std::path::{Path, PathBuf};

/// What is asked for.
#[derive(Debug, Clone)]
pub struct Job {
    /// URDF or MJCF, or the name of a built-in robot.
    pub robot: String,
    /// Joints of the robot, base first; none: all.
    pub joints: Vec<String>,
    /// Recordings to fit.
    pub data: Vec<PathBuf>,
    /// Recording on which every figure is measured.
    pub heldout: PathBuf,
    /// Earlier recordings of the same robot: what has changed since is looked for; none: what the simulator lacks.
    pub before: Vec<PathBuf>,
    /// Drive file.
    pub drive: Option<PathBuf>,
    /// Gravity in the base frame, m/s².
    pub gravity: Option<[f64; 3]>,
    /// Shorten the fits without one cause each, by which shares are measured.
    pub fast: bool,
}

/// Why there is no diagnosis.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// Robot, drive file or recording.
    #[error(transparent)]
    Input(#[from] InputError),
    /// Drives that no simulation follows.
    #[error(transparent)]
    Unstable(#[from] Unstable),
    /// A corrected model that its format cannot hold.
    #[error(transparent)]
    Patch(#[from] PatchError),
    /// A file that cannot be written.
    #[error(transparent)]
    Write(#[from] report::WriteError),
    /// An output without a folder.
    #[error("{}: its folder does not exist; make it first", .0.display())]
    Folder(PathBuf),
    /// A recording on both sides.
    #[error("--heldout {} is among --data: what is measured on it says nothing; give a recording of its own", .0.display())]
    NotHeldOut(PathBuf),
}

impl ReplayError {
    /// Whether the input is at fault.
    pub fn is_input(&self) -> bool {
        !matches!(self, Self::Write(_))
    }
}

/// A diagnosis with what it was made of.
#[derive(Debug)]
pub struct Done {
    /// Robot and drives.
    pub subject: Subject,
    /// The held-out recording.
    pub heldout: Replayed,
    /// The diagnosis.
    pub outcome: Outcome,
}

impl Job {
    /// Reads and diagnoses; `stage` hears what is under way.
    ///
    /// # Errors
    /// Input that cannot be used.
    pub fn run(&self, mut stage: impl FnMut(&str)) -> Result<Done, ReplayError> {
        let canonical = |p: &Path| p.canonicalize().unwrap_or_else(|_| p.to_owned());
        let held = canonical(&self.heldout);
        if self.data.iter().any(|d| canonical(d) == held) {
            return Err(ReplayError::NotHeldOut(self.heldout.clone()));
        }
        let drive = self.drive.as_deref();
        let mut subject = Subject::read(&self.robot, &self.joints, drive, self.gravity)?;
        let fitted = subject.recordings(&self.data, Part::Train)?;
        let measured = subject.recordings(std::slice::from_ref(&self.heldout), Part::Test)?;
        let past = subject.recordings(&self.before, Part::Train)?;
        let (mut data, mut heldout) = (subject.prepared(&fitted)?, subject.prepared(&measured)?);
        for rows in [&fitted, &past] {
            refuse_overlap(rows, &measured[0]).map_err(InputError::from)?;
        }
        if !past.is_empty() {
            let mut before = subject.prepared(&past)?;
            alike([&mut before, &mut data, &mut heldout]);
            subject.given = earlier(&subject.given, &before, &mut stage)?;
        }
        let mut outcome = diagnose(&subject.given, &data, &heldout, self.fast, stage)?;
        outcome.report.compared = (!self.before.is_empty()).then(|| Compared {
            before: self
                .before
                .iter()
                .map(|p| p.display().to_string())
                .collect(),
        });
        Ok(Done {
            subject,
            heldout,
            outcome,
        })
    }
}

impl Done {
    /// The report of the schema `replay/1`.
    pub fn json(&self) -> String {
        let report = serde_json::to_string_pretty(&self.outcome.report);
        report.expect("a report is plain data") + "\n"
    }

    /// What the program prints.
    pub fn lines(&self) -> Vec<String> {
        let title = |name: &str| {
            let effect = Effect::ALL.iter().find(|e| e.name() == name);
            effect.map_or("", |e| e.words())
        };
        words::lines(&self.outcome.report, title)
    }

    /// The report as a self-contained page.
    pub fn page(&self) -> String {
        let name = self.subject.setup.robot.name();
        page::page(&self.outcome, &self.heldout, &format!("Replay of {name}"))
    }

    /// The corrected model as it would stand at `out`, with what lies beside it.
    ///
    /// # Errors
    /// A corrected robot that the format cannot hold.
    pub fn patch(&self, out: &Path) -> Result<Patch, PatchError> {
        let subject = &self.subject;
        patch(&subject.setup, &subject.given, &self.outcome.held, out)
    }
}

/// Commanded velocities are used of all recordings or of none: without them a drive's damping is another number.
fn alike(all: [&mut Replayed; 3]) {
    if all
        .iter()
        .all(|r| r.whole.iter().all(|t| t.rates.is_some()))
    {
        return;
    }
    for track in all
        .into_iter()
        .flat_map(|r| r.whole.iter_mut().chain(&mut r.blocks))
    {
        track.rates = None;
    }
}
