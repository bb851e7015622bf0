//! One motion of one robot in every mode.

use super::experiment::{Experiment, Outcome};
use crate::ControlError;
use crate::measures::{Settle, Tracking};
use crate::model::Model;
use crate::motion::Motion;
use crate::subject::{Axis, Subject};
use crate::track::{Mode, Settings, Tool, track};

/// What is tried.
pub(super) struct Trial<'a> {
    /// Robot.
    pub robot: &'a str,
    /// Motion.
    pub motion: &'a dyn Motion,
    /// It in words.
    pub words: String,
    /// Where its tool is, if known.
    pub tool: Option<Tool<'a>>,
    /// When it counts as settled.
    pub settle: Option<Settle>,
    /// From when on errors count, s.
    pub from: f64,
    /// Loop.
    pub settings: Settings,
}

impl Trial<'_> {
    /// Runs every mode that the model has on a fresh robot.
    pub fn run(
        self,
        subject: impl Fn() -> Result<Subject, ControlError>,
        model: &mut dyn Model,
    ) -> Result<Experiment, ControlError> {
        let axes: Vec<Axis> = subject()?.axes;
        let mut outcomes = Vec::new();
        for mode in Mode::ALL {
            if mode == Mode::Compensated && !model.has_compensator() {
                continue;
            }
            let mut robot = subject()?;
            let mut trace = track(
                &mut robot,
                model,
                mode,
                self.motion,
                self.tool,
                &self.settings,
            );
            if trace.error.iter().any(|e| !e.is_finite()) {
                return Err(ControlError::Unstable {
                    robot: self.robot.to_owned(),
                    mode: mode.words(),
                });
            }
            trace.from = self.from;
            outcomes.push(Outcome {
                mode,
                tracking: Tracking::of(&trace, self.settle.as_ref()),
                trace,
            });
        }
        Ok(Experiment {
            robot: self.robot.to_owned(),
            motion: self.words,
            units: axes
                .iter()
                .map(|a| if a.turns { "rad" } else { "m" })
                .collect(),
            joints: axes.into_iter().map(|a| a.name).collect(),
            settings: self.settings,
            settle: self.settle,
            outcomes,
            published: None,
        })
    }
}
