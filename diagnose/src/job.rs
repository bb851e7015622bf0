//! A diagnosis from files, with everything that can be written of it: what the program and other languages call.

use crate::advice::directory::{self, Directory};
use crate::advice::next_motion::{self, Experiment};
use crate::advice::patch::{self, Patch};
use crate::diagnosis::{Earlier, Options, diagnose, since};
use crate::error::DiagnoseError;
use crate::input::given::Given;
use crate::input::{before, budget};
use crate::outcome::Outcome;
use crate::report::page;
use crate::schema::Compared;
use datasets::Recording;
use model::preparation::setup::refuse_overlap;
use model::residual::ResidualError;
use std::path::PathBuf;

/// Surrogates of a recording: the least chance that they can tell is one in 200.
pub const SURROGATES: u64 = 199;

/// The simulator's model.
#[derive(Clone, Debug)]
pub enum Subject {
    /// A description.
    Robot {
        /// Built-in robot, URDF or MJCF.
        source: String,
        /// Its joints, where the description holds more.
        joints: Vec<String>,
        /// Gravity in the base frame, m/s², where it is not the description's.
        gravity: Option<[f64; 3]>,
    },
    /// Model directory.
    Model(PathBuf),
    /// The robot as its own earlier recordings have it: what has changed since is looked for.
    Before {
        /// Built-in robot, URDF or MJCF, for lengths and axes.
        source: String,
        /// Its joints, where the description holds more.
        joints: Vec<String>,
        /// Gravity in the base frame, m/s², where it is not the description's.
        gravity: Option<[f64; 3]>,
        /// The earlier recordings.
        recordings: Vec<PathBuf>,
    },
}

impl Subject {
    /// The same robot as its earlier recordings have it; a model directory stays what it is.
    pub fn as_in(self, recordings: Vec<PathBuf>) -> Self {
        match self {
            Self::Robot {
                source,
                joints,
                gravity,
            } if !recordings.is_empty() => Self::Before {
                source,
                joints,
                gravity,
                recordings,
            },
            other => other,
        }
    }

    /// A built-in robot, URDF or MJCF with all of its joints and gravity as the description has it.
    pub fn robot(source: impl Into<String>) -> Self {
        Self::Robot {
            source: source.into(),
            joints: Vec::new(),
            gravity: None,
        }
    }
}

/// A diagnosis that is asked for.
#[derive(Clone, Debug)]
pub struct Job {
    /// The simulator's model.
    pub subject: Subject,
    /// Drive file.
    pub drive: Option<PathBuf>,
    /// Rows per second of tables without a column of time.
    pub rate_hz: Option<f64>,
    /// Recordings that effects are fitted on.
    pub data: Vec<PathBuf>,
    /// Recording that every figure is measured on; where there is none, trajectories of `data` that are then not fitted.
    pub heldout: Option<PathBuf>,
    /// Cut-off of the motion's low-pass, Hz; chosen where none is given.
    pub cutoff_hz: Option<f64>,
    /// Draw no surrogates.
    pub fast: bool,
    /// Train a compensator on what is left.
    pub learn: bool,
    /// Design the motion that tells ambiguous causes apart.
    pub next: bool,
}

/// A diagnosis that is done.
pub struct Done {
    /// The model with what reading its recordings needs.
    pub given: Given,
    /// The report with everything behind it.
    pub outcome: Outcome,
    /// The next motion, where one was asked for and is needed.
    pub next: Option<Experiment>,
    /// What is doubtful about the description, in words; the report's notes have it, too.
    pub warnings: Vec<String>,
    /// What was left out, in words; the report's notes have it, too.
    pub notes: Vec<String>,
    data: Recording,
    heldout: Recording,
    job: Job,
}

impl Job {
    /// A diagnosis with nothing but what it needs.
    pub fn new(subject: Subject, data: Vec<PathBuf>, heldout: impl Into<PathBuf>) -> Self {
        Self {
            heldout: Some(heldout.into()),
            ..Self::of(subject, data)
        }
    }

    /// What has changed on a robot since its recordings `before`, with nothing but what that needs: part of `data` is held out.
    pub fn since(robot: Subject, before: Vec<PathBuf>, data: Vec<PathBuf>) -> Self {
        Self::of(robot.as_in(before), data)
    }

    fn of(subject: Subject, data: Vec<PathBuf>) -> Self {
        Self {
            subject,
            drive: None,
            rate_hz: None,
            data,
            heldout: None,
            cutoff_hz: None,
            fast: false,
            learn: false,
            next: false,
        }
    }

