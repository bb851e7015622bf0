//! A description with its torque model and the friction of its axes.

use crate::MachineError;
use crate::description::{Axis, Description};
use crate::models::{self, OutOfReach, Parameter, TorqueModel};

/// A machine whose torque is linear in parameters: those of its model, then viscous and Coulomb friction of every axis.
pub struct Machine {
    description: Description,
    model: Box<dyn TorqueModel>,
    parameters: Vec<Parameter>,
}

impl Machine {
    /// A built-in machine by name, or the description in a file.
    ///
    /// # Errors
    /// No such machine, or a description that cannot be used.
    pub fn load(name_or_path: &str) -> Result<Self, MachineError> {
        Self::new(Description::load(name_or_path)?)
    }

    /// The machine of a description.
    ///
    /// # Errors
    /// A contradiction in it, or a length that its model needs is missing.
    pub fn new(description: Description) -> Result<Self, MachineError> {
        description.check()?;
        let (model, description) = models::of(description)?;
        let mut parameters = model.parameters();
        for (j, axis) in description.axis.iter().enumerate() {
            let (speed, effort) = (axis.speed_unit(), axis.effort_unit());
            parameters.push(Parameter::new(
                format!("fv{}", j + 1),
                format!("{effort}/({speed})"),
            ));
            parameters.push(Parameter::new(format!("fc{}", j + 1), effort));
        }
        Ok(Self {
            description,
            model,
            parameters,
        })
    }

    /// The same machine with another torque model of its kind, from 1.
    ///
    /// # Errors
    /// The kind has no such model.
    pub fn with_dynamic_model(&self, number: usize) -> Result<Self, MachineError> {
        Self::new(Description {
            dynamic_model: number,
            ..self.description.clone()
        })
    }

    /// The description; a robot that it names is part of it as a URDF.
    pub fn description(&self) -> &Description {
        &self.description
    }

    /// The axes, base first.
    pub fn axes(&self) -> &[Axis] {
        &self.description.axis
    }

    /// Number of axes, N.
    pub fn dof(&self) -> usize {
        self.description.axis.len()
    }

    /// The torque model.
    pub fn model(&self) -> &dyn TorqueModel {
        self.model.as_ref()
    }

    /// All parameters: the model's, then `fv1`, `fc1`, `fv2`, `fc2` … (C values).
    pub fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    /// Number of the model's own parameters, P: C − 2 N.
    pub fn model_parameters(&self) -> usize {
        self.parameters.len() - 2 * self.dof()
    }

    /// Fills `rows` (N × C, row-major) so that `rows`·parameters is the torque of each axis at position, velocity and
    /// acceleration (N values each).
    ///
    /// # Errors
    /// Positions that the machine cannot take.
    ///
    /// # Panics
    /// When a slice has another size.
    pub fn rows(
        &self,
        q: &[f64],
        qd: &[f64],
        qdd: &[f64],
        rows: &mut [f64],
    ) -> Result<(), OutOfReach> {
        let (n, width, own) = (self.dof(), self.parameters.len(), self.model_parameters());
        assert_eq!(rows.len(), n * width, "N × C entries");
        let mut inner = vec![0.0; n * own];
        self.model.rows(q, qd, qdd, &mut inner)?;
        rows.fill(0.0);
        for j in 0..n {
            let row = &mut rows[j * width..][..width];
            row[..own].copy_from_slice(&inner[j * own..][..own]);
            row[own + 2 * j] = qd[j];
            row[own + 2 * j + 1] = if qd[j] == 0.0 { 0.0 } else { qd[j].signum() };
        }
        Ok(())
    }

    /// Torque of every axis with these parameters (C values).
    ///
    /// # Errors
    /// Positions that the machine cannot take.
    ///
    /// # Panics
    /// When a slice has another size.
    pub fn torque(
        &self,
        values: &[f64],
        q: &[f64],
        qd: &[f64],
        qdd: &[f64],
    ) -> Result<Vec<f64>, OutOfReach> {
        let width = self.parameters.len();
        assert_eq!(values.len(), width, "one value per parameter");
        let mut rows = vec![0.0; self.dof() * width];
        self.rows(q, qd, qdd, &mut rows)?;
        let dot = |row: &[f64]| row.iter().zip(values).map(|(y, p)| y * p).sum();
        Ok(rows.chunks_exact(width).map(dot).collect())
    }
}
