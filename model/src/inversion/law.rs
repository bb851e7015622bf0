//! Smooth law from motion to torque, whose derivatives the solver needs.
//!
//! Rigid body and springs are those of the identified model. Its friction has memory, and is replaced here by a curve
//! over velocity. The curve is fitted to the training torque in motion, less that of rigid body and springs.

use super::error::InversionError;
use datasets::metrics::MOVING;
use ndarray::{Array2, ArrayView1};
use physics::dynamics::{Workspace, inverse_dynamics, mass_matrix};
use physics::robot::{Passive, Robot};
use physics::torque_model::TorqueModel;
use serde::{Deserialize, Serialize};
use signal::cholesky;

/// Velocity over which the curved part of friction rises, in RMS speeds of the joint.
const CURVED: f64 = 1.0;
/// Velocity over which friction's sign is softened in the fit, in RMS speeds of the joint.
pub(super) const SOFTNESS: f64 = 0.02;
/// Step of numerical derivatives, rad or rad/s.
const STEP: f64 = 1e-6;
/// Number of columns of a joint's friction.
const COLUMNS: usize = 5;
/// Ridge on the friction columns, relative to their squared sums.
const RIDGE: f64 = 1e-9;

/// Friction of one joint as a function of its velocity: torque in addition to rigid body and springs, N·m (N).
///
/// It is offset + inertia·q̈ + viscous·q̇ + coulomb·tanh(q̇/soft) + curved·tanh(q̇/speed).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct JointFriction {
    /// Coefficients of offset, inertia, viscous, coulomb and curved.
    pub parameters: [f64; COLUMNS],
    /// RMS speed of the joint in motion, rad/s (m/s).
    pub speed: f64,
    /// Standard deviation of the residual in motion, N·m (N).
    pub moving: f64,
    /// Standard deviation of the residual at standstill, N·m (N).
    pub standing: f64,
}

/// Columns of a joint's friction, and their derivatives with respect to velocity.
fn columns(qd: f64, qdd: f64, soft: f64, curved: f64) -> [[f64; COLUMNS]; 2] {
    let (sign, bend) = ((qd / soft).tanh(), (qd / curved).tanh());
    [
        [1.0, qdd, qd, sign, bend],
        [
            0.0,
            0.0,
            1.0,
            (1.0 - sign * sign) / soft,
            (1.0 - bend * bend) / curved,
        ],
    ]
}

impl JointFriction {
    /// Friction by least squares over the samples in motion; none where there are too few. `left` is the torque less
    /// that of rigid body and springs, N·m (N).
    fn fit(left: &[f64], qd: ArrayView1<f64>, qdd: ArrayView1<f64>) -> Option<Self> {
        let moves = |k: &usize| qd[*k].abs() > MOVING;
        let moving: Vec<usize> = (0..left.len()).filter(moves).collect();
        if moving.len() < 10 * COLUMNS {
            return None;
        }
        let rms = |values: &mut dyn Iterator<Item = f64>| {
            let (sum, n) = values.fold((0.0, 0usize), |(s, n), v| (s + v * v, n + 1));
            (sum / n.max(1) as f64).sqrt()
        };
        let speed = rms(&mut moving.iter().map(|&k| qd[k]));
        let at = |k: usize| columns(qd[k], qdd[k], SOFTNESS * speed, CURVED * speed)[0];
        let mut products = [0.0; COLUMNS * COLUMNS];
        let mut parameters = [0.0; COLUMNS];
        for &k in &moving {
            let row = at(k);
            for i in 0..COLUMNS {
                for j in 0..COLUMNS {
                    products[i * COLUMNS + j] += row[i] * row[j];
                }
                parameters[i] += row[i] * left[k];
            }
        }
        (0..COLUMNS).for_each(|i| products[i * COLUMNS + i] *= 1.0 + RIDGE);
        cholesky::factor(&mut products, COLUMNS)?;
        cholesky::solve(&products, &mut parameters);
        let error = |k: usize| {
            left[k]
                - std::iter::zip(at(k), parameters)
                    .map(|(a, b)| a * b)
                    .sum::<f64>()
        };
        let in_motion = rms(&mut moving.iter().map(|&k| error(k)));
        let standing = rms(&mut (0..left.len()).filter(|k| !moves(k)).map(error));
        Some(Self {
            parameters,
            speed,
            moving: in_motion,
            standing,
        })
    }
}

/// Smooth law from motion to torque: rigid body and springs of an identified model, and a friction curve for each
/// joint.
pub(super) struct Law {
    /// Robot with the identified parameters.
    robot: Robot,
    /// Springs and counterbalances, each with its factor.
    passive: Vec<(f64, Passive)>,
    /// Friction of each joint.
    pub friction: Vec<JointFriction>,
}

