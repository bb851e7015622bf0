//! The least-squares system of one joint: base parameters and terms against measured torque.

use crate::identify::target::Target;
use crate::session::Session;
use ::identify::base::BaseParameters;
use ::identify::least_squares::{Accumulator, Gram, LeastSquaresError, Triangle};
use datasets::metrics::MOVING;
use ndarray::{Array2, Axis};
use physics::batch::regressor_columns;
use physics::effects::Term;
use physics::robot::Robot;
use rayon::prelude::*;
use std::ops::Range;

/// Number of columns that one call of the torque's filter takes to the samples.
const TOGETHER: usize = 8;

/// Base columns of every joint and recording: `[joint][recording]`, shape (samples, base parameters).
pub type RigidColumns = Vec<Vec<Array2<f64>>>;

/// Base columns of some of the recordings at their samples, with the recorded torque's filter: see
/// [`datasets::Prepared::to_samples`]. Only every `every`-th sample is valid.
pub fn rigid_columns(
    robot: &Robot,
    base: &BaseParameters,
    session: &Session,
    recordings: Range<usize>,
    every: usize,
) -> RigidColumns {
    inertial_columns(robot, base.independent(), session, recordings, every)
}

/// Columns of any of the 10 N standard parameters, given by their indices, at the samples of some recordings.
pub fn inertial_columns(
    robot: &Robot,
    standard: &[usize],
    session: &Session,
    recordings: Range<usize>,
    every: usize,
) -> RigidColumns {
    let entries: Vec<(usize, usize)> = (0..robot.dof())
        .flat_map(|joint| standard.iter().map(move |&parameter| (joint, parameter)))
        .collect();
    let mut columns: RigidColumns = vec![Vec::new(); robot.dof()];
    for part in &session.parts[recordings] {
        let m = &part.fine;
        let needed = part.rows_for(every);
        let shape = (part.at_samples.len(), standard.len());
        let mut blocks = vec![Array2::zeros(shape); robot.dof()];
        // One trajectory at a time: the fine columns of all would take much memory.
        for (k, (rows, samples)) in m.segments.iter().zip(&part.at_samples.segments).enumerate() {
            let own = |t: &Array2<f64>| t.slice_axis(Axis(0), rows.clone().into()).to_owned();
            let [q, qd, qdd] = [&m.q, &m.qd, &m.qdd].map(own);
            let needed = |row: usize| needed[rows.start + row];
            let fine = regressor_columns(robot, &q, &qd, &qdd, &entries, needed);
            let resampled = |some: &[Vec<f64>]| {
                let some: Vec<&[f64]> = some.iter().map(Vec::as_slice).collect();
                part.to_samples_each(k..k + 1, &some)
            };
            let sampled: Vec<Vec<f64>> =
                fine.par_chunks(TOGETHER).flat_map_iter(resampled).collect();
            for (block, sampled) in blocks.iter_mut().zip(sampled.chunks(standard.len())) {
                for (mut to, from) in block.columns_mut().into_iter().zip(sampled) {
                    for (row, x) in samples.clone().zip(from) {
                        to[row] = *x;
                    }
                }
            }
        }
        for (list, block) in columns.iter_mut().zip(blocks) {
            list.push(block);
        }
    }
    columns
}

/// Data for the rows of all joints.
pub struct Data<'a> {
    /// Robot that the recordings are of.
    pub robot: &'a Robot,
    /// Base parameters of the robot.
    pub base: &'a BaseParameters,
    /// Columns of the base parameters.
    pub rigid: &'a RigidColumns,
    /// Prepared recordings of the session.
    pub session: &'a Session,
    /// Torque that the columns have to explain.
    pub target: &'a Target<'a>,
    /// Whether only moving samples are rows.
    pub moving_only: bool,
    /// Step between samples that are rows; with 1 all samples are.
    pub every: usize,
}

