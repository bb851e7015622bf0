//! An identified torque model: rigid body plus terms, evaluated sample by sample.

mod record;

pub use record::TorqueModelRecord;

use crate::dynamics::{Workspace, inverse_dynamics};
use crate::effects::{BankState, Sample, Term, TermBank};
use crate::robot::{Robot, RobotError};

/// A term of one joint with its identified parameter.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct WeightedTerm {
    /// Term: a column of the model.
    pub term: Term,
    /// Parameter of the term, in the term's unit.
    pub value: f64,
    /// Standard deviation of the parameter, in the term's unit.
    pub std: f64,
}

/// τ = Y(q, q̇, q̈)·π + Σ terms, one list of terms per joint.
#[derive(Clone, Debug)]
pub struct TorqueModel {
    rigid: Robot,
    load: Robot,
    terms: Vec<Vec<WeightedTerm>>,
}

/// Errors of the parts of a [`TorqueModel`].
#[derive(Debug, thiserror::Error)]
pub enum TorqueModelError {
    /// Parameters do not fit the robot.
    #[error(transparent)]
    Robot(#[from] RobotError),
    /// Lists of terms do not fit the robot.
    #[error("the robot has {joints} joints, the model has terms for {lists}")]
    Joints {
        /// Number of joints of the robot.
        joints: usize,
        /// Number of lists of terms given.
        lists: usize,
    },
    /// A term refers to a joint that does not exist.
    #[error("a term of joint {joint} is driven by joint {driver}, which does not exist")]
    Driver {
        /// Index of the joint that the term acts on.
        joint: usize,
        /// Index of the joint that the term refers to.
        driver: usize,
    },
}

impl TorqueModel {
    /// Puts a model together.
    ///
    /// `rigid` holds the 10·N identified inertial parameters; they need not be feasible. `load`
    /// holds those behind the transmitted torque that load-dependent terms see: they were fixed
    /// before those terms were fitted. `terms` has one list per joint.
    ///
    /// # Errors
    /// Lengths that do not fit the robot, or a coupling to a joint that does not exist.
    pub fn new(
        robot: &Robot,
        rigid: &[f64],
        load: &[f64],
        terms: Vec<Vec<WeightedTerm>>,
    ) -> Result<Self, TorqueModelError> {
        if terms.len() != robot.dof() {
            return Err(TorqueModelError::Joints {
                joints: robot.dof(),
                lists: terms.len(),
            });
        }
        for (joint, list) in terms.iter().enumerate() {
            for w in list {
                if let Some(driver) = w.term.driver().filter(|&d| d >= robot.dof()) {
                    return Err(TorqueModelError::Driver { joint, driver });
                }
            }
        }
        Ok(Self {
            rigid: robot.with_parameters(rigid)?,
            load: robot.with_parameters(load)?,
            terms,
        })
    }

    /// Number of joints of the robot.
    pub fn dof(&self) -> usize {
        self.terms.len()
    }

    /// The robot with the identified inertial parameters.
    pub fn robot(&self) -> &Robot {
        &self.rigid
    }

    /// The robot behind the load that load-dependent terms see.
    pub fn load_robot(&self) -> &Robot {
        &self.load
    }

    /// Terms of each joint, base first, with their parameters.
    pub fn terms(&self) -> &[Vec<WeightedTerm>] {
        &self.terms
    }

    /// A predictor in the neutral state. It allocates here and never again.
    pub fn predictor(&self) -> Predictor {
        let n = self.dof();
        let banks: Vec<TermBank> = self
            .terms
            .iter()
            .enumerate()
            .map(|(joint, list)| {
                TermBank::new(joint, list.iter().map(|w| w.term.clone()).collect())
            })
            .collect();
        let widest = self.terms.iter().map(Vec::len).max().unwrap_or(0);
        Predictor {
            workspace: Workspace::new(&self.rigid),
            values: self
                .terms
                .iter()
                .map(|l| l.iter().map(|w| w.value).collect())
                .collect(),
            frictional: self
                .terms
                .iter()
                .map(|l| l.iter().map(|w| w.term.is_friction()).collect())
                .collect(),
            friction: vec![0.0; n],
            rigid: self.rigid.clone(),
            load_robot: self.load.clone(),
            banks,
            load: vec![0.0; n],
            columns: vec![0.0; widest],
        }
    }
}

/// Streaming evaluation of a [`TorqueModel`] with its memory.
#[derive(Clone, Debug)]
pub struct Predictor {
    workspace: Workspace,
    values: Vec<Vec<f64>>,
    /// Whether each term is friction, by joint.
    frictional: Vec<Vec<bool>>,
    friction: Vec<f64>,
    rigid: Robot,
    load_robot: Robot,
    banks: Vec<TermBank>,
    load: Vec<f64>,
    columns: Vec<f64>,
}

impl Predictor {
    /// Forgets all memory, as at the start of a recording on an unknown clock.
    pub fn reset(&mut self) {
        self.banks.iter_mut().for_each(TermBank::reset);
    }

    /// Goes on from stored memory, one state per joint.
    pub fn restore(&mut self, memory: &[BankState]) {
        self.reset();
        for (bank, state) in self.banks.iter_mut().zip(memory) {
            bank.restore(state);
        }
    }

    /// Torque of all joints (N·m or N) at the next sample, `dt` seconds after the one before.
    ///
    /// `clock` is the session clock in s, None where it is unknown. All slices have N entries.
    ///
    /// # Panics
    /// When a slice has another length.
    pub fn step(
        &mut self,
        clock: Option<f64>,
        dt: f64,
        q: &[f64],
        qd: &[f64],
        qdd: &[f64],
        tau: &mut [f64],
    ) {
        inverse_dynamics(
            &self.load_robot,
            &mut self.workspace,
            q,
            qd,
            qdd,
            &mut self.load,
        );
        inverse_dynamics(&self.rigid, &mut self.workspace, q, qd, qdd, tau);
        let sample = Sample {
            clock,
            dt,
            q,
            qd,
            qdd,
            load: &self.load,
        };
        for (j, (bank, tau)) in self.banks.iter_mut().zip(tau).enumerate() {
            let (values, frictional) = (&self.values[j], &self.frictional[j]);
            let columns = &mut self.columns[..values.len()];
            bank.step(&sample, columns);
            *tau += columns.iter().zip(values).map(|(c, v)| c * v).sum::<f64>();
            let terms = columns.iter().zip(values).zip(frictional);
            self.friction[j] = terms.filter(|(_, is)| **is).map(|((c, v), _)| c * v).sum();
        }
    }

    /// Friction part of the last sample's torque, N·m: see [`Term::is_friction`].
    pub fn friction(&self) -> &[f64] {
        &self.friction
    }

    /// Rigid-body torque that load-dependent terms saw at the last sample, N·m.
    pub fn load(&self) -> &[f64] {
        &self.load
    }
}
