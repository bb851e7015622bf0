//! Both recordings on their clocks.

use super::reversal::softness;
use crate::error::DiagnoseError;
use crate::motion::frame::Frame;
use crate::motion::scene::Scale;
use crate::settings::InputSettings;
use crate::simulator::NominalModel;
use datasets::{PrepareOptions, Recording};
use model::preparation::cutoff;

/// Trajectories that the softness of signs is chosen on, evenly spread.
const TRAJECTORIES: usize = 4;

/// The recordings on their clocks.
pub struct Frames {
    /// What is fitted.
    pub data: Frame,
    /// What is scored.
    pub heldout: Frame,
    /// Sizes of the fitted recording.
    pub scale: Scale,
}

impl Frames {
    /// Prepares both recordings: as the model's own training did, where it was identified; else as training on the fitted
    /// recording would. A given cut-off, Hz, goes before either.
    ///
    /// # Errors
    /// No torque, or a recording that cannot be prepared.
    pub fn new(
        model: &NominalModel,
        data: &Recording,
        heldout: &Recording,
        cutoff_hz: Option<f64>,
        settings: &InputSettings,
    ) -> Result<Self, DiagnoseError> {
        let mut options = match model.preparation() {
            Some(own) => PrepareOptions {
                cutoff_hz: cutoff_hz.or(own.cutoff_hz),
                ..*own
            },
            None => {
                let given = PrepareOptions {
                    cutoff_hz,
                    ..PrepareOptions::default()
                };
                cutoff::choose(&model.robot, std::slice::from_ref(data), &given)?.0
            }
        };
        let few = data.trajectories.len().min(TRAJECTORIES);
        let spread: Vec<usize> = (0..few)
            .map(|i| i * data.trajectories.len() / few)
            .collect();
        let data = fresh(data, &cutoff::for_recording(&options, data))?;
        // Where nothing else chose, the fitted recording's own noise does for both.
        options.cutoff_hz = options.cutoff_hz.or(data.report().cutoff_hz);
        let heldout = fresh(heldout, &cutoff::for_recording(&options, heldout))?;
        let scale = data.scale(&[&heldout], softness(model, &data, &spread, settings));
        Ok(Self {
            data,
            heldout,
            scale,
        })
    }
}

/// A recording with its torque, prepared.
///
/// # Errors
/// No torque, or a recording that cannot be prepared.
pub fn fresh(recording: &Recording, options: &PrepareOptions) -> Result<Frame, DiagnoseError> {
    let tau = recording
        .tau
        .clone()
        .ok_or_else(|| DiagnoseError::NoTorque(recording.source.clone()))?;
    Frame::new(recording, tau, options).map_err(|error| DiagnoseError::Prepare {
        source_name: recording.source.clone(),
        error,
    })
}