impl Data<'_> {
    /// Least-squares systems of all joints, with `blocks` for standard deviations or without.
    ///
    /// # Errors
    /// Columns that are not finite.
    pub fn systems(
        &self,
        terms: &[Vec<Term>],
        load: &[Array2<f64>],
        blocks: bool,
    ) -> Result<Vec<JointSystem>, LeastSquaresError> {
        (0..terms.len())
            .into_par_iter()
            .map(|joint| JointSystem::new(self, joint, &terms[joint], load, blocks))
            .collect()
    }

    /// Number of samples of all recordings.
    pub fn samples(&self) -> usize {
        self.target.tau.iter().map(|t| t.nrows()).sum()
    }

    /// Whether sample `row` of recording `part` is a row of the joint's system: every `every`-th is, with `moving_only` where
    /// the joint is faster than [`MOVING`].
    pub fn counts(&self, part: usize, row: usize, joint: usize) -> bool {
        row.is_multiple_of(self.every)
            && (!self.moving_only
                || self.session.parts[part].at_samples.qd[[row, joint]].abs() > MOVING)
    }
}

/// Largest number of blocks of samples for standard deviations.
const BLOCKS: usize = 256;
/// Fewest samples of a block.
const SHORTEST_BLOCK: usize = 8;

/// Normal equations of one joint over its own columns, by cell of the folds and by block.
pub struct JointSystem {
    /// Indices of the base parameters that act on the joint.
    acting: Vec<usize>,
    terms: usize,
    cells: Vec<Triangle>,
    /// Blocks of consecutive samples, the same for every joint.
    blocks: Vec<Gram>,
}

impl JointSystem {
    /// Builds the columns and folds them into normal equations; nothing of sample size is kept. `blocks`:
    /// whether to keep those for [`block_covariance`](::identify::least_squares::block_covariance).
    ///
    /// # Errors
    /// Columns that are not finite.
    pub fn new(
        data: &Data,
        joint: usize,
        terms: &[Term],
        load: &[Array2<f64>],
        blocks: bool,
    ) -> Result<Self, LeastSquaresError> {
        let rigid = &data.rigid[joint];
        let acting = acting(rigid);
        let term_columns = data.session.columns(joint, terms, load, &[]);
        let width = acting.len() + terms.len();
        let mut cells: Vec<Accumulator> = (0..data.target.folds.cells.len())
            .map(|_| Accumulator::new(width))
            .collect();
        let size = data.samples().div_ceil(BLOCKS).max(SHORTEST_BLOCK);
        let mut finished = Vec::new();
        let mut block = Accumulator::new(width);
        let mut a = vec![0.0; width];
        let mut seen = 0;
        for (part, tau) in data.target.tau.iter().enumerate() {
            for (rows, cell) in &data.target.folds.rows[part] {
                for row in rows.clone() {
                    if blocks && seen == size {
                        let full = std::mem::replace(&mut block, Accumulator::new(width));
                        finished.push(Gram::from(&full.finish()?));
                        seen = 0;
                    }
                    seen += 1;
                    if !data.counts(part, row, joint) {
                        continue;
                    }
                    for (a, &column) in a.iter_mut().zip(&acting) {
                        *a = rigid[part][[row, column]];
                    }
                    for (a, value) in a[acting.len()..]
                        .iter_mut()
                        .zip(term_columns[part].row(row))
                    {
                        *a = *value;
                    }
                    cells[*cell].push(&a, tau[[row, joint]], 1.0)?;
                    if blocks {
                        block.push(&a, tau[[row, joint]], 1.0)?;
                    }
                }
            }
        }
        if blocks {
            finished.push(Gram::from(&block.finish()?));
        }
        let cells = cells
            .into_iter()
            .map(Accumulator::finish)
            .collect::<Result<_, _>>()?;
        Ok(Self {
            acting,
            terms: terms.len(),
            cells,
            blocks: finished,
        })
    }

