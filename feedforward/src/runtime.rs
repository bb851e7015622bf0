//! Torque feedforward from a model directory.

use crate::clock::{LONGEST_PERIOD, Memory, last_before, stride};
use crate::inputs::{CompensatorRecord, Signal};
use crate::network::{Compensator, Error as NetworkError, Stream};
use physics::effects::{BankState, Sample, Term, TermBank};
use physics::torque_model::{Predictor, TorqueModelError, TorqueModelRecord};
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};

/// Version of `model.json` that this run-time reads.
pub const SCHEMA: &str = "model/1";

/// A model directory that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum LoadError {
    /// A file cannot be read.
    #[error("{path}: {source}")]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// `model.json` is not one of this version.
    #[error("{path}: {reason}")]
    Format {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// The physical model does not fit together.
    #[error(transparent)]
    Physics(#[from] TorqueModelError),
    /// The compensator.
    #[error(transparent)]
    Network(#[from] NetworkError),
    /// The control period.
    #[error("a control period of {0} s is not positive")]
    Period(f64),
    /// The control period is none for the compensator's windows.
    #[error(
        "the compensator was trained on samples {trained} s apart: a control period of {period} s is outside {:.1e} to {:.1e} s",
        trained / MOST_STREAMS as f64,
        trained * LONGEST_PERIOD
    )]
    Windows {
        /// The control period, s.
        period: f64,
        /// The period of training, s.
        trained: f64,
    },
}

/// Most control periods within the period of a network; each has windows and states of its own.
const MOST_STREAMS: usize = 2000;

/// The part of `model.json` that the run-time needs.
#[derive(serde::Deserialize)]
struct ModelJson {
    schema: String,
    physics: TorqueModelRecord,
    preprocessing: Preprocessing,
    clock: Vec<[f64; 2]>,
    memory: Vec<Memory>,
    compensator: Option<CompensatorRecord>,
}

#[derive(serde::Deserialize)]
struct Preprocessing {
    fine_hz: f64,
}

/// A loaded model: physics, and the compensator where there is one.
///
/// [`Feedforward::torque`] is called once per control period and keeps friction memory and windows
/// in between; it does not allocate.
///
/// ```no_run
/// let mut model = feedforward::Feedforward::load("residyn-model".as_ref(), Some(0.001))?;
/// let (q, qd, qdd, mut tau) = ([0.0; 6], [0.0; 6], [0.0; 6], [0.0; 6]);
/// model.torque(&q, &qd, &qdd, &mut tau);
/// # Ok::<(), feedforward::LoadError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Feedforward {
    predictor: Predictor,
    residual: Option<Residual>,
    period: f64,
    clock: Option<f64>,
    /// Time from the sample before to the next one, s; zero where nothing is known.
    elapsed: f64,
    /// Training trajectories on the clock, and what was remembered at the end of each.
    known: Vec<[f64; 2]>,
    memory: Vec<Memory>,
    joints: usize,
}

#[derive(Debug, Clone)]
struct Residual {
    /// Where each input column comes from.
    sources: Vec<Source>,
    /// Terms among the inputs, one bank per joint.
    banks: Vec<TermBank>,
    columns: Vec<Vec<f64>>,
    inputs: Vec<f32>,
    /// One stream per control period within the network's own period, taking turns: each sees samples
    /// as far apart as in training, and the torque is smooth at the control rate.
    streams: Vec<Stream>,
    turn: usize,
}

#[derive(Debug, Clone, Copy)]
enum Source {
    Position(usize),
    Velocity(usize),
    Acceleration(usize),
    Load(usize),
    Term { joint: usize, index: usize },
}

impl Feedforward {
    /// Loads a model directory for a loop of `period` seconds (None: the period of training).
    ///
    /// # Errors
    /// Missing, damaged or altered files, another version, or parts of different robots; a period that is more than 1.5 times as
    /// long as that of the compensator's training, or less than a 2000th of it ([`Self::load_physics`] takes any).
    pub fn load(directory: &Path, period: Option<f64>) -> Result<Self, LoadError> {
        Self::read(directory, period, true)
    }

    /// Loads the physics of a model directory alone, whether it has a compensator or not.
    ///
    /// # Errors
    /// As [`Self::load`], but for the compensator's.
    pub fn load_physics(directory: &Path, period: Option<f64>) -> Result<Self, LoadError> {
        Self::read(directory, period, false)
    }

