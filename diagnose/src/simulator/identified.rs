//! The physics of a model directory as the model that a gap is measured from.

use crate::motion::frame::Frame;
use datasets::channel::Estimate95;
use feedforward::clock::Memory;
use model::directory::ModelFile;
use model::predict::predict_noted;
use model::session::{Session, spans};
use model::torque_channel::TorqueChannel;
use ndarray::Array2;
use physics::effects::{Sliding, Term};
use physics::robot::Robot;
use physics::torque_model::{TorqueModel, TorqueModelError, TorqueModelRecord};

/// Difference of start times within which two trajectories are the same one, s.
const SAME_START: f64 = 1e-6;

/// What of a model file another one starts from.
#[derive(Clone, Debug)]
pub(crate) struct IdentifiedFile {
    /// The torque model.
    pub(crate) physics: TorqueModelRecord,
    /// What the recorded torque went through.
    pub(crate) channel: Option<TorqueChannel>,
    /// How much later it was recorded than the motion.
    pub(crate) torque_delay: Option<Estimate95>,
}

/// An identified torque model with what it remembers of its training.
#[derive(Clone, Debug)]
pub(super) struct Identified {
    model: TorqueModel,
    clock: Vec<[f64; 2]>,
    memory: Vec<Memory>,
    pub(super) file: IdentifiedFile,
    /// The nominal robot with the identified friction.
    pub(super) sizes: Robot,
}

impl Identified {
    /// The robot that stands for the model where columns are built, and the model itself. The robot has the identified
    /// inertial parameters, friction, rotor inertias, counterbalance and springs.
    pub(super) fn new(file: &ModelFile) -> Result<(Robot, Self), TorqueModelError> {
        let model = file.physics.model()?;
        let value = |wanted: &Term| -> Vec<f64> {
            model
                .terms()
                .iter()
                .map(|list| {
                    list.iter()
                        .filter(|w| w.term == *wanted)
                        .map(|w| w.value)
                        .sum()
                })
                .collect()
        };
        let friction = |kind| -> Vec<f64> {
            let values = value(&Term::Sliding(kind));
            values.into_iter().map(|v: f64| v.max(0.0)).collect()
        };
        let (viscous, coulomb) = (friction(Sliding::Viscous), friction(Sliding::Coulomb));
        let mut robot = model
            .robot()
            .clone()
            .with_friction(&viscous, &coulomb)?
            .with_rotor_inertia(&value(&Term::RotorInertia))?;
        for weighted in model.terms().iter().flatten() {
            if let Some(passive) = weighted.term.passive() {
                robot = robot.with_passive(passive)?;
            }
        }
        let sizes = file.physics.nominal()?.with_friction(&viscous, &coulomb)?;
        let identified = Self {
            model,
            clock: file.clock.clone(),
            memory: file.memory.clone(),
            file: IdentifiedFile {
                physics: file.physics.clone(),
                channel: file.preprocessing.channel.clone(),
                torque_delay: file.preprocessing.torque_delay,
            },
            sizes,
        };
        Ok((robot, identified))
    }

    /// Torque at the recorded samples, shape (samples, joints).
    pub(super) fn predicted(&self, frame: &Frame) -> Array2<f64> {
        // A recording that the model was trained on is its clock; any other may continue it.
        let known = |start: f64| self.clock.iter().any(|k| (k[0] - start).abs() < SAME_START);
        let own = spans(frame.motion()).iter().all(|s| known(s[0]));
        let (clock, memory): (&[_], &[_]) = if own {
            (&[], &[])
        } else {
            (&self.clock, &self.memory)
        };
        let channel = self.file.channel.as_ref();
        let mut prepared = frame.prepared().clone();
        if let Some(channel) = channel {
            channel.turn(&mut prepared.fine);
        }
        let session = Session::new(vec![prepared], clock);
        predict_noted(&self.model, &session, memory, channel).swap_remove(0)
    }
}
