//! The model directory: `model.json`, `compensator.safetensors`, `metrics.json`, `identified.urdf`.

mod base_parameter;
pub mod metrics;

pub use base_parameter::BaseParameter;

use crate::baseline::{ForwardBaseline, LinearInverse};
use crate::identify::diagnostics::Diagnostics;
use crate::identify::error::IdentifyError;
use crate::identify::estimators::Known;
use crate::preparation::cutoff::{CutoffChoice, for_recording};
use crate::torque_channel::TorqueChannel;
use datasets::channel::Estimate95;
use datasets::prepare::{Derivatives, PrepareError, PrepareOptions, prepare};
use datasets::{Prepared, Recording, TorqueFilter};
use feedforward::clock::Memory;
use metrics::Metrics;
use ndarray::Array2;
use physics::robot::Robot;
use physics::torque_model::{TorqueModelError, TorqueModelRecord, WeightedTerm};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};

/// Version of `model.json` that this program writes and reads.
pub const SCHEMA: &str = "model/1";

/// Contents of `model.json`. Units are SI; joints base first.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ModelFile {
    /// [`SCHEMA`].
    pub schema: String,
    /// Version of the program that wrote it.
    pub residyn: String,
    /// Joint names.
    pub joints: Vec<String>,
    /// The identified physics.
    pub physics: TorqueModelRecord,
    /// Base parameters with their deviations.
    pub base_parameters: Vec<BaseParameter>,
    /// Covariance of the base parameters, then each joint's fitted terms, row by row.
    pub covariance: Vec<Vec<f64>>,
    /// Deviation of the physics' residual on the training samples.
    pub residual_std: ResidualStd,
    /// How the recordings were prepared.
    pub preprocessing: Preprocessing,
    /// The benchmark paper's linear baseline, fitted on the same samples.
    pub linear_baseline: LinearInverse,
    /// Its forward one, torque to position in simulation; none where the recordings are too short for it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub forward_baseline: Option<ForwardBaseline>,
    /// How well the identification stands.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub diagnostics: Option<Diagnostics>,
    /// Spans of time of the training trajectories, on which memory and warm-up run on, s.
    pub clock: Vec<[f64; 2]>,
    /// What terms remembered at the end of each of them.
    pub memory: Vec<Memory>,
    /// Where the model comes from.
    pub provenance: Provenance,
    /// What the compensator sees and how it was trained, where there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub compensator: Option<feedforward::inputs::CompensatorRecord>,
}

/// Residual deviation in N·m (N), per joint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ResidualStd {
    /// Where the joint moves.
    pub moving: Vec<f64>,
    /// Where it stands still.
    pub standstill: Vec<f64>,
}

/// How recordings were prepared before the fit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Preprocessing {
    /// Rate of the recorded samples, Hz.
    pub rate_hz: f64,
    /// Rate of the grid on which memory runs, Hz.
    pub fine_hz: f64,
    /// Zero-phase low-pass of the motion, Hz; none where positions were interpolated.
    pub cutoff_hz: Option<f64>,
    /// Whether the cut-off was given rather than chosen.
    #[serde(default)]
    pub cutoff_given: bool,
    /// How the cut-off was chosen by the torque; none where it was not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cutoff: Option<CutoffChoice>,
    /// Whether recorded velocity was left aside; otherwise it is fused in where it fits.
    #[serde(default)]
    pub position_alone: bool,
    /// Whether recorded velocity was used as recorded.
    pub recorded_velocity: bool,
    /// Low-pass that the recorded torque went through.
    pub torque_filter: Option<TorqueFilter>,
    /// How much later the recorded torque is than the motion, s, where that is certain; fit and score allow for it, the
    /// control loop does not have it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub torque_delay: Option<Estimate95>,
    /// What a diagnosis found of the torque channel and of joint zeros; none where it found nothing. Scores include it, the
    /// control loop does not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub channel: Option<TorqueChannel>,
    /// Whether only moving samples were fitted.
    pub moving_only: bool,
}

/// Where a model comes from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Provenance {
    /// Training recordings.
    pub recordings: Vec<Source>,
    /// Seed.
    pub seed: u64,
    /// Folds of the cross-validation that chose the terms.
    pub folds: usize,
}

/// One recording.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Source {
    /// File name without its folder, or the name of a simulation.
    pub name: String,
    /// SHA-256 of the file; empty for a simulation.
    pub sha256: String,
    /// Number of samples.
    pub samples: usize,
    /// Number of trajectories.
    pub trajectories: usize,
}