/// Torque of one sample with its derivatives, and buffers for them.
pub(super) struct Derived {
    /// Torque of each joint, N·m (N).
    pub torque: Vec<f64>,
    /// Derivatives of the torque with respect to position, velocity and acceleration; each N × N, row-major.
    pub by: [Vec<f64>; 3],
    /// Buffers of the rigid-body dynamics.
    workspace: Workspace,
    /// Buffer for a position or velocity with one value changed.
    moved: Vec<f64>,
    /// Buffer for the torque there.
    other: Vec<f64>,
}

impl Derived {
    /// Buffers for a robot.
    pub(super) fn new(robot: &Robot) -> Self {
        let n = robot.dof();
        let square = || vec![0.0; n * n];
        Self {
            torque: vec![0.0; n],
            by: [square(), square(), square()],
            workspace: Workspace::new(robot),
            moved: vec![0.0; n],
            other: vec![0.0; n],
        }
    }
}

impl Law {
    /// Law of a model with the given friction.
    pub(super) fn new(model: &TorqueModel, friction: Vec<JointFriction>) -> Self {
        let terms = model.terms().iter().flatten();
        let passive = terms.filter_map(|w| Some((w.value, w.term.passive()?)));
        Self {
            robot: model.robot().clone(),
            passive: passive.collect(),
            friction,
        }
    }

    /// Law of a model with friction fitted to torque and motion, tables of shape (samples, joints).
    ///
    /// # Errors
    /// Joint that hardly moves.
    pub(super) fn fit(
        model: &TorqueModel,
        q: &Array2<f64>,
        qd: &Array2<f64>,
        qdd: &Array2<f64>,
        tau: &Array2<f64>,
    ) -> Result<Self, InversionError> {
        let mut law = Self::new(model, Vec::new());
        let mut left = vec![vec![0.0; tau.nrows()]; tau.ncols()];
        let mut workspace = Workspace::new(&law.robot);
        let mut torque = vec![0.0; tau.ncols()];
        for row in 0..tau.nrows() {
            let [q, qd, qdd] = [q, qd, qdd].map(|t| t.row(row).to_vec());
            inverse_dynamics(&law.robot, &mut workspace, &q, &qd, &qdd, &mut torque);
            law.springs(&q, &mut torque);
            for (joint, torque) in torque.iter().enumerate() {
                left[joint][row] = tau[[row, joint]] - torque;
            }
        }
        for (joint, left) in left.iter().enumerate() {
            let friction = JointFriction::fit(left, qd.column(joint), qdd.column(joint));
            law.friction.push(friction.ok_or(InversionError::Still)?);
        }
        Ok(law)
    }

    /// Robot with the identified parameters.
    pub(super) fn robot(&self) -> &Robot {
        &self.robot
    }

    /// Adds the torque of springs and counterbalances at position `q` to `torque`.
    fn springs(&self, q: &[f64], torque: &mut [f64]) {
        for (value, passive) in &self.passive {
            torque[passive.joint()] += value * passive.torque(q[passive.joint()]);
        }
    }

    /// Writes torque and derivatives of one sample to `at`. `softness` is the velocity over which friction's sign is
    /// softened, in RMS speeds of the joint.
    pub(super) fn derive(
        &self,
        q: &[f64],
        qd: &[f64],
        qdd: &[f64],
        softness: f64,
        at: &mut Derived,
    ) {
        let n = q.len();
        let Derived {
            torque,
            by: [by_q, by_qd, by_qdd],
            workspace,
            moved,
            other,
        } = at;
        inverse_dynamics(&self.robot, workspace, q, qd, qdd, torque);
        mass_matrix(&self.robot, workspace, q, by_qdd);
        for joint in 0..n {
            moved.copy_from_slice(q);
            moved[joint] += STEP;
            inverse_dynamics(&self.robot, workspace, moved, qd, qdd, other);
            (0..n).for_each(|i| by_q[i * n + joint] = (other[i] - torque[i]) / STEP);
            moved.copy_from_slice(qd);
            moved[joint] += STEP;
            inverse_dynamics(&self.robot, workspace, q, moved, qdd, other);
            (0..n).for_each(|i| by_qd[i * n + joint] = (other[i] - torque[i]) / STEP);
        }
        self.springs(q, torque);
        for (value, passive) in &self.passive {
            let joint = passive.joint();
            let rise = passive.torque(q[joint] + STEP) - passive.torque(q[joint]);
            by_q[joint * n + joint] += value * rise / STEP;
        }
        for (joint, f) in self.friction.iter().enumerate() {
            let [values, rates] =
                columns(qd[joint], qdd[joint], softness * f.speed, CURVED * f.speed);
            for (k, parameter) in f.parameters.iter().enumerate() {
                torque[joint] += parameter * values[k];
                by_qd[joint * n + joint] += parameter * rates[k];
            }
            by_qdd[joint * n + joint] += f.parameters[1];
        }
    }
}
