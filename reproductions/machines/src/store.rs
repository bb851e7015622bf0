//! An identified machine as a file (`machine.json`, schema `machine/1`): description, parameters with deviations, how it was
//! identified and how well. It needs neither recording nor URDF to predict.

use crate::description::Description;
use crate::identification::{AxisResult, Identified};
use crate::reasons::Reason;
use crate::{Machine, MachineError};
use physics::robot::drive::Drive;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Name of the schema.
pub const SCHEMA: &str = "machine/1";

/// Name of the file in a folder of results.
pub const FILE: &str = "machine.json";

/// A parameter's value.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Value {
    /// Name.
    pub name: String,
    /// Value.
    pub value: f64,
    /// Standard deviation.
    pub std: f64,
    /// Unit.
    pub unit: String,
}

/// What follows from the parameters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Derived {
    /// Name.
    pub name: String,
    /// Value.
    pub value: f64,
    /// Unit.
    pub unit: String,
}

/// What the controller needs beside the parameters, from the drive file.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Additive {
    /// Whole cycles by which the additive torque is sent late, per axis.
    pub torque_delay: Option<Vec<u32>>,
    /// Largest additive torque per axis, N·m or N.
    pub torque_threshold: Option<Vec<f64>>,
}

impl Additive {
    /// From a drive file.
    pub fn of(drive: &Drive) -> Self {
        Self {
            torque_delay: drive.torque_delay.clone(),
            torque_threshold: drive.torque_threshold.clone(),
        }
    }

    /// Axes whose torque leaves their threshold, with the largest torque of each.
    pub fn beyond(&self, torque: &ndarray::Array2<f64>) -> Vec<(usize, f64)> {
        let Some(thresholds) = &self.torque_threshold else {
            return Vec::new();
        };
        let top = |j: usize| torque.column(j).iter().fold(0.0_f64, |m, t| m.max(t.abs()));
        let axes = thresholds.iter().enumerate();
        axes.map(|(j, limit)| (j, top(j), *limit))
            .filter(|(_, top, limit)| top > limit)
            .map(|(j, top, _)| (j, top))
            .collect()
    }
}

/// The file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MachineFile {
    /// [`SCHEMA`].
    pub schema: String,
    /// The machine; a PUMA's robot as a URDF.
    pub machine: Description,
    /// Cut-off of position and torque, Hz.
    pub filter_hz: f64,
    /// Samples recorded and used.
    pub samples: [usize; 2],
    /// Whether every axis's largest relative error is at most 50 %.
    pub success: bool,
    /// All parameters: the model's, then friction.
    pub parameters: Vec<Value>,
    /// How many combinations of them the motion tells.
    pub rank: usize,
    /// What follows from them.
    pub derived: Vec<Derived>,
    /// Axis by axis.
    pub axes: Vec<AxisResult>,
    /// What explains a poor result or makes a good one doubtful.
    pub reasons: Vec<Reason>,
    /// Delays and thresholds.
    #[serde(default)]
    pub additive: Additive,
}

impl MachineFile {
    /// Of an identified machine, with what explains its result.
    pub fn of(identified: &Identified, reasons: Vec<Reason>, drive: Option<&Drive>) -> Self {
        let machine = &identified.machine;
        let estimate = &identified.estimate;
        let parameters = machine
            .parameters()
            .iter()
            .zip(estimate.values.iter().zip(&estimate.std))
            .map(|(parameter, (&value, &std))| Value {
                name: parameter.name.clone(),
                value,
                std,
                unit: parameter.unit.clone(),
            })
            .collect();
        let own = &estimate.values[..machine.model_parameters()];
        let derived = machine.model().derived(own).into_iter();
        Self {
            schema: SCHEMA.to_owned(),
            machine: machine.description().clone(),
            filter_hz: identified.filter_hz,
            samples: identified.samples,
            success: identified.success(),
            parameters,
            rank: estimate.rank,
            derived: derived
                .map(|(name, value, unit)| Derived { name, value, unit })
                .collect(),
            axes: identified.axes.clone(),
            reasons,
            additive: drive.map(Additive::of).unwrap_or_default(),
        }
    }

    /// Reads the file of a folder of results.
    ///
    /// # Errors
    /// It cannot be read, or is no such file.
    pub fn load(folder: &Path) -> Result<Self, MachineError> {
        let path = folder.join(FILE);
        let text = std::fs::read_to_string(&path).map_err(|source| MachineError::Read {
            path: path.clone(),
            source,
        })?;
        let wrong = |reason: String| MachineError::Store {
            path: path.clone(),
            reason: format!("{reason}; give a folder that machine identify has written"),
        };
        let file: Self = serde_json::from_str(&text).map_err(|e| wrong(e.to_string()))?;
        if file.schema != SCHEMA {
            return Err(wrong(format!(
                "the schema is {:?}, not {SCHEMA:?}",
                file.schema
            )));
        }
        let machine = Machine::new(file.machine.clone())?;
        let names = machine.parameters().iter().map(|p| &p.name);
        if !names.eq(file.parameters.iter().map(|p| &p.name)) {
            return Err(wrong(
                "its parameters are not those of its machine".to_owned(),
            ));
        }
        let numbers = file
            .parameters
            .iter()
            .map(|p| p.value)
            .chain([file.filter_hz]);
        if numbers.into_iter().any(|v| !v.is_finite()) {
            return Err(wrong("it holds a number that is not finite".to_owned()));
        }
        Ok(file)
    }

    /// The machine and its parameters' values.
    ///
    /// # Errors
    /// A description that cannot be used.
    pub fn machine(&self) -> Result<(Machine, Vec<f64>), MachineError> {
        let machine = Machine::new(self.machine.clone())?;
        Ok((machine, self.parameters.iter().map(|p| p.value).collect()))
    }

    /// As JSON.
    pub fn json(&self) -> String {
        let mut text = serde_json::to_string_pretty(self).unwrap_or_default();
        text.push('\n');
        text
    }
}
