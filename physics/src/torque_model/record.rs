//! Stored form of a torque model.

use super::{TorqueModel, TorqueModelError, WeightedTerm};
use crate::robot::{Builtin, Robot, to_urdf};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// A [`TorqueModel`] as data: everything needed to evaluate it, the robot included.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TorqueModelRecord {
    /// Name of the nominal robot.
    pub robot: String,
    /// Built-in robot that the nominal robot is; absent for any other.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub builtin: Option<Builtin>,
    /// Names of the joints, base first.
    pub joints: Vec<String>,
    /// The nominal robot as a URDF: its kinematics are used, its inertials are replaced.
    pub urdf: String,
    /// Gravity in the base frame, m/s².
    pub gravity: [f64; 3],
    /// Part of each link's weight that is held from outside; empty for none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub gravity_compensation: Vec<f64>,
    /// Identified inertial parameters (10 N, see the robot's parameter order); they predict torque
    /// but need not be feasible link by link.
    pub rigid: Vec<f64>,
    /// Inertial parameters behind the load that load-dependent terms see.
    pub load: Vec<f64>,
    /// Terms of each joint with their parameters.
    pub terms: Vec<Vec<WeightedTerm>>,
}

impl TorqueModelRecord {
    /// Record of a model of `nominal`.
    pub fn new(
        nominal: &Robot,
        rigid: Vec<f64>,
        load: Vec<f64>,
        terms: Vec<Vec<WeightedTerm>>,
    ) -> Self {
        Self {
            robot: nominal.name().to_owned(),
            builtin: nominal.which_builtin(),
            joints: nominal.joint_names(),
            urdf: to_urdf(nominal),
            gravity: nominal.gravity().into(),
            gravity_compensation: nominal.gravity_compensation().to_vec(),
            rigid,
            load,
            terms,
        }
    }

    /// The nominal robot.
    ///
    /// # Errors
    /// A URDF that cannot be used.
    pub fn nominal(&self) -> Result<Robot, TorqueModelError> {
        Ok(Robot::from_urdf_str(&self.urdf)?
            .with_gravity(Vector3::from(self.gravity))
            .with_gravity_compensation(&self.gravity_compensation)?
            .known_as(self.builtin))
    }

    /// The model, ready to evaluate.
    ///
    /// # Errors
    /// Parts that do not fit together.
    pub fn model(&self) -> Result<TorqueModel, TorqueModelError> {
        TorqueModel::new(
            &self.nominal()?,
            &self.rigid,
            &self.load,
            self.terms.clone(),
        )
    }
}