    /// System from the factors of stretches of consecutive rows. Their columns are the base parameters `acting`
    /// on this joint and `terms` terms; all stretches are one cell.
    ///
    /// # Errors
    /// No stretch, or stretches of different numbers of columns.
    pub fn of_blocks(
        acting: Vec<usize>,
        terms: usize,
        blocks: &[Triangle],
    ) -> Result<Self, LeastSquaresError> {
        Ok(Self {
            acting,
            terms,
            cells: vec![Triangle::stack(blocks)?],
            blocks: blocks.iter().map(Gram::from).collect(),
        })
    }

    /// Number of base parameters that act on this joint.
    pub fn rigid(&self) -> usize {
        self.acting.len()
    }

    /// Number of columns: base parameters, then terms.
    pub fn columns(&self) -> usize {
        self.acting.len() + self.terms
    }

    /// Number of cells of the folds.
    pub fn cells(&self) -> usize {
        self.cells.len()
    }

    /// Number of samples that are rows of the system.
    pub fn rows(&self) -> usize {
        self.cells.iter().map(Triangle::rows).sum()
    }

    /// Normal equations of each cell of the folds.
    pub fn grams(&self) -> Vec<Gram> {
        self.cells.iter().map(Gram::from).collect()
    }

    /// Indices of this joint's columns among all parameters when its terms begin at `offset`.
    pub fn map(&self, offset: usize) -> Vec<usize> {
        self.acting
            .iter()
            .copied()
            .chain(offset..offset + self.terms)
            .collect()
    }

    /// Root mean square of the measured torque, N·m (N).
    pub fn target_deviation(&self) -> f64 {
        let sum: f64 = self.cells.iter().map(Triangle::target_sum_of_squares).sum();
        (sum / self.rows() as f64).sqrt().max(f64::MIN_POSITIVE)
    }

    /// Root mean square of the residual with parameters in this joint's own order, N·m (N).
    ///
    /// # Errors
    /// A parameter vector of another length.
    pub fn deviation(&self, parameters: &[f64]) -> Result<f64, LeastSquaresError> {
        let mut sum = 0.0;
        for cell in &self.cells {
            sum += cell.residual_sum_of_squares(parameters)?;
        }
        Ok((sum / self.rows() as f64).sqrt().max(f64::MIN_POSITIVE))
    }
}

/// Factor on a joint's rows for a residual of standard deviation `sigma`. It is zero for a dead channel, whose error is zero.
pub fn scale(sigma: f64) -> f64 {
    if sigma <= f64::MIN_POSITIVE {
        0.0
    } else {
        1.0 / sigma
    }
}

/// One cell of the folds of all joints as one triangle over `total` parameters, each joint scaled by [`scale`].
pub fn joined(
    joints: &[(&JointSystem, Vec<usize>)],
    sigma: &[f64],
    cell: usize,
    total: usize,
) -> Result<Triangle, LeastSquaresError> {
    let mut whole = Triangle::empty(total);
    for ((system, map), sigma) in joints.iter().zip(sigma) {
        whole.merge(&system.cells[cell].scaled(scale(*sigma)).embed(map, total)?)?;
    }
    Ok(whole)
}

/// Blocks of all joints over `total` parameters, each joint scaled by [`scale`].
pub fn joined_blocks(
    joints: &[(&JointSystem, Vec<usize>)],
    sigma: &[f64],
    total: usize,
) -> Result<Vec<Gram>, LeastSquaresError> {
    let count = joints.first().map_or(0, |(system, _)| system.blocks.len());
    (0..count)
        .into_par_iter()
        .map(|block| {
            let mut whole = Gram::from(&Triangle::empty(total));
            for ((system, map), sigma) in joints.iter().zip(sigma) {
                let own = system.blocks[block].scaled(scale(*sigma));
                whole = whole.plus(&own.embed(map, total)?)?;
            }
            Ok(whole)
        })
        .collect()
}

/// Indices of columns that are not zero throughout: a joint does not feel the links before it.
fn acting(tables: &[Array2<f64>]) -> Vec<usize> {
    let count = tables.first().map_or(0, Array2::ncols);
    (0..count)
        .filter(|&c| {
            tables
                .iter()
                .any(|t| t.column(c).iter().any(|v| v.abs() > 1e-9))
        })
        .collect()
}
