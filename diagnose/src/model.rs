//! The simulator's model: what a gap is measured from.

use ndarray::Array2;
use physics::robot::{PARAMETERS_PER_LINK, Robot, RobotError};

use crate::scene::Scene;

/// A robot with its friction, exactly as the simulator has them.
#[derive(Clone, Debug)]
pub struct NominalModel {
    /// Inertials, damping, friction, rotor inertia, counterbalance.
    pub robot: Robot,
}

impl NominalModel {
    /// The torque that the simulator predicts: inverse dynamics + damping·q̇ + friction·sign(q̇), and rotor inertia and
    /// counterbalance where the model has them. `scene` must show this robot.
    pub fn predicted(&self, scene: &Scene) -> Array2<f64> {
        scene.predicted()
    }

    /// The same structure with parameters moved by `change` (10 N inertial, N viscous, N Coulomb). Coefficients of friction
    /// stay at zero or above: a direction of friction that feeds energy is a fit's artefact.
    ///
    /// # Errors
    /// Wrong number of values.
    pub fn moved(&self, change: &[f64]) -> Result<Robot, RobotError> {
        let n = self.robot.dof();
        let (inertial, friction) = change.split_at(PARAMETERS_PER_LINK * n);
        let parameters: Vec<f64> = self
            .robot
            .parameters()
            .iter()
            .zip(inertial)
            .map(|(p, d)| p + d)
            .collect();
        let joints = self.robot.joints();
        let damping: Vec<f64> = joints
            .iter()
            .zip(friction)
            .map(|(j, d)| (j.damping + d).max(0.0))
            .collect();
        let coulomb: Vec<f64> = joints
            .iter()
            .zip(&friction[n..])
            .map(|(j, d)| (j.friction + d).max(0.0))
            .collect();
        self.robot
            .with_parameters(&parameters)?
            .with_friction(&damping, &coulomb)
    }
}
