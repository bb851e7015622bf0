//! The model directory: `model.json`, `covariance.json`, `compensator.safetensors`, `metrics.json`, `identified.urdf`,
//! `timing.json`, with `train --yardsticks` `yardsticks.json` and `yardsticks.safetensors`, after `train forward` `forward.json`.

mod base_parameter;
mod checksum;
mod covariance;
mod error;
pub mod metrics;
mod text;
mod timing;

pub use base_parameter::BaseParameter;
pub use checksum::sha256_of;
pub use error::DirectoryError;
pub use feedforward::model_file::{SCHEMA, sha256};
pub use text::json;
pub use timing::Timing;

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
use feedforward::model_file;
use metrics::Metrics;
use ndarray::Array2;
use physics::robot::Robot;
use physics::torque_model::{TorqueModelRecord, WeightedTerm};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Files of `train --yardsticks`: figures and trees; the ridge regression, stored like a compensator.
pub const YARDSTICKS: [&str; 2] = ["yardsticks.json", "yardsticks.safetensors"];

/// Name of the file that `train forward` writes.
pub const FORWARD: &str = "forward.json";

/// Contents of `model.json`. Units are SI; joints base first.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ModelFile {
    /// Name and version of the format: [`SCHEMA`].
    pub schema: String,
    /// Version of the program that wrote the model.
    pub residyn: String,
    /// Names of the robot's joints, base first.
    pub joints: Vec<String>,
    /// Identified physics: robot, base parameters and terms of each joint.
    pub physics: TorqueModelRecord,
    /// Base parameters with their standard deviations.
    pub base_parameters: Vec<BaseParameter>,
    /// Covariance of the base parameters, then each joint's fitted terms, row by row. It is stored in
    /// `covariance.json`; an earlier version stored it in `model.json`.
    #[serde(default, skip_serializing)]
    pub covariance: Vec<Vec<f64>>,
    /// SHA-256 of `covariance.json`; empty before it is written.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub covariance_sha256: String,
    /// Standard deviation of the whole model's error by regime. For a model of `train` it is from training
    /// samples left out of every fit, such that ± 1.645 of it holds 90 %. Without folds to leave out it is that
    /// of the physics' residual on the fitted samples.
    pub residual_std: ResidualStd,
    /// Preparation of the recordings before the fit.
    pub preprocessing: Preprocessing,
    /// Linear baseline of the KR300 benchmark paper, fitted on the same samples.
    pub linear_baseline: LinearInverse,
    /// Forward baseline of the KR300 benchmark paper, torque to position in simulation; none where the recordings are
    /// too short for it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub forward_baseline: Option<ForwardBaseline>,
    /// Quality of the identification.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub diagnostics: Option<Diagnostics>,
    /// Time spans of the training trajectories, s, over which memory and warm-up continue.
    pub clock: Vec<[f64; 2]>,
    /// Memory of the terms at the end of each trajectory in `clock`.
    pub memory: Vec<Memory>,
    /// Provenance of the model: recordings, seed, folds.
    pub provenance: Provenance,
    /// Inputs of the compensator and its training, where there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub compensator: Option<feedforward::inputs::CompensatorRecord>,
}

/// Standard deviation of the residual by joint, N·m (N).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ResidualStd {
    /// Standard deviation of the model's error where the joint moves, by joint, N·m (N).
    pub moving: Vec<f64>,
    /// Standard deviation of the model's error at standstill, by joint, N·m (N).
    pub standstill: Vec<f64>,
}

/// Preparation of the recordings before the fit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Preprocessing {
    /// Rate of the recorded samples, Hz.
    pub rate_hz: f64,
    /// Rate of the grid on which memory runs, Hz.
    pub fine_hz: f64,
    /// Cut-off of the motion's zero-phase low-pass, Hz; none where positions were interpolated.
    pub cutoff_hz: Option<f64>,
    /// Whether the cut-off was given rather than chosen.
    #[serde(default)]
    pub cutoff_given: bool,
    /// Choice of the cut-off by the torque; none where it was given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cutoff: Option<CutoffChoice>,
    /// Whether recorded velocity was ignored. Otherwise it is fused with the position where it fits.
    #[serde(default)]
    pub position_alone: bool,
    /// Whether recorded velocity was used as recorded.
    pub recorded_velocity: bool,
    /// Low-pass by which the recorded torque was filtered.
    pub torque_filter: Option<TorqueFilter>,
    /// Delay of the recorded torque after the motion, s, where it is certain. Fit and scores compensate for it;
    /// the control loop does not have it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub torque_delay: Option<Estimate95>,
    /// Torque channel and joint zeros from a diagnosis; none where it found nothing. Scores include them, the
    /// control loop does not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub channel: Option<TorqueChannel>,
    /// Whether only moving samples were fitted.
    pub moving_only: bool,
}

/// Provenance of a model: recordings and options of its training.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Provenance {
    /// Recordings on which the model was trained.
    pub recordings: Vec<Source>,
    /// Random seed of the training.
    pub seed: u64,
    /// Number of folds of the cross-validation that chose the terms.
    pub folds: usize,
}

/// Provenance of one recording.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Source {
    /// File name without its folder, or the name of a simulation.
    pub name: String,
    /// SHA-256 of the file, or of a folder's files concatenated in order of their names; empty for a simulation.
    pub sha256: String,
    /// Number of samples of the recording.
    pub samples: usize,
    /// Number of trajectories of the recording.
    pub trajectories: usize,
    /// Some rows in motion, positions (rad, m), then torques (N·m, N): they tell the recording under another name and in another format.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub rows: Vec<Vec<f64>>,
}

