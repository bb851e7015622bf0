//! The model of a directory that `train` has written.

use super::Model;
use crate::ControlError;
use ::model::directory::ModelFile;
use feedforward::Feedforward;
use physics::dynamics::{Workspace, inverse_dynamics};
use physics::effects::Term;
use physics::torque_model::TorqueModel;
use plant::reference::Command;
use std::path::Path;

/// Physics, and physics with compensator, on the clock of their training: it goes on where its last recording ended. Friction
/// memory starts neutral, for the robot has been moved to where the loop starts.
pub struct DirectoryModel {
    model: TorqueModel,
    workspace: Workspace,
    physics: Feedforward,
    whole: Feedforward,
    compensator: bool,
    /// Session time of a loop's start, s; none where the training recordings had no common clock.
    start: Option<f64>,
}

/// Time between the last recording of the training and the loop, s.
const PAUSE: f64 = 5.0;

impl DirectoryModel {
    /// For a loop of `period` seconds.
    ///
    /// # Errors
    /// A directory that cannot be used.
    pub fn load(directory: &Path, file: &ModelFile, period: f64) -> Result<Self, ControlError> {
        let model = file.physics.model()?;
        let whole = Feedforward::load(directory, Some(period))?;
        let mut loaded = Self {
            workspace: Workspace::new(model.robot()),
            physics: whole.clone().without_compensator(),
            whole,
            compensator: file.compensator.is_some(),
            start: file.clock.last().map(|span| span[1] + PAUSE),
            model,
        };
        loaded.reset();
        Ok(loaded)
    }

    /// Session time of a loop's start, s.
    pub fn start(&self) -> Option<f64> {
        self.start
    }

    /// The torque model.
    pub fn physical(&self) -> &TorqueModel {
        &self.model
    }
}

impl Model for DirectoryModel {
    fn dof(&self) -> usize {
        self.model.dof()
    }

    fn rigid(&mut self, q: &[f64], qd: &[f64], qdd: &[f64], tau: &mut [f64]) {
        inverse_dynamics(self.model.robot(), &mut self.workspace, q, qd, qdd, tau);
        for (j, (list, tau)) in self.model.terms().iter().zip(tau).enumerate() {
            for weighted in list {
                let column = match &weighted.term {
                    Term::Offset => 1.0,
                    Term::RotorInertia => qdd[j],
                    Term::Counterbalance(c) => c.torque(q[j]),
                    Term::Spring(s) => s.torque(q[j]),
                    Term::Polynomial(p) => p.at(q[j]),
                    _ => 0.0,
                };
                *tau += weighted.value * column;
            }
        }
    }

    fn physics(&mut self, motion: &Command, tau: &mut [f64]) {
        self.physics.torque(&motion.q, &motion.qd, &motion.qdd, tau);
    }

    fn compensated(&mut self, motion: &Command, tau: &mut [f64]) {
        self.whole.torque(&motion.q, &motion.qd, &motion.qdd, tau);
    }

    fn has_compensator(&self) -> bool {
        self.compensator
    }

    fn reset(&mut self) {
        self.physics.start(self.start);
        self.whole.start(self.start);
    }
}
