//! Sums over the rows of both recordings, by joint and block of time.

use super::known::KnownBody;
use crate::identify::design::{inertial_columns, rigid_columns};
use crate::payload::misfit::{SHAPES, shapes};
use crate::payload::noise::moving;
use crate::session::Session;
use ::identify::base::BaseParameters;
use ::identify::least_squares::{Accumulator, Gram, LeastSquaresError};
use ndarray::{Array1, Array2, ArrayView1, Axis, concatenate};
use physics::batch::rigid_torque;
use physics::effects::Term;
use physics::robot::{PARAMETERS_PER_LINK, Robot};
use physics::torque_model::{TorqueModel, WeightedTerm};

/// Largest number of blocks of time of both recordings together, for standard deviations.
const BLOCKS: usize = 96;
/// Size below which a shape counts as zero, N·m (N).
const SMALLEST: f64 = 1e-6;

/// Rows −Y β − F φ − Y_u p_u − S m + τ g = Y_k p_k of every joint, in N·m (N), with the recorded torque τ.
///
/// The unknowns are base parameters β, friction φ, unknown parameters p_u of the body, and gains g. Shapes with sizes m
/// describe the joint's error with the body. The right-hand side is the known part of the body, and springs.
pub(super) struct Rows {
    /// Columns of each joint without that of its gain, shape (samples, width of the joint), the loaded recording last.
    exact: Vec<Array2<f64>>,
    /// Indices of the joint's columns among all.
    places: Vec<Vec<usize>>,
    /// Known torque, shape (samples, joints).
    known: Array2<f64>,
    /// Recorded torque, shape (samples, joints).
    recorded: Array2<f64>,
    /// Prepared velocity, rad/s (m/s), shape (samples, joints), the loaded recording last. It tells rows in motion from
    /// rows at rest.
    pub(super) qd: Array2<f64>,
    /// Number of exact columns of all joints.
    pub(super) width: usize,
}

/// Sums of each joint over one block of time, at rest and in motion, over its own columns and its gain.
pub(super) struct Block(Vec<[Gram; 2]>);

impl Rows {
    /// Rows of a session of the recording without the body and the one with it.
    pub(super) fn new(
        model: &TorqueModel,
        base: &BaseParameters,
        session: &Session,
        recorded: [&Array2<f64>; 2],
        body: &KnownBody,
    ) -> Self {
        let robot = model.robot();
        let n = robot.dof();
        let first = PARAMETERS_PER_LINK * (n - 1);
        let last: Vec<usize> = (first..first + PARAMETERS_PER_LINK).collect();
        let rigid = rigid_columns(robot, base, session, 0..2, 1);
        let carried = inertial_columns(robot, &last, session, 1..2, 1);
        let load = loads(model.load_robot(), session, body);
        let unknown: Vec<usize> = body.unknown().collect();
        let samples = recorded.map(Array2::nrows);
        let mut known = Array2::zeros((samples[0] + samples[1], n));
        let (mut exact, mut places) = (Vec::new(), Vec::new());
        let fitted = |list: &[WeightedTerm]| -> Vec<Term> {
            let free = list.iter().filter(|w| w.term.passive().is_none());
            free.map(|w| w.term.clone()).collect()
        };
        let friction: usize = model.terms().iter().map(|l| fitted(l).len()).sum();
        let told = base.len() + friction + unknown.len();
        let mut offset = base.len();
        for (j, list) in model.terms().iter().enumerate() {
            let terms = fitted(list);
            let springs: Vec<&WeightedTerm> =
                list.iter().filter(|w| w.term.passive().is_some()).collect();
            let held: Vec<Term> = springs.iter().map(|w| w.term.clone()).collect();
            let value: Array1<f64> = springs.iter().map(|w| w.value).collect();
            let spring = session.columns(j, &held, &load, &[]);
            let own = session.columns(j, &terms, &load, &[]);
            let none = Array2::zeros((samples[0], unknown.len()));
            let free = carried[j][0].select(Axis(1), &unknown);
            let alike = Array2::zeros((samples[0], SHAPES));
            let motion = &session.parts[1].at_samples;
            let mut wrong = Array2::zeros((samples[1], SHAPES));
            for (k, mut row) in wrong.rows_mut().into_iter().enumerate() {
                row.assign(&ArrayView1::from(&shapes(
                    motion.q[[k, j]],
                    motion.qd[[k, j]],
                )));
            }
            exact.push(-concatenate![
                Axis(0),
                concatenate![Axis(1), rigid[j][0], own[0], none, alike],
                concatenate![Axis(1), rigid[j][1], own[1], free, wrong]
            ]);
            let weight = carried[j][0].dot(&Array1::from(body.parameters().to_vec()));
            let torque = concatenate![
                Axis(0),
                spring[0].dot(&value),
                spring[1].dot(&value) + weight
            ];
            known.column_mut(j).assign(&torque);
            places.push(
                (0..base.len())
                    .chain(offset..offset + terms.len())
                    .chain((0..unknown.len()).map(|k| base.len() + friction + k))
                    .chain(told + SHAPES * j..told + SHAPES * (j + 1))
                    .collect(),
            );
            offset += terms.len();
        }
        let motion = |part: usize| session.parts[part].at_samples.qd.view();
        Self {
            exact,
            places,
            known,
            recorded: concatenate![Axis(0), recorded[0].view(), recorded[1].view()],
            qd: concatenate![Axis(0), motion(0), motion(1)],
            width: told + SHAPES * n,
        }
    }

