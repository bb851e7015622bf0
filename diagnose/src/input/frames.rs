//! Fitted and held-out recording on their clocks.

use super::reversal::signs;
use crate::error::DiagnoseError;
use crate::motion::channel::Channel;
use crate::motion::frame::Frame;
use crate::motion::passage::{History, Terms};
use crate::motion::scene::Scale;
use crate::settings::InputSettings;
use crate::simulator::NominalModel;
use datasets::{PrepareOptions, Recording};
use model::preparation::cutoff::{self, CutoffChoice};
use ndarray::Array2;
use signal::Motion;
use std::sync::Arc;

/// Number of trajectories, evenly spread, on which the softness of signs is chosen.
const TRAJECTORIES: usize = 4;

/// Noise of a search's residual on the fitted rows.
pub struct ResidualNoise {
    /// Integrated autocorrelation time of each joint's residual, rows.
    pub correlation_rows: Vec<f64>,
    /// Largest weight of each fitted row by the residual around reversals, see [`Frames::turning`]. Shape (rows,
    /// joints).
    pub turning: Array2<f64>,
}

/// Fitted and held-out recording on their clocks.
#[derive(Clone)]
pub struct Frames {
    /// Fitted recording, prepared.
    pub data: Frame,
    /// Held-out recording, which is scored.
    pub heldout: Frame,
    /// Sizes of the fitted recording.
    pub scale: Scale,
    /// Options with which the fitted and the held-out recording were prepared; the cut-off is lower where a rate is too low for it.
    pub options: PrepareOptions,
    /// Choice of the cut-off; none where it was given or a model's.
    pub cutoff: Option<CutoffChoice>,
    /// Largest weight of the fitted rows, shape (rows, joints), from a search's residual around the joints'
    /// reversals; none before a search.
    pub turning: Option<Array2<f64>>,
    /// Indices of the trajectories on which the softness of signs is chosen.
    spread: Vec<usize>,
    /// Terms of an identified model that its robot does not hold, by joint.
    beside: Vec<Terms>,
}

impl Frames {
    /// Prepares both recordings: as for the model's own training, where it was identified; else as for training
    /// on the fitted recording. A given cut-off, Hz, takes precedence over either.
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
            turning: None,
            spread,
            beside: model.beside(),
        })
    }

    /// Delays all columns by the `channel` that a search found, and chooses the softness of friction's sign
    /// again. `noise` is that of the search's residual.
    pub fn apply_delay(
        &mut self,
        model: &NominalModel,
        channel: Option<Channel>,
        noise: ResidualNoise,
        settings: &InputSettings,
    ) {
        if channel.is_some() || self.scale.channel.is_some() {
            let signs = signs(model, &self.data, &self.spread, channel.as_ref(), settings);
            self.scale = Scale {
                channel: channel.map(Arc::new),
                ..self.data.scale(&[&self.heldout], &signs)
            };
        }
        self.scale.correlation_rows = Some(noise.correlation_rows.into());
        self.turning = Some(noise.turning);
    }

    /// Motion of the fitted recording; memory passes through both recordings where they share a clock.
    pub fn passage(&self) -> History<'_> {
        History::of(vec![self.data.motion(), self.heldout.motion()], 0)
            .with_wide(self.data.wide())
            .with_beside(&self.beside)
            .with_sensed(self.data.sensed())
    }

    /// Motion of the held-out recording; memory passes through both recordings where they share a clock.
    pub fn heldout_passage(&self) -> History<'_> {
        History::of(vec![self.data.motion(), self.heldout.motion()], 1)
            .with_wide(self.heldout.wide())
            .with_beside(&self.beside)
            .with_sensed(self.heldout.sensed())
    }

    /// Samples that memory passes through up to the end of the held-out recording, at the recorded stamps: see
    /// [`History::walked`].
    pub fn heldout_walked(&self) -> (Motion, Vec<Option<usize>>) {
        History::of(vec![self.data.samples(), self.heldout.samples()], 1).walked()
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::before;
    use crate::motion::scene::Scene;
    use crate::settings::Settings;
    use ndarray::Array2;
    use physics::robot::Robot;
    use trials::protocols::changed::{Change, changed};
    use trials::protocols::payload::LoadedArm;

    /// Gears with ripple, memory and friction by load: what columns scale is the torque that the gap is measured from.
    #[test]
    fn a_scene_has_the_whole_torque_of_an_identified_model() {
        let days = changed(LoadedArm::Ur5, Change::None, true, false, 7).unwrap();
        let robot = Robot::from_urdf_str(&days.urdf).unwrap();
        let model = before::model(&robot, std::slice::from_ref(&days.before), None).unwrap();
        let model = model.alone();
        assert!(model.beside().iter().any(|terms| !terms.is_empty()));
        let (fitted, held) = before::split(&days.after);
        let settings = Settings::default();
        let frames = Frames::new(&model, &fitted, &held, None, &settings.input).unwrap();
        let off = |scene: Scene, frame: &Frame| {
            let wanted = model.predicted(frame, &frames.scale);
            let departure = frame.table_to_samples(&scene.predicted()) - &wanted;
            let power = |t: &Array2<f64>| t.iter().map(|x| x * x).sum::<f64>();
            (power(&departure) / power(&wanted)).sqrt()
        };
        for (passage, frame) in [
            (frames.passage(), &frames.data),
            (frames.heldout_passage(), &frames.heldout),
        ] {
            let bare = passage.clone().with_beside(&[]);
            let whole = off(Scene::new(&model.robot, passage, &frames.scale), frame);
            let bare = off(Scene::new(&model.robot, bare, &frames.scale), frame);
            // What is left of it is how softly the sign of Coulomb friction turns round.
            assert!(whole < 0.1 * bare, "{whole:.2e} of {bare:.2e}");
        }
    }
}
