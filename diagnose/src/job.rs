//! A diagnosis from files, with all its outputs: the entry point of the program and of other languages.

use crate::advice::directory::{self, Directory};
use crate::advice::next_motion::{self, Experiment};
use crate::advice::patch::{self, Patch};
use crate::diagnosis::{Earlier, Options, diagnose, since};
use crate::error::DiagnoseError;
use crate::input::given::Given;
use crate::input::{before, budget};
use crate::outcome::Outcome;
use crate::report::{layouts, page, trace};
use crate::schema::Compared;
use datasets::Recording;
use datasets::write::Curves;
use model::preparation::setup::refuse_overlap;
use model::residual::ResidualError;
use std::path::{Path, PathBuf};

/// Number of surrogates of a recording: the least p-value that they give is 1/200.
pub const SURROGATES: u64 = 199;

/// Subject of a diagnosis: the simulator's model or the robot's earlier recordings.
#[derive(Clone, Debug)]
pub enum Subject {
    /// Description of a robot, the simulator's model.
    Robot {
        /// Built-in robot, URDF or MJCF.
        source: String,
        /// Names of its joints, where the description has more.
        joints: Vec<String>,
        /// Gravity in the base frame, m/s², where it is not the description's.
        gravity: Option<[f64; 3]>,
    },
    /// Path of a model directory.
    Model(PathBuf),
    /// The robot's own earlier recordings: changes since then are searched.
    Before {
        /// Built-in robot, URDF or MJCF, for lengths, axes and gravity; its masses are a prior.
        source: String,
        /// Names of its joints, where the description has more.
        joints: Vec<String>,
        /// Gravity in the base frame, m/s², where it is not the description's.
        gravity: Option<[f64; 3]>,
        /// Paths of the earlier recordings.
        recordings: Vec<PathBuf>,
    },
}

impl Subject {
    /// The same robot by its earlier recordings; a model directory is returned unchanged.
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

    /// Subject of a built-in robot, URDF or MJCF with all of its joints and its own gravity.
    pub fn robot(source: impl Into<String>) -> Self {
        Self::Robot {
            source: source.into(),
            joints: Vec::new(),
            gravity: None,
        }
    }
}

/// Diagnosis to be run, with its files and options.
#[derive(Clone, Debug)]
pub struct Job {
    /// The simulator's model, or the robot's earlier recordings.
    pub subject: Subject,
    /// Path of the drive file.
    pub drive: Option<PathBuf>,
    /// Sampling rate of tables without a time column, Hz.
    pub rate_hz: Option<f64>,
    /// Recordings that effects are fitted on.
    pub data: Vec<PathBuf>,
    /// Recording on which every figure is measured. Without one, trajectories of `data` are held out and not fitted.
    pub heldout: Option<PathBuf>,
    /// Cut-off of the motion's low-pass, Hz; chosen where none is given.
    pub cutoff_hz: Option<f64>,
    /// Whether to skip the surrogates.
    pub fast: bool,
    /// Whether to train a compensator on the residual beside the causes.
    pub learn: bool,
    /// Whether to design the motion that separates ambiguous causes.
    pub next: bool,
}

/// Finished diagnosis with its outputs.
pub struct Done {
    /// The model with the options for reading its recordings.
    pub given: Given,
    /// The report with its intermediate results.
    pub outcome: Outcome,
    /// The next motion, where one was asked for and is needed.
    pub next: Option<Experiment>,
    /// Doubts about the description, as text; also in the report's notes.
    pub warnings: Vec<String>,
    /// Parts of the recordings that were left out, as text; also in the report's notes.
    pub notes: Vec<String>,
    data: Recording,
    heldout: Recording,
    job: Job,
}

impl Job {
    /// A diagnosis without optional steps.
    pub fn new(subject: Subject, data: Vec<PathBuf>, heldout: impl Into<PathBuf>) -> Self {
        Self {
            heldout: Some(heldout.into()),
            ..Self::of(subject, data)
        }
    }

    /// A diagnosis of changes on a robot since its recordings `before`, without optional steps. A part of `data` is held out.
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

    /// Reads the files and runs the diagnosis; `stage` is called with the name of each stage.
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
    /// Report as JSON text.
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

    /// Torque over time of the held-out recording: measured, as given, corrected and what is left, joint by joint.
    pub fn trace(&self) -> Curves<'_> {
        trace::curves(&self.outcome)
    }

    /// Layouts in which PlotJuggler and Foxglove show the trace, for the folder that it is written to: paths and texts.
    pub fn layouts(&self, trace: &Path) -> Vec<(PathBuf, String)> {
        layouts::files(&self.trace(), trace)
    }

    /// The report as a self-contained page. `patched` are the paths of the patch's files, the description first; the page names
    /// them. It is empty where none are written.
    pub fn page(&self, patch: &Patch, patched: &[PathBuf]) -> String {
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
        page::render(
            &self.outcome,
            &self.given.model.robot,
            &inputs,
            patch,
            patched,
        )
    }

    /// Model directory with the prediction of the ladder's last structural step.
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
