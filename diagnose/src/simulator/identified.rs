//! The physics of a model directory as the model to which the gap is measured.

use crate::motion::frame::Frame;
use crate::motion::passage::Terms;
use datasets::Prepared;
use datasets::channel::Estimate95;
use feedforward::clock::Memory;
use identify::base::BaseParameters;
use model::assemble::memory;
use model::directory::ModelFile;
use model::predict::predict_noted;
use model::session::{Session, spans};
use model::torque_channel::TorqueChannel;
use ndarray::Array2;
use physics::effects::{Sliding, Term};
use physics::robot::Robot;
use physics::torque_model::{TorqueModel, TorqueModelError, TorqueModelRecord, WeightedTerm};

/// Largest difference of start times at which two trajectories count as the same, s.
const SAME_START: f64 = 1e-6;

/// Contents of a model file that a further model file takes over.
#[derive(Clone, Debug)]
pub(crate) struct IdentifiedFile {
    /// Torque model as the file holds it.
    pub(crate) physics: TorqueModelRecord,
    /// Torque channel of the recordings.
    pub(crate) channel: Option<TorqueChannel>,
    /// Delay of the recorded torque after the motion.
    pub(crate) torque_delay: Option<Estimate95>,
}

/// Inertial parameters of all links with the same torque as the identified ones: the description's, changed
/// where the recordings determine them. Combinations that no motion of the mounted arm shows matter once its
/// base is tilted, and zero would be a poor guess of them.
fn filled(nominal: &Robot, identified: &Robot) -> Vec<f64> {
    let base = BaseParameters::of_robot(nominal, &[]);
    let given = nominal.parameters();
    let found = base.base_from(&identified.parameters());
    let both = found.iter().zip(base.base_from(&given));
    let change: Vec<f64> = both.map(|(found, given)| found - given).collect();
    let change = base.standard_from(&change);
    given.iter().zip(change).map(|(g, c)| g + c).collect()
}

/// An identified torque model with its memory of the training recordings.
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
    /// The robot with which columns are built, and the model itself. The robot has the identified inertial
    /// parameters, friction, rotor inertias, counterbalance and springs.
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
        let nominal = file.physics.nominal()?;
        let mut robot = model
            .robot()
            .with_parameters(&filled(&nominal, model.robot()))?
            .with_friction(&viscous, &coulomb)?
            .with_rotor_inertia(&value(&Term::RotorInertia))?;
        for weighted in model.terms().iter().flatten() {
            if let Some(passive) = weighted.term.passive() {
                robot = robot.with_passive(passive)?;
            }
        }
        let sizes = nominal.with_friction(&viscous, &coulomb)?;
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

    /// Terms by joint that a robot cannot hold: negative friction, and all terms but friction, rotor inertia and passive torques.
    pub(super) fn beside(&self) -> Vec<Terms> {
        let plain = [Sliding::Viscous, Sliding::Coulomb].map(Term::Sliding);
        let of = |list: &Vec<WeightedTerm>| {
            let rest = list.iter().filter(|w| {
                w.term != Term::RotorInertia
                    && !plain.contains(&w.term)
                    && w.term.passive().is_none()
            });
            let rest = rest.map(|w| (w.value, w.term.clone()));
            let negative = plain.iter().map(|kind| {
                let same = list.iter().filter(|w| w.term == *kind);
                let sum: f64 = same.map(|w| w.value).sum();
                (sum.min(0.0), kind.clone())
            });
            rest.chain(negative.filter(|n| n.0 < 0.0)).collect()
        };
        self.model.terms().iter().map(of).collect()
    }

    /// Moves the model's memory to the clock of other recordings than those of its training.
    pub(super) fn on_clock_of(&mut self, recordings: Vec<Prepared>) {
        let count = recordings.len();
        let session = Session::new(recordings, &[]);
        self.memory = memory(&self.model, &session, count);
        self.clock = session.clock(count);
    }

    /// Predicted torque at the recorded samples, N·m (N), shape (samples, joints).
    pub(super) fn predicted(&self, frame: &Frame) -> Array2<f64> {
        // What is known of the frame's own trajectories is computed again; it may continue any other.
        let own = spans(frame.motion());
        let other = |k: &[f64; 2]| !own.iter().any(|s| (s[0] - k[0]).abs() < SAME_START);
        let known = self.clock.iter().zip(&self.memory);
        let (clock, memory): (Vec<[f64; 2]>, Vec<Memory>) = known
            .filter(|(k, _)| other(k))
            .map(|(k, m)| (*k, m.clone()))
            .unzip();
        let channel = self.file.channel.as_ref();
        let mut prepared = frame.prepared().clone();
        if let Some(channel) = channel {
            channel.turn(&mut prepared.fine);
        }
        let session = Session::new(vec![prepared], &clock);
        predict_noted(&self.model, &session, &memory, channel).swap_remove(0)
    }
}