    /// Prior of each joint's shapes about zero, as rows of unit noise. `size` of a joint, N·m (N), is one standard
    /// deviation.
    ///
    /// # Errors
    /// A size that is NaN or infinite.
    pub(super) fn held(&self, chosen: &[usize], size: &[f64]) -> Result<Gram, LeastSquaresError> {
        let total = self.width + chosen.len();
        let first = self.width - SHAPES * size.len();
        let mut rows = Accumulator::new(total);
        for place in first..self.width {
            let mut row = vec![0.0; total];
            row[place] = 1.0;
            let size = size[(place - first) / SHAPES];
            rows.push(&row, 0.0, 1.0 / size.max(SMALLEST))?;
        }
        Ok(Gram::from(&rows.finish()?))
    }

    /// Sums by block of consecutive rows.
    ///
    /// # Errors
    /// Columns that are not finite.
    pub(super) fn blocks(&self) -> Result<Vec<Block>, LeastSquaresError> {
        let samples = self.recorded.nrows();
        let size = samples.div_ceil(BLOCKS).max(1);
        (0..samples)
            .step_by(size)
            .map(|start| self.block(start..(start + size).min(samples)))
            .collect()
    }

    /// Sums of each joint over some rows.
    fn block(&self, rows: std::ops::Range<usize>) -> Result<Block, LeastSquaresError> {
        let joint = |j: usize| {
            let width = self.exact[j].ncols() + 1;
            let mut sums = [Accumulator::new(width), Accumulator::new(width)];
            for k in rows.clone() {
                let moving = moving(self.qd[[k, j]]);
                let mut row = self.exact[j].row(k).to_vec();
                row.push(self.recorded[[k, j]]);
                sums[moving].push(&row, self.known[[k, j]], 1.0)?;
            }
            let [rest, moving] = sums;
            Ok([Gram::from(&rest.finish()?), Gram::from(&moving.finish()?)])
        };
        let joints: Result<Vec<_>, LeastSquaresError> = (0..self.exact.len()).map(joint).collect();
        joints.map(Block)
    }

    /// Sums of a block over all columns of the chosen joints, whose gains are last in that order. Rows of each
    /// joint, at rest and in motion, are multiplied by `scale`.
    ///
    /// # Errors
    /// None but programming errors.
    pub(super) fn weighted(
        &self,
        block: &Block,
        chosen: &[usize],
        scale: &[[f64; 2]],
    ) -> Result<Gram, LeastSquaresError> {
        let total = self.width + chosen.len();
        let mut all = Vec::new();
        for (at, &j) in chosen.iter().enumerate() {
            let mut places = self.places[j].clone();
            places.push(self.width + at);
            for (gram, scale) in block.0[j].iter().zip(scale[j]) {
                all.push(gram.scaled(scale).embed(&places, total)?);
            }
        }
        Gram::sum(&all)
    }

    /// Residual: recorded torque times its gain minus the torque by `parameters`, N·m (N), shape (samples,
    /// joints); zero for joints not chosen.
    pub(super) fn left(&self, chosen: &[usize], parameters: &[f64]) -> Array2<f64> {
        let mut left = Array2::zeros(self.recorded.raw_dim());
        for (at, &j) in chosen.iter().enumerate() {
            let own: Array1<f64> = self.places[j].iter().map(|&p| parameters[p]).collect();
            let gain = parameters[self.width + at];
            let torque = self.exact[j].dot(&own) + gain * &self.recorded.column(j);
            left.column_mut(j).assign(&(torque - self.known.column(j)));
        }
        left
    }
}

/// Load of load-dependent terms, N·m (N): by the model's own links, and with the body by these plus its known part.
fn loads(robot: &Robot, session: &Session, body: &KnownBody) -> Vec<Array2<f64>> {
    let mut parameters = robot.parameters();
    let first = parameters.len() - PARAMETERS_PER_LINK;
    for (p, b) in parameters[first..].iter_mut().zip(body.parameters()) {
        *p += b;
    }
    let mut load = session.load(robot);
    if let Ok(loaded) = robot.with_parameters(&parameters) {
        let m = &session.parts[1].fine;
        load[1] = rigid_torque(&loaded, &m.q, &m.qd, &m.qdd);
    }
    load
}
