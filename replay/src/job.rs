//! Diagnosis of motion: of recordings in memory, and from files, as the program and the Python package both run it.

use crate::catalogue::Effect;
use crate::diagnosis::{Options, Outcome, diagnose, earlier};
use crate::input::{InputError, Subject};
use crate::patch::{Patch, PatchError, patch, unchanged};
use crate::schema::Compared;
use crate::simulate::Unstable;
use crate::tracks::Replayed;
use crate::{page, words};
use datasets::{Part, Recording};
use model::preparation::setup::refuse_overlap;
use std::path::{Path, PathBuf};

/// Request for a diagnosis: the files to read and the options.
#[derive(Debug, Clone)]
pub struct Job {
    /// Path of a URDF or MJCF file, or the name of a built-in robot.
    pub robot: String,
    /// Names of the joints that were recorded, base first; empty for all joints of the description.
    pub joints: Vec<String>,
    /// Paths of the recordings to which the parameters are fitted.
    pub data: Vec<PathBuf>,
    /// Path of the held-out recording, on which all figures of the report are measured.
    pub heldout: PathBuf,
    /// Paths of earlier recordings of the same robot. The simulator is fitted to them first, so that the causes are
    /// changes since then. Empty for a diagnosis of the simulator as given.
    pub before: Vec<PathBuf>,
    /// Path of the drive file: controller, and names and units of columns. None where the description alone says
    /// enough.
    pub drive: Option<PathBuf>,
    /// Gravity in the base frame, m/s²; none for that of the description.
    pub gravity: Option<[f64; 3]>,
    /// What is asked for beyond the causes.
    pub options: Options,
}