    /// Reads and diagnoses; `stage` is told what is being done.
    ///
    /// # Errors
    /// Files that cannot be used.
    pub fn run(self, stage: impl Fn(&'static str)) -> Result<Done, DiagnoseError> {
        if self.learn {
            // Before anything is read: the training comes last.
            compensator::training::trainable().map_err(ResidualError::from)?;
        }
        let drive = self.drive.as_deref();
        let mut earlier = None;
        let mut given = match &self.subject {
            Subject::Robot {
                source,
                joints,
                gravity,
            } => Given::robot(source, joints, drive, *gravity, &self.data)?.at_rate(self.rate_hz),
            Subject::Model(directory) => Given::model(directory, drive)?.at_rate(self.rate_hz),
            Subject::Before {
                source,
                joints,
                gravity,
                recordings,
            } => {
                stage("identifying the robot as it was");
                let before = Given::before(
                    source,
                    joints,
                    drive,
                    *gravity,
                    self.rate_hz,
                    recordings,
                    self.cutoff_hz,
                )?;
                earlier = Some(before.1);
                before.0
            }
        };
        stage("reading");
        let data = given.data(&self.data)?;
        let (data, heldout) = match &self.heldout {
            Some(path) => {
                let heldout = given.heldout(path)?;
                refuse_overlap(std::slice::from_ref(&data), &heldout)?;
                (data, heldout)
            }
            None => before::split(&data),
        };
        let (data, short) = budget::within(data);
        let (heldout, short_heldout) = budget::within(heldout);
        let options = match earlier {
            Some(before) => {
                given.model = given.model.on_clock_of(&[&data, &heldout])?;
                since(&given.model, &before, &data, self.cutoff_hz)
            }
            None => Options::default(),
        };
        stage("looking for causes");
        let options = Options {
            cutoff_hz: self.cutoff_hz,
            learn: self.learn,
            simulate: true,
            surrogates: if self.fast { 0 } else { SURROGATES },
            ..options
        };
        let usual = options.earlier.as_ref().and_then(Earlier::usual);
        let mut outcome = diagnose(&given.model, &data, &heldout, &options)?;
        let next = match self.next {
            true => next_motion::design(&given.model, &outcome)?,
            false => None,
        };
        if let (Subject::Before { recordings, .. }, Some(replay)) =
            (&self.subject, given.model.replay())
        {
            outcome.diagnosis.compared = Some(Compared {
                before: recordings.iter().map(|p| p.display().to_string()).collect(),
                repeated: [&data, &heldout].map(|r| replay.known(r).0),
                usual: usual.map(|u| u.structured.clone()),
            });
        }
        outcome.diagnosis.next_experiment = next.as_ref().map(|n| n.summary.clone());
        let fast = self
            .fast
            .then(|| "no surrogates were drawn (--fast)".to_owned());
        let robot = given.model.robot.notes().iter().cloned();
        // Identified numbers are combinations, which no description is to be judged by.
        let described = Some(&given.model).filter(|m| !m.is_identified());
        let findings = described.into_iter().flat_map(|m| m.robot.findings());
        let warnings: Vec<String> = findings.map(ToString::to_string).collect();
        let run = [short, short_heldout, fast].into_iter().flatten();
        let mut notes: Vec<String> = robot.chain(run).collect();
        outcome
            .diagnosis
            .notes
            .extend(warnings.iter().chain(&notes).cloned());
        notes.extend(outcome.sensors.iter().cloned());
        Ok(Done {
            given,
            outcome,
            next,
            warnings,
            notes,
            data,
            heldout,
            job: self,
        })
    }
}

impl Done {
    /// The report as JSON.
    pub fn json(&self) -> String {
        serde_json::to_string_pretty(&self.outcome.diagnosis).expect("numbers and strings")
    }

    /// The model with the causes written in.
    ///
    /// # Errors
    /// The fitted parameters make no robot.
    pub fn patch(&self) -> Result<Patch, DiagnoseError> {
        patch::patch(&self.given.model, &self.outcome, &self.given.description)
    }

    /// The report as a self-contained page.
    pub fn page(&self, patch: &Patch) -> String {
        let name = |p: &PathBuf| p.display().to_string();
        let data: Vec<String> = self.job.data.iter().map(name).collect();
        let subject = match &self.job.subject {
            Subject::Robot { source, .. } | Subject::Before { source, .. } => {
                ("robot".to_owned(), source.clone())
            }
            Subject::Model(directory) => ("model".to_owned(), name(directory)),
        };
        let held = self.job.heldout.as_ref();
        let held = held.map_or("trajectories of the same".to_owned(), name);
        let mut inputs = vec![subject];
        if let Subject::Before { recordings, .. } = &self.job.subject {
            let before: Vec<String> = recordings.iter().map(name).collect();
            inputs.push(("before".to_owned(), before.join(", ")));
        }
        inputs.push(("data".to_owned(), data.join(", ")));
        inputs.push(("held out".to_owned(), held));
        page::render(&self.outcome, &inputs, patch)
    }

    /// The model directory that predicts what the last structural step does.
    ///
    /// # Errors
    /// A model that does not fit together.
    pub fn directory(&self) -> Result<Directory, DiagnoseError> {
        let (model, given) = (&self.given.model, self.job.cutoff_hz.is_some());
        let mut directory =
            directory::directory(model, &self.data, &self.heldout, &self.outcome, given)?;
        // The recordings were joined: provenance names each.
        directory
            .file
            .provenance
            .recordings
            .clone_from(&self.given.sources);
        Ok(directory)
    }
}