    fn read(directory: &Path, period: Option<f64>, compensated: bool) -> Result<Self, LoadError> {
        let path = directory.join("model.json");
        let text = std::fs::read_to_string(&path).map_err(|source| LoadError::Read {
            path: path.clone(),
            source,
        })?;
        let format = |reason: String| LoadError::Format {
            path: path.clone(),
            reason,
        };
        let value: serde_json::Value =
            serde_json::from_str(&text).map_err(|e| format(e.to_string()))?;
        if value.get("schema").and_then(|s| s.as_str()) != Some(SCHEMA) {
            return Err(format(format!(
                "no model of schema {SCHEMA:?}; train the model again with this version"
            )));
        }
        let json: ModelJson = serde_json::from_value(value).map_err(|e| format(e.to_string()))?;
        debug_assert_eq!(json.schema, SCHEMA);
        let model = json.physics.model()?;
        let network_period = json.compensator.as_ref().map(|c| c.period);
        let period = period
            .or(network_period)
            .unwrap_or(1.0 / json.preprocessing.fine_hz);
        if !(period > 0.0 && period.is_finite()) {
            return Err(LoadError::Period(period));
        }
        let residual = match &json.compensator {
            Some(record) if compensated => {
                let compensator = load_network(directory, record, &json.physics.joints)?;
                Some(Residual::new(record, &compensator, model.dof(), period)?)
            }
            _ => None,
        };
        Ok(Self {
            predictor: model.predictor(),
            residual,
            period,
            clock: None,
            elapsed: 0.0,
            known: json.clock,
            memory: json.memory,
            joints: model.dof(),
        })
    }

    /// The same physics alone.
    #[must_use]
    pub fn without_compensator(mut self) -> Self {
        self.residual = None;
        self
    }

    /// Number of joints.
    pub fn dof(&self) -> usize {
        self.joints
    }

    /// Control period, s.
    pub fn period(&self) -> f64 {
        self.period
    }

    /// Forgets friction memory and windows. `clock` is the time of the next sample on the session clock of
    /// the training recordings in s, where this loop continues it: friction memory then goes on from the
    /// training trajectory before. Without it, memory is neutral and warm-up terms take their mean.
    pub fn reset(&mut self, clock: Option<f64>) {
        let known = clock.and_then(|now| {
            let index = last_before(&self.known, now)?;
            self.memory.get(index)?;
            Some((now - self.known[index][1], index))
        });
        self.begin(clock, known);
    }

    /// Starts where the joints have been moved since the training: friction memory and windows are neutral; `clock` is the time of
    /// the next sample on the session clock of the training recordings in s, by which the gears have been warming.
    pub fn start(&mut self, clock: Option<f64>) {
        self.begin(clock, None);
    }

    /// Goes on from `known`: the time since it was remembered, s, and what.
    fn begin(&mut self, clock: Option<f64>, known: Option<(f64, usize)>) {
        let memory = known.and_then(|(_, index)| self.memory.get(index));
        self.clock = clock;
        self.elapsed = known.map_or(0.0, |(elapsed, _)| elapsed);
        self.predictor
            .restore(memory.map_or(&[], |memory| &memory.physics));
        if let Some(residual) = &mut self.residual {
            residual.restore(memory.map_or(&[], |memory| &memory.inputs));
        }
    }

    /// Starts a new trajectory `seconds` after the last sample: friction memory and clock run on, windows
    /// start anew.
    pub fn pause(&mut self, seconds: f64) {
        if let Some(clock) = &mut self.clock {
            *clock += seconds - self.elapsed;
        }
        self.elapsed = seconds;
        if let Some(residual) = &mut self.residual {
            residual.rewind();
        }
    }

    /// Torque of every joint (N·m or N) for the motion of this control period; all slices have one
    /// entry per joint, in URDF order.
    ///
    /// Where a value of the motion is not finite every torque is NaN, and what the model remembers stays as it was: the next finite
    /// sample goes on from there.
    ///
    /// # Panics
    /// When a slice has another length.
    pub fn torque(&mut self, q: &[f64], qd: &[f64], qdd: &[f64], tau: &mut [f64]) {
        if ![q, qd, qdd].iter().all(|x| x.iter().all(|v| v.is_finite())) {
            tau.fill(f64::NAN);
            self.skip();
            return;
        }
        let dt = std::mem::replace(&mut self.elapsed, self.period);
        self.predictor.step(self.clock, dt, q, qd, qdd, tau);
        if let Some(residual) = &mut self.residual {
            let load = self.predictor.load();
            residual.add(
                &Sample {
                    clock: self.clock,
                    dt,
                    q,
                    qd,
                    qdd,
                    load,
                },
                tau,
            );
        }
        if let Some(clock) = &mut self.clock {
            *clock += self.period;
        }
    }

