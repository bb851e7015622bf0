//! A stored model put together, and its torque for a prepared recording.

use crate::directory::ModelFile;
use crate::predict::predict_noted;
use crate::residual::{self, ResidualError};
use crate::session::Session;
use feedforward::network::Compensator;
use ndarray::Array2;
use physics::torque_model::TorqueModel;

/// Model with its compensator, where it has one.
#[derive(Clone, Copy)]
pub struct Loaded<'a> {
    /// Contents of the model directory.
    pub file: &'a ModelFile,
    /// Identified physics of the model.
    pub model: &'a TorqueModel,
    /// Compensator of the model; none without one.
    pub compensator: Option<&'a Compensator>,
}

impl Loaded<'_> {
    /// Torque of the physics alone and of the whole model, shape (samples, joints), for the only
    /// recording of `session`.
    ///
    /// # Errors
    /// A compensator that does not fit its record.
    pub fn torque(&self, session: &Session) -> Result<[Array2<f64>; 2], ResidualError> {
        let channel = self.file.preprocessing.channel.as_ref();
        let physics = predict_noted(self.model, session, &self.file.memory, channel).swap_remove(0);
        let torque = match self.compensator {
            Some(c) => &physics + &residual::predict(c, self.file, self.model, session, 0)?,
            None => physics.clone(),
        };
        Ok([physics, torque])
    }
}
