//! Weighted least squares over the axes' samples in motion.

use super::signals::out_of_reach;
use super::{Band, Signals};
use crate::{Machine, MachineError};
use identify::least_squares::{
    Accumulator, Gram, LeastSquaresError, Prior, SolveOptions, Triangle, block_covariance, solve,
};
use ndarray::{Array1, Array2};

/// Passes of the weights: residuals of the axes hardly change after the second.
const PASSES: usize = 4;

/// Blocks of time over which standard deviations are taken: residuals of a machine are correlated.
const BLOCKS: usize = 48;

/// Part of an axis's torque that its residual counts as at least: noise-free simulations weigh evenly.
const FLOOR: f64 = 1e-6;

/// Equations of every axis, by blocks of time.
pub struct AxisRows {
    /// Axis by axis, block by block.
    blocks: Vec<Vec<Triangle>>,
    /// Axis by axis, all blocks.
    whole: Vec<Triangle>,
}

/// Parameters with their deviations.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Values (C).
    pub values: Vec<f64>,
    /// Standard deviations (C).
    pub std: Vec<f64>,
    /// RMS residual of each axis, N·m or N.
    pub residual: Vec<f64>,
    /// How many combinations of the parameters the motion tells; below C some values are conventions.
    pub rank: usize,
}

impl AxisRows {
    /// Equations of the samples in motion.
    ///
    /// # Errors
    /// Positions that the machine cannot take.
    pub fn of(machine: &Machine, signals: &Signals, bands: &[Band]) -> Result<Self, MachineError> {
        let width = machine.parameters().len();
        Self::with(machine, signals, bands, width, |row, torque, equation| {
            equation.copy_from_slice(row);
            torque
        })
    }

    /// Equations of `columns` unknowns that `equation` writes from the machine's own row (C values) and the torque of a sample; it
    /// gives the right-hand side.
    ///
    /// # Errors
    /// Positions that the machine cannot take.
    pub fn with(
        machine: &Machine,
        signals: &Signals,
        bands: &[Band],
        columns: usize,
        equation: impl Fn(&[f64], f64, &mut [f64]) -> f64,
    ) -> Result<Self, MachineError> {
        let (n, width) = (machine.dof(), machine.parameters().len());
        let mut unknowns = vec![0.0; columns];
        let (total, motion) = (signals.motion.len(), &signals.motion);
        let mut blocks: Vec<Vec<Triangle>> = vec![Vec::with_capacity(BLOCKS); n];
        let mut rows = vec![0.0; n * width];
        for block in 0..BLOCKS {
            let mut axes: Vec<Accumulator> = (0..n).map(|_| Accumulator::new(columns)).collect();
            let part = block * total / BLOCKS..(block + 1) * total / BLOCKS;
            for row in part.filter(|&row| signals.kept[row]) {
                let at = |table: &Array2<f64>| table.row(row).to_vec();
                let (q, qd, qdd) = (at(&motion.q), at(&motion.qd), at(&motion.qdd));
                let moving: Vec<usize> = (0..n).filter(|&j| bands[j].holds(qd[j])).collect();
                if moving.is_empty() {
                    continue;
                }
                machine
                    .rows(&q, &qd, &qdd, &mut rows)
                    .map_err(|_| out_of_reach(&signals.source, row, &q))?;
                for j in moving {
                    let own = &rows[j * width..][..width];
                    let right = equation(own, signals.torque[(row, j)], &mut unknowns);
                    axes[j].push(&unknowns, right, 1.0)?;
                }
            }
            for (triangles, axis) in blocks.iter_mut().zip(axes) {
                triangles.push(axis.finish()?);
            }
        }
        let whole = blocks
            .iter()
            .map(Triangle::stack)
            .collect::<Result<_, _>>()?;
        Ok(Self { blocks, whole })
    }

    /// Equations of one axis.
    pub fn axis(&self, axis: usize) -> &Triangle {
        &self.whole[axis]
    }

    /// Number of axes.
    pub fn dof(&self) -> usize {
        self.whole.len()
    }
}

/// Least squares with every axis's rows weighted by its own residual; deviations from leaving out blocks of time.
///
/// # Errors
/// Nothing to fit.
pub fn fit(rows: &AxisRows) -> Result<Estimate, LeastSquaresError> {
    fit_towards(rows, None)
}

/// The same with what is known beforehand of the unknowns.
///
/// # Errors
/// Nothing to fit.
pub fn fit_towards(rows: &AxisRows, prior: Option<Prior>) -> Result<Estimate, LeastSquaresError> {
    // An axis without rows has nothing to be weighed.
    let deviation = |squares: f64, axis: &Triangle| match axis.rows() {
        0 => 1.0,
        rows => (squares / rows as f64).sqrt(),
    };
    let size = |axis: &Triangle| deviation(axis.target_sum_of_squares(), axis);
    let mut residual: Vec<f64> = rows.whole.iter().map(size).collect();
    let floor: Vec<f64> = residual
        .iter()
        .map(|s| (FLOOR * s).max(f64::MIN_POSITIVE))
        .collect();
    // Rows of the prior, which every fit without a block keeps.
    let held = match &prior {
        Some(prior) => {
            let root: Array1<f64> = prior.std.iter().map(|s| 1.0 / s).collect();
            let target = &root * &Array1::from(prior.mean.clone());
            Some(Triangle::of(
                Array2::from_diag(&root).view(),
                target.view(),
            )?)
        }
        None => None,
    };
    let options = SolveOptions {
        // A prior's deviations are in units: rows are weighted to a variance of one.
        sigma2: prior.as_ref().map(|_| 1.0),
        prior,
        ..SolveOptions::default()
    };
    let mut best = None;
    for _ in 0..PASSES {
        let weighted: Vec<Triangle> = std::iter::zip(&rows.whole, &residual)
            .map(|(axis, sigma)| axis.scaled(1.0 / sigma))
            .collect();
        let estimate = solve(&Triangle::stack(&weighted)?, &options)?;
        let weights = residual.clone();
        for ((sigma, axis), floor) in residual.iter_mut().zip(&rows.whole).zip(&floor) {
            let squares = axis.residual_sum_of_squares(&estimate.parameters)?;
            *sigma = deviation(squares, axis).max(*floor);
        }
        best = Some((estimate, weights));
    }
    let Some((estimate, weights)) = best else {
        return Err(LeastSquaresError::NoRows);
    };
    let blocks = (0..BLOCKS)
        .map(|block| {
            let axes: Vec<Triangle> = std::iter::zip(&rows.blocks, &weights)
                .map(|(axis, sigma)| axis[block].scaled(1.0 / sigma))
                .collect();
            Ok(Gram::from(&Triangle::stack(&axes)?))
        })
        .collect::<Result<Vec<Gram>, LeastSquaresError>>()?;
    let held = held.as_ref().map(Gram::from);
    let covariance = block_covariance(&blocks, &estimate, options.ridge, held.as_ref())?;
    let rank = estimate.rank;
    let estimate = estimate.with_covariance(covariance)?;
    Ok(Estimate {
        values: estimate.parameters,
        std: estimate.std,
        residual,
        rank,
    })
}
