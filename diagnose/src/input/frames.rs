//! Both recordings on their clocks.

use super::reversal::signs;
use crate::error::DiagnoseError;
use crate::motion::channel::Channel;
use crate::motion::frame::Frame;
use crate::motion::passage::Passage;
use crate::motion::scene::Scale;
use crate::settings::InputSettings;
use crate::simulator::NominalModel;
use datasets::{PrepareOptions, Recording};
use model::preparation::cutoff::{self, CutoffChoice};
use std::sync::Arc;

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
    /// How both were prepared.
    pub options: PrepareOptions,
    /// How the cut-off was chosen; none where it was given or a model's.
    pub cutoff: Option<CutoffChoice>,
    /// Trajectories that the softness of signs is chosen on.
    spread: Vec<usize>,
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
        let (mut options, chosen) = match model.preparation() {
            Some(own) => {
                let options = PrepareOptions {
                    cutoff_hz: cutoff_hz.or(own.cutoff_hz),
                    ..*own
                };
                (options, None)
            }
            None => {
                let given = PrepareOptions {
                    cutoff_hz,
                    ..PrepareOptions::default()
                };
                cutoff::choose(&model.robot, std::slice::from_ref(data), &given)?
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
        let signs = signs(model, &data, &spread, None, settings);
        let scale = data.scale(&[&heldout], &signs);
        Ok(Self {
            data,
            heldout,
            scale,
            options,
            cutoff: chosen,
            spread,
        })
    }

    /// Has all columns as late as a search said, and looks again how friction turns round. `memory`: rows for which what that search
    /// left on each joint remembers itself.
    pub fn hear(
        &mut self,
        model: &NominalModel,
        channel: Option<Channel>,
        memory: Vec<f64>,
        settings: &InputSettings,
    ) {
        if channel.is_some() || self.scale.channel.is_some() {
            let signs = signs(model, &self.data, &self.spread, channel.as_ref(), settings);
            self.scale = Scale {
                channel: channel.map(Arc::new),
                ..self.data.scale(&[&self.heldout], &signs)
            };
        }
        self.scale.memory = Some(memory.into());
    }

    /// Motion of the fitted recording, memory running on through both where they share a clock.
    pub fn passage(&self) -> Passage<'_> {
        Passage::of(vec![self.data.motion(), self.heldout.motion()], 0)
            .with_wide(self.data.wide())
            .with_sensed(self.data.sensed())
    }

    /// The same of the held-out one.
    pub fn heldout_passage(&self) -> Passage<'_> {
        Passage::of(vec![self.data.motion(), self.heldout.motion()], 1)
            .with_wide(self.heldout.wide())
            .with_sensed(self.heldout.sensed())
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