    /// Lets a control period pass without a sample.
    fn skip(&mut self) {
        // At the start of a recording nothing lies before the next sample, however late it comes.
        if self.elapsed > 0.0 {
            self.elapsed += self.period;
        }
        if let Some(clock) = &mut self.clock {
            *clock += self.period;
        }
        if let Some(residual) = &mut self.residual {
            residual.turn = (residual.turn + 1) % residual.streams.len();
        }
    }
}

impl Residual {
    fn new(
        record: &CompensatorRecord,
        compensator: &Compensator,
        joints: usize,
        period: f64,
    ) -> Result<Self, LoadError> {
        let mut terms: Vec<Vec<Term>> = vec![Vec::new(); joints];
        let mut sources = Vec::with_capacity(record.inputs.len());
        for input in &record.inputs {
            let joint = input.joint;
            sources.push(match &input.signal {
                Signal::Position => Source::Position(joint),
                Signal::Velocity => Source::Velocity(joint),
                Signal::Acceleration => Source::Acceleration(joint),
                Signal::Load => Source::Load(joint),
                Signal::Term(term) => {
                    terms[joint].push(term.clone());
                    Source::Term {
                        joint,
                        index: terms[joint].len() - 1,
                    }
                }
            });
        }
        let turns = stride(record.period / period)
            .filter(|turns| *turns <= MOST_STREAMS)
            .ok_or(LoadError::Windows {
                period,
                trained: record.period,
            })?;
        let stream = compensator.stream()?;
        Ok(Self {
            columns: terms.iter().map(|t| vec![0.0; t.len()]).collect(),
            banks: terms
                .into_iter()
                .enumerate()
                .map(|(joint, t)| TermBank::new(joint, t))
                .collect(),
            inputs: vec![0.0; sources.len()],
            sources,
            streams: vec![stream; turns],
            turn: 0,
        })
    }

    /// Takes over stored memory, one state per joint; neutral where there is none.
    fn restore(&mut self, memory: &[BankState]) {
        self.banks.iter_mut().for_each(TermBank::reset);
        for (bank, state) in self.banks.iter_mut().zip(memory) {
            bank.restore(state);
        }
        self.rewind();
    }

    /// Empties the windows.
    fn rewind(&mut self) {
        self.streams.iter_mut().for_each(Stream::reset);
        self.turn = 0;
    }

    fn add(&mut self, sample: &Sample, tau: &mut [f64]) {
        for (bank, columns) in self.banks.iter_mut().zip(&mut self.columns) {
            bank.step(sample, columns);
        }
        for (input, source) in self.inputs.iter_mut().zip(&self.sources) {
            *input = match *source {
                Source::Position(j) => sample.q[j],
                Source::Velocity(j) => sample.qd[j],
                Source::Acceleration(j) => sample.qdd[j],
                Source::Load(j) => sample.load[j].abs(),
                Source::Term { joint, index } => self.columns[joint][index],
            } as f32;
        }
        self.streams[self.turn].step(&self.inputs, tau);
        self.turn = (self.turn + 1) % self.streams.len();
    }
}

/// Loads `compensator.safetensors` and checks that it is the one `model.json` was written with.
///
/// # Errors
/// A missing, damaged or altered file, or one of another robot.
pub fn load_network(
    directory: &Path,
    record: &CompensatorRecord,
    joints: &[String],
) -> Result<Compensator, LoadError> {
    let path = directory.join("compensator.safetensors");
    let bytes = std::fs::read(&path).map_err(|source| LoadError::Read {
        path: path.clone(),
        source,
    })?;
    let found: String = Sha256::digest(&bytes)
        .iter()
        .map(|b| format!("{b:02x}"))
        .collect();
    if found != record.sha256 {
        return Err(LoadError::Format {
            path,
            reason: "not the file that model.json was written with (checksum differs); copy or train the model again".into(),
        });
    }
    let compensator = Compensator::from_bytes(&bytes)?;
    compensator.check_joints(joints)?;
    let names: Vec<String> = record.inputs.iter().map(|i| i.name()).collect();
    compensator.check_inputs(&names)?;
    Ok(compensator)
}
