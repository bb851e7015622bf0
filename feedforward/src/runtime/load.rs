//! Loading of a model directory into a control loop.

use super::error::LoadError;
use super::model::Feedforward;
use super::residual::Residual;
use crate::clock::Memory;
use crate::dynamics::Dynamics;
use crate::inputs::CompensatorRecord;
use crate::model_file::{self, NETWORK, sha256};
use crate::network::Compensator;
use physics::torque_model::TorqueModelRecord;
use std::borrow::Cow;
use std::path::{Path, PathBuf};

/// The part of `model.json` that the run-time needs.
#[derive(serde::Deserialize)]
struct ModelJson {
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

impl Feedforward {
    /// Loads a model directory for a loop of `period` seconds (None: the period of training).
    ///
    /// # Errors
    /// Missing, damaged or altered files, another version, or parts of different robots; a period that is more than 1.5 times as
    /// long as that of the compensator's training, or less than a 2000th of it ([`Self::load_physics`] takes any).
    pub fn load(directory: &Path, period: Option<f64>) -> Result<Self, LoadError> {
        let text = file(&directory.join(model_file::NAME))?;
        Self::assemble(directory, &text, period, || {
            file(&directory.join(NETWORK)).map(|bytes| Some(Cow::Owned(bytes)))
        })
    }

    /// Loads the physics of a model directory alone, whether it has a compensator or not.
    ///
    /// # Errors
    /// As [`Self::load`], but for the compensator's.
    pub fn load_physics(directory: &Path, period: Option<f64>) -> Result<Self, LoadError> {
        let text = file(&directory.join(model_file::NAME))?;
        Self::assemble(directory, &text, period, || Ok(None))
    }

    /// Loads a model from the contents of its `model.json` and of its `compensator.safetensors`; without the latter the physics
    /// alone.
    ///
    /// # Errors
    /// As [`Self::load`], but for missing files.
    pub fn from_bytes(
        model: &[u8],
        network: Option<&[u8]>,
        period: Option<f64>,
    ) -> Result<Self, LoadError> {
        Self::assemble(Path::new(""), model, period, || {
            Ok(network.map(Cow::Borrowed))
        })
    }

    fn assemble<'a>(
        directory: &Path,
        text: &[u8],
        period: Option<f64>,
        network: impl FnOnce() -> Result<Option<Cow<'a, [u8]>>, LoadError>,
    ) -> Result<Self, LoadError> {
        let json: ModelJson = model_file::parse(text).map_err(|reason| LoadError::Format {
            path: directory.join(model_file::NAME),
            reason: reason.to_string(),
        })?;
        let model = json.physics.model()?;
        let network_period = json.compensator.as_ref().map(|c| c.period);
        let period = period
            .or(network_period)
            .unwrap_or(1.0 / json.preprocessing.fine_hz);
        if !(period > 0.0 && period.is_finite()) {
            return Err(LoadError::Period(period));
        }
        let residual = match &json.compensator {
            Some(record) => match network()? {
                Some(bytes) => {
                    let path = directory.join(NETWORK);
                    let compensator = checked(&bytes, path, record, &json.physics.joints)?;
                    Some(Residual::new(record, &compensator, model.dof(), period)?)
                }
                None => None,
            },
            None => None,
        };
        Ok(Self {
            predictor: model.predictor(),
            dynamics: Dynamics::new(&model),
            residual,
            period,
            clock: None,
            elapsed: 0.0,
            motion: std::array::from_fn(|_| vec![0.0; json.physics.joints.len()]),
            known: json.clock,
            memory: json.memory,
            names: json.physics.joints,
        })
    }
}

/// Loads `compensator.safetensors` and checks its checksum against `model.json`.
///
/// # Errors
/// A missing, damaged or altered file, or one of another robot.
pub fn load_network(
    directory: &Path,
    record: &CompensatorRecord,
    joints: &[String],
) -> Result<Compensator, LoadError> {
    let path = directory.join(NETWORK);
    let bytes = file(&path)?;
    checked(&bytes, path, record, joints)
}

fn checked(
    bytes: &[u8],
    path: PathBuf,
    record: &CompensatorRecord,
    joints: &[String],
) -> Result<Compensator, LoadError> {
    if sha256(bytes) != record.sha256 {
        return Err(LoadError::Format {
            path,
            reason: "not the file that model.json was written with (checksum differs); copy or train the model again".into(),
        });
    }
    let compensator = Compensator::from_bytes(bytes)?;
    compensator.check_joints(joints)?;
    let names: Vec<String> = record.inputs.iter().map(|i| i.name()).collect();
    compensator.check_inputs(&names)?;
    Ok(compensator)
}

fn file(path: &Path) -> Result<Vec<u8>, LoadError> {
    std::fs::read(path).map_err(|source| LoadError::Read {
        path: path.to_owned(),
        source,
    })
}
