//! A unit with everything needed to evaluate it, and the set of units of one robot.

use super::{Architecture, Bounds, Error, Normaliser, Weights};

/// One error-learning unit: predicts the residual torque of one joint, N·m (N for a prismatic joint).
#[derive(Debug, Clone, PartialEq)]
pub struct Unit {
    /// Joint whose torque the unit predicts, as an index into [`Compensator::joints`].
    pub joint: usize,
    /// Off when it did not lower the validation error: its output is then exactly zero.
    pub enabled: bool,
    /// Architecture of the network.
    pub architecture: Architecture,
    /// Input columns it sees, as indices into [`Compensator::inputs`]: the input control module.
    pub columns: Vec<usize>,
    /// Scaling of the inputs, one column per entry of `columns`.
    pub input: Normaliser,
    /// Scaling of the output, one column, N·m.
    pub target: Normaliser,
    /// Bounds of the training inputs, outside which the output fades.
    pub bounds: Bounds,
    /// Flat parameter vectors (see [`Architecture::tensors`]) whose outputs are averaged: one per seed.
    pub members: Vec<Vec<f32>>,
    /// How the run-time keeps the weights; `members` has them in single precision.
    pub weights: Weights,
}

impl Unit {
    /// Checks the unit for contradictions.
    ///
    /// # Errors
    /// A sentence naming the part.
    pub fn check(&self, joints: usize, inputs: usize) -> Result<(), String> {
        let d = self.columns.len();
        if self.joint >= joints {
            return Err(format!("joint index {} of {joints} joints", self.joint));
        }
        if let Some(c) = self.columns.iter().find(|&&c| c >= inputs) {
            return Err(format!("input column {c} of {inputs}"));
        }
        if self.input.columns() != d || self.target.columns() != 1 || self.bounds.columns() != d {
            return Err(format!("normalisation or bounds do not have {d} columns"));
        }
        let Some(count) = self.architecture.parameter_count(d) else {
            return Err("a width of its architecture is zero or absurdly large".into());
        };
        if self.members.is_empty() {
            return Err("no weights".into());
        }
        for member in &self.members {
            if member.len() != count {
                return Err(format!(
                    "{} parameters where its architecture has {count}",
                    member.len()
                ));
            }
            if !member.iter().all(|v| v.is_finite()) {
                return Err("a weight is not finite".into());
            }
        }
        Ok(())
    }
}

/// The units of one robot with the names that tie them to it.
#[derive(Debug, Clone, PartialEq)]
pub struct Compensator {
    /// Joint names in URDF order, base first.
    pub joints: Vec<String>,
    /// Names of the input columns, in the order in which [`super::Stream::step`] takes them.
    pub inputs: Vec<String>,
    /// Any number of units; those of one joint add up.
    pub units: Vec<Unit>,
}

impl Compensator {
    /// Checks every unit against itself and the names.
    ///
    /// # Errors
    /// [`Error::Unit`] with the first contradiction.
    pub fn check(&self) -> Result<(), Error> {
        for (unit, u) in self.units.iter().enumerate() {
            u.check(self.joints.len(), self.inputs.len())
                .map_err(|problem| Error::Unit { unit, problem })?;
        }
        Ok(())
    }

    /// Refuses a robot whose joints have other names, another order or another number.
    ///
    /// # Errors
    /// [`Error::Joints`].
    pub fn check_joints(&self, joints: &[String]) -> Result<(), Error> {
        if joints == self.joints {
            return Ok(());
        }
        Err(Error::Joints {
            expected: joints.to_vec(),
            found: self.joints.clone(),
        })
    }

    /// Refuses input columns other than those it was trained on.
    ///
    /// # Errors
    /// [`Error::Inputs`].
    pub fn check_inputs(&self, inputs: &[String]) -> Result<(), Error> {
        if inputs == self.inputs {
            return Ok(());
        }
        Err(Error::Inputs {
            expected: inputs.to_vec(),
            found: self.inputs.clone(),
        })
    }
}