/// Reason why there is no diagnosis.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// Robot, drive file or recording that cannot be used.
    #[error(transparent)]
    Input(#[from] InputError),
    /// Simulator that diverges, or has a drive too stiff to simulate.
    #[error(transparent)]
    Unstable(#[from] Unstable),
    /// Corrected model that its file format cannot hold.
    #[error(transparent)]
    Patch(#[from] PatchError),
    /// File that cannot be written.
    #[error(transparent)]
    Write(#[from] report::WriteError),
    /// Output file that cannot be written, found before work began.
    #[error(transparent)]
    Output(#[from] report::write::OutputError),
    /// No recording to fit.
    #[error("there is no recording to fit: give at least one beside the held-out one")]
    NoData,
    /// Held-out recording that is also among the recordings to fit.
    #[error("--heldout {} is among --data: what is measured on it says nothing; give a recording of its own", .0.display())]
    NotHeldOut(PathBuf),
}

impl ReplayError {
    /// Whether the user's input is at fault, not the writing of a file. The program then exits with status 2.
    pub fn is_input(&self) -> bool {
        !matches!(self, Self::Write(_))
    }
}

/// Diagnosis together with the robot and the held-out recording that it was made from.
#[derive(Debug)]
pub struct Done {
    /// Robot and the simulator that was diagnosed.
    pub subject: Subject,
    /// Held-out recording, prepared for replay.
    pub heldout: Replayed,
    /// Outcome of the diagnosis: its report and the corrected simulators.
    pub outcome: Outcome,
    /// What was read, in words: robot and recordings, each with its part in the diagnosis.
    pub inputs: Vec<(String, String)>,
}

impl Job {
    /// Reads the files and makes the diagnosis. `stage` is called with the name of each step as it begins.
    ///
    /// # Errors
    /// Input that cannot be used, or a simulator that is unstable.
    pub fn run(&self, stage: impl FnMut(&str)) -> Result<Done, ReplayError> {
        let canonical = |p: &Path| p.canonicalize().unwrap_or_else(|_| p.to_owned());
        let held = canonical(&self.heldout);
        if self.data.iter().any(|d| canonical(d) == held) {
            return Err(ReplayError::NotHeldOut(self.heldout.clone()));
        }
        let drive = self.drive.as_deref();
        let subject = Subject::read(&self.robot, &self.joints, drive, self.gravity)?;
        let data = subject.recordings(&self.data, Part::Train)?;
        let heldout = subject.recording(&self.heldout, Part::Test)?;
        let before = subject.recordings(&self.before, Part::Train)?;
        let named = |p: &PathBuf| p.display().to_string();
        let mut done = replay_since(subject, &before, &data, &heldout, self.options, stage)?;
        if let Some(compared) = &mut done.outcome.report.compared {
            compared.before = self.before.iter().map(named).collect();
        }
        Ok(done)
    }
}

/// Diagnoses the gap in motion between the simulator `subject` and the robot that made the recordings, which have
/// commanded positions (`q_ref`) and need no torque. Parameters are fitted to `data`, and every figure is measured on
/// `heldout`. `stage` is called with the name of each step as it begins.
///
/// # Errors
/// Recordings that cannot be used, or a simulator that is unstable.
pub fn replay(
    subject: Subject,
    data: &[Recording],
    heldout: &Recording,
    options: Options,
    stage: impl FnMut(&str),
) -> Result<Done, ReplayError> {
    replay_since(subject, &[], data, heldout, options, stage)
}

/// Diagnoses like [`replay`] what has changed on the robot since its recordings `before`. The simulator is fitted to
/// them first; without any, it is taken as given.
///
/// # Errors
/// As for [`replay`].
pub fn replay_since(
    mut subject: Subject,
    before: &[Recording],
    data: &[Recording],
    heldout: &Recording,
    options: Options,
    mut stage: impl FnMut(&str),
) -> Result<Done, ReplayError> {
    let [fitted, past, measured] = [data, before, std::slice::from_ref(heldout)];
    let mut inputs = vec![("robot".to_owned(), subject.setup.robot.name().to_owned())];
    for (part, recordings) in [("before", past), ("data", fitted), ("held out", measured)] {
        let named = recordings
            .iter()
            .map(|r| (part.to_owned(), r.source.clone()));
        inputs.extend(named);
    }
    let mut data = subject.prepared(fitted)?.ok_or(ReplayError::NoData)?;
    let mut heldout = subject.prepared(measured)?.ok_or(ReplayError::NoData)?;
    let mut before = subject.prepared(past)?;
    for rows in [fitted, past] {
        refuse_overlap(rows, &measured[0]).map_err(InputError::from)?;
    }
    let compared = (!past.is_empty()).then(|| Compared {
        before: past.iter().map(|r| r.source.clone()).collect(),
    });
    let mut all = vec![&mut data, &mut heldout];
    all.extend(&mut before);
    alike(&mut all);
    subject.given.notes.extend(added_in_some(&all));
    if let Some(before) = before {
        subject.given = earlier(&subject.given, &before, &mut stage)?;
    }
    let mut outcome = diagnose(&subject.given, &data, &heldout, options, stage)?;
    outcome.report.compared = compared;
    Ok(Done {
        subject,
        heldout,
        outcome,
        inputs,
    })
}

impl Done {
    /// Report as JSON text, in the schema `replay/1`.
    pub fn json(&self) -> String {
        let report = serde_json::to_string_pretty(&self.outcome.report);
        report.expect("a report is plain data") + "\n"
    }

    /// Report as lines of text for a terminal.
    pub fn lines(&self) -> Vec<String> {
        let title = |name: &str| {
            let effect = Effect::ALL.iter().find(|e| e.name() == name);
            effect.map_or("", |e| e.words())
        };
        words::lines(&self.outcome.report, title)
    }

    /// Report as a self-contained HTML page. `patched` are the paths of the corrected model's files, the model first; the page
    /// names them. It is empty where none are written.
    pub fn page(&self, patched: &[PathBuf]) -> String {
        let title = format!("Replay of {}", self.subject.setup.robot.name());
        let patch = patched.first().and_then(|out| self.patch(out).ok());
        let of = |part: fn(&Patch) -> &Vec<String>| patch.as_ref().map_or(&[][..], |p| part(p));
        let files = page::Files {
            inputs: &self.inputs,
            patched,
            changes: of(|p| &p.changes),
            left_out: of(|p| &p.left_out),
        };
        page::page(&self.outcome, &self.heldout, &files, &title)
    }

    /// Whether the simulator as given follows the motion, so that its model stays as it is. After earlier recordings the simulator
    /// as given is fitted to them, and the model is written with that.
    pub fn nothing_to_correct(&self) -> bool {
        let report = &self.outcome.report;
        report.verdict == "no_gap" && report.compared.is_none()
    }

    /// Corrected model as text, to be written to `out`, with the drive files beside it. Where nothing is missing, it is the model as
    /// given. Nothing is written here.
    ///
    /// # Errors
    /// Corrected robot that the format cannot hold.
    pub fn patch(&self, out: &Path) -> Result<Patch, PatchError> {
        let subject = &self.subject;
        if self.nothing_to_correct() {
            return unchanged(&subject.setup, &subject.given, out);
        }
        let arms = [&self.outcome.held, &self.outcome.corrected];
        patch(&subject.setup, &subject.given, arms, out)
    }
}

/// Removes the commanded velocities of all recordings unless every one has them. A drive's damping would otherwise
/// differ between them, as without commanded velocities it includes viscous friction.
fn alike(all: &mut [&mut Replayed]) {
    let have = |r: &&mut Replayed| r.whole.iter().all(|t| t.rates.is_some());
    if all.iter().all(have) {
        return;
    }
    for replayed in all {
        let tracks = replayed.whole.iter_mut().chain(&mut replayed.blocks);
        tracks.for_each(|track| track.rates = None);
    }
}

/// Note for the reader where only some recordings have the torque that the controller adds.
fn added_in_some(all: &[&mut Replayed]) -> Option<String> {
    let tracks = || all.iter().flat_map(|r| &r.whole);
    let have = |t: &crate::simulate::Track| t.added.is_some();
    (tracks().any(have) && !tracks().all(have)).then(|| {
        "tau_ff is in some recordings only; the others are replayed as if the controller had added no torque".to_owned()
    })
}