impl Provenance {
    /// Name of a training recording that `recording` is, or of which it holds a part; none where it is another one.
    pub fn fitted(&self, recording: &Recording) -> Option<&str> {
        let here = |r: &&Source| datasets::holds(recording, &r.rows);
        self.recordings.iter().find(here).map(|r| r.name.as_str())
    }
}

impl Source {
    /// Provenance of a recording as read.
    pub fn of(recording: &Recording) -> Self {
        let path = Path::new(&recording.source);
        let name = path.file_name();
        Self {
            name: name.map_or_else(
                || recording.source.clone(),
                |n| n.to_string_lossy().into_owned(),
            ),
            sha256: sha256_of(path).unwrap_or_default(),
            samples: recording.len(),
            trajectories: recording.trajectories.len(),
            rows: datasets::kept_rows(recording),
        }
    }
}

impl Preprocessing {
    /// Options for preparing a recording for this model. `cutoff_hz` replaces the model's own cut-off where it is given.
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
    /// Recording prepared as for the model's training, or with another cut-off. Positions are corrected where
    /// a joint zero is known.
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
    /// Parameters of this model as prior for an identification of the same robot.
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

    /// Reads `model.json` and `covariance.json` of a model directory.
    ///
    /// # Errors
    /// A missing or damaged file, or one of another version.
    pub fn load(directory: &Path) -> Result<Self, DirectoryError> {
        let path = directory.join(model_file::NAME);
        let text = std::fs::read_to_string(&path).map_err(|source| {
            let machine = directory.join("machine.json");
            if machine.is_file() {
                DirectoryError::Machine { path: machine }
            } else {
                DirectoryError::Read {
                    path: path.clone(),
                    source,
                }
            }
        })?;
        let mut file = Self::parse(&text, path.clone())?;
        if file.covariance.is_empty() {
            file.covariance = covariance::read(directory, &file.covariance_sha256)?;
            if !file.covariance_fits() {
                return Err(DirectoryError::sizes(path));
            }
        }
        Ok(file)
    }

    /// Parses the text of a `model.json`. The covariance is left empty unless the file is of an earlier
    /// version. `path` is used in messages.
    ///
    /// # Errors
    /// As [`ModelFile::load`].
    pub fn parse(text: &str, path: PathBuf) -> Result<Self, DirectoryError> {
        let file: Self =
            model_file::parse(text.as_bytes()).map_err(|source| DirectoryError::Model {
                path: path.clone(),
                source,
            })?;
        file.physics
            .model()
            .map_err(|source| DirectoryError::Physics {
                path: path.clone(),
                source,
            })?;
        let wrong = !(file.covariance.is_empty() || file.covariance_fits())
            || file.memory.len() != file.clock.len()
            || file.joints != file.physics.joints
            || file.residual_std.moving.len() != file.joints.len()
            || file.residual_std.standstill.len() != file.joints.len()
            || (file.preprocessing.channel.as_ref()).is_some_and(|c| !c.fits(file.joints.len()));
        if wrong {
            return Err(DirectoryError::sizes(path));
        }
        Ok(file)
    }

    /// Number of fitted parameters of the physics: base parameters and the terms of every joint. Parameters
    /// from the robot's description are not counted.
    pub fn fitted_parameters(&self) -> usize {
        let terms = self.physics.terms.iter().flatten();
        self.base_parameters.len() + terms.filter(|w| w.term.passive().is_none()).count()
    }

    /// Whether the covariance has a row and a column for each fitted parameter.
    fn covariance_fits(&self) -> bool {
        let size = self.fitted_parameters();
        self.covariance.len() == size && self.covariance.iter().all(|row| row.len() == size)
    }

    /// Writes `covariance.json`, then `model.json`; the directory must exist.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn save(&self, directory: &Path) -> Result<(), DirectoryError> {
        let covariance = covariance::text(&self.covariance);
        let stored = Self {
            covariance_sha256: sha256(covariance.as_bytes()),
            ..self.clone()
        };
        report::write_atomic(&directory.join(covariance::FILE), covariance)?;
        Ok(report::write_atomic(
            &directory.join(model_file::NAME),
            json(&stored),
        )?)
    }

    /// Writes a whole model directory, which is created if missing: `model.json` last, so that a
    /// directory with one is complete. `weights` is `compensator.safetensors`, `urdf` the identified robot.
    /// Files of an earlier training (timing, yardsticks, positions from torque) are removed.
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
        let gone = |path: &Path| match std::fs::remove_file(path) {
            Err(e) if e.kind() != std::io::ErrorKind::NotFound => Err(failed(e)),
            _ => Ok(()),
        };
        let path = directory.join(model_file::NETWORK);
        match weights {
            Some(bytes) => report::write_atomic(&path, bytes)?,
            None => gone(&path)?,
        }
        for file in [timing::FILE, FORWARD].iter().chain(&YARDSTICKS) {
            gone(&directory.join(file))?;
        }
        report::write_atomic(&directory.join("metrics.json"), json(metrics))?;
        if let Some(urdf) = urdf {
            report::write_atomic(&directory.join("identified.urdf"), urdf)?;
        }
        self.save(directory)
    }

    /// SHA-256 of a directory's `model.json`, which files made for that model store.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn sha256(directory: &Path) -> Result<String, DirectoryError> {
        let path = directory.join(model_file::NAME);
        sha256_of(&path).map_err(|source| DirectoryError::Read { path, source })
    }

    /// Covariance of the parameters as a table.
    pub fn covariance_table(&self) -> Array2<f64> {
        let n = self.covariance.len();
        Array2::from_shape_fn((n, n), |(i, j)| self.covariance[i][j])
    }
}