/// A model directory that cannot be read or written.
#[derive(Debug, thiserror::Error)]
pub enum DirectoryError {
    /// A file cannot be read.
    #[error("{path}: {source}")]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A file is no model.
    #[error("{path}: not a model of this program: {reason}")]
    Format {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// The model was written by another version.
    #[error("{path}: schema {found:?}, this program reads {SCHEMA:?}; train the model again")]
    Schema {
        /// The file.
        path: PathBuf,
        /// Its schema.
        found: String,
    },
    /// The parts of the model do not fit together.
    #[error("{path}: {source}")]
    Model {
        /// The file.
        path: PathBuf,
        /// Why.
        source: TorqueModelError,
    },
    /// The directory cannot be made, or an old file in it not be removed.
    #[error("{path}: {source}")]
    Folder {
        /// The directory.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] report::WriteError),
}

impl Source {
    /// What provenance says of a recording as it was read.
    pub fn of(recording: &Recording) -> Self {
        let path = Path::new(&recording.source);
        let hash = |bytes: Vec<u8>| {
            let digest = Sha256::digest(&bytes);
            digest.iter().map(|b| format!("{b:02x}")).collect()
        };
        let name = path.file_name();
        Self {
            name: name.map_or_else(
                || recording.source.clone(),
                |n| n.to_string_lossy().into_owned(),
            ),
            sha256: std::fs::read(path).map_or_else(|_| String::new(), hash),
            samples: recording.len(),
            trajectories: recording.trajectories.len(),
        }
    }
}

impl Preprocessing {
    /// How a recording is prepared for this model; `cutoff_hz` instead of the model's own cut-off where it is given.
    pub fn options(&self, cutoff_hz: Option<f64>) -> PrepareOptions {
        PrepareOptions {
            cutoff_hz: cutoff_hz.or(self.cutoff_hz),
            derivatives: if self.position_alone {
                Derivatives::FromPosition
            } else {
                Derivatives::Auto
            },
            torque_delay: self.torque_delay.and_then(|d| d.value).unwrap_or(0.0),
            ..PrepareOptions::default()
        }
    }
}

impl Preprocessing {
    /// A recording as this model sees it: prepared as its training was, or with another cut-off, positions true where a
    /// joint zero is known.
    ///
    /// # Errors
    /// As [`prepare()`].
    pub fn prepare(
        &self,
        recording: &Recording,
        cutoff_hz: Option<f64>,
    ) -> Result<Prepared, PrepareError> {
        let options = for_recording(&self.options(cutoff_hz), recording);
        let mut prepared = prepare(recording, &options)?;
        if let Some(channel) = &self.channel {
            channel.turn(&mut prepared.fine);
        }
        Ok(prepared)
    }
}

impl ModelFile {
    /// What an identification of the same robot may take as known from it.
    ///
    /// # Errors
    /// Other base parameters than `robot` has.
    pub fn known(&self, robot: &Robot) -> Result<Known, IdentifyError> {
        let values = |list: &Vec<WeightedTerm>| {
            let pairs = list.iter().map(|w| (w.term.clone(), w.value));
            pairs.collect()
        };
        Known::earlier(
            &self.physics.robot,
            self.base_parameters.iter().map(|p| &p.formula),
            self.base_parameters.iter().map(|p| p.value).collect(),
            self.physics.terms.iter().map(values).collect(),
            robot,
        )
    }

    /// Reads `model.json` of a model directory.
    ///
    /// # Errors
    /// A missing or damaged file, or one of another version.
    pub fn load(directory: &Path) -> Result<Self, DirectoryError> {
        let path = directory.join("model.json");
        let text = std::fs::read_to_string(&path).map_err(|source| DirectoryError::Read {
            path: path.clone(),
            source,
        })?;
        Self::parse(&text, path)
    }

    /// Reads the text of a `model.json`; `path` stands for it in messages.
    ///
    /// # Errors
    /// As [`ModelFile::load`].
    pub fn parse(text: &str, path: PathBuf) -> Result<Self, DirectoryError> {
        let format = |e: serde_json::Error| DirectoryError::Format {
            path: path.clone(),
            reason: e.to_string(),
        };
        let value: serde_json::Value = serde_json::from_str(text).map_err(format)?;
        let found = value
            .get("schema")
            .and_then(|s| s.as_str())
            .unwrap_or("none")
            .to_owned();
        if found != SCHEMA {
            return Err(DirectoryError::Schema { path, found });
        }
        let file: Self = serde_json::from_value(value).map_err(format)?;
        file.physics
            .model()
            .map_err(|source| DirectoryError::Model {
                path: path.clone(),
                source,
            })?;
        let size = file.covariance.len();
        let wrong = file.covariance.iter().any(|row| row.len() != size)
            || file.memory.len() != file.clock.len()
            || file.joints != file.physics.joints
            || file.residual_std.moving.len() != file.joints.len()
            || file.residual_std.standstill.len() != file.joints.len()
            || (file.preprocessing.channel.as_ref()).is_some_and(|c| !c.fits(file.joints.len()));
        if wrong {
            return Err(DirectoryError::Format {
                path,
                reason: "its parts have different sizes".into(),
            });
        }
        Ok(file)
    }

    /// Writes `model.json`; the directory exists.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn save(&self, directory: &Path) -> Result<(), DirectoryError> {
        Ok(report::write_atomic(
            &directory.join("model.json"),
            json(self),
        )?)
    }

    /// Writes a whole model directory, which is made where there is none: `model.json` last, so that a directory with one is
    /// whole. `weights` is `compensator.safetensors`, `urdf` the identified robot.
    ///
    /// # Errors
    /// The directory or a file cannot be written.
    pub fn write(
        &self,
        directory: &Path,
        metrics: &Metrics,
        weights: Option<&[u8]>,
        urdf: Option<&str>,
    ) -> Result<(), DirectoryError> {
        let failed = |source| DirectoryError::Folder {
            path: directory.to_owned(),
            source,
        };
        std::fs::create_dir_all(directory).map_err(failed)?;
        let path = directory.join("compensator.safetensors");
        match weights {
            Some(bytes) => report::write_atomic(&path, bytes)?,
            None if path.exists() => std::fs::remove_file(&path).map_err(failed)?,
            None => {}
        }
        report::write_atomic(&directory.join("metrics.json"), json(metrics))?;
        if let Some(urdf) = urdf {
            report::write_atomic(&directory.join("identified.urdf"), urdf)?;
        }
        self.save(directory)
    }

    /// The covariance as a table.
    pub fn covariance_table(&self) -> Array2<f64> {
        let n = self.covariance.len();
        Array2::from_shape_fn((n, n), |(i, j)| self.covariance[i][j])
    }
}

/// Pretty JSON with a line break at the end.
pub fn json<T: Serialize>(value: &T) -> String {
    // Types here hold no map with keys other than strings and no failing serialiser.
    let mut text = serde_json::to_string_pretty(value).unwrap_or_default();
    text.push('\n');
    text
}
