//! Ordinary and weighted least squares from normal equations.

use super::options::{Estimator, EstimatorOptions, Lmi};
use super::possible::condition;
use super::solution::{EstimatorReport, Solution, made_possible, offsets};
use crate::identify::design::{Data, JointSystem, joined, joined_blocks};
use crate::identify::error::IdentifyError;
use ::identify::base::BaseParameters;
use ::identify::feasible::Feasible;
use ::identify::least_squares::{Gram, Triangle, block_covariance, solve as least_squares};
use ndarray::Array2;
use physics::effects::Term;
use physics::robot::Robot;
use rayon::prelude::*;

/// Number of passes in which the weights converge.
const PASSES: usize = 4;

/// Solves with the inverse standard deviations of the joints' residuals as weights, found in a few passes.
/// Ordinary least squares takes one pass with equal weights.
pub(super) fn solve(
    data: &Data,
    terms: Vec<Vec<Term>>,
    load: &[Array2<f64>],
    options: &EstimatorOptions,
) -> Result<Solution, IdentifyError> {
    let systems = data.systems(&terms, load, true)?;
    solve_systems((data.robot, data.base), &systems, terms, options)
}

/// Solves from the systems of all joints, with blocks, of a robot with these base parameters.
pub(crate) fn solve_systems(
    (robot, base): (&Robot, &BaseParameters),
    systems: &[JointSystem],
    terms: Vec<Vec<Term>>,
    options: &EstimatorOptions,
) -> Result<Solution, IdentifyError> {
    let (firsts, total) = offsets(base.len(), &terms);
    let joints: Vec<(&JointSystem, Vec<usize>)> = systems
        .iter()
        .zip(firsts)
        .filter(|(system, _)| system.rows() > 0)
        .map(|(system, first)| (system, system.map(first)))
        .collect();
    if joints.is_empty() {
        return Err(IdentifyError::NothingMoves);
    }
    let weighted = options.estimator != Estimator::Ols;
    let mut sigma: Vec<f64> = joints
        .iter()
        .map(|(s, _)| if weighted { s.target_deviation() } else { 1.0 })
        .collect();
    let settings = options.solve_options(base.len(), &terms);
    let given = match &options.given {
        Some(given) => Some(given.rows(total)?),
        None => None,
    };
    let passes = if weighted { PASSES } else { 1 };
    let mut pass = 0;
    loop {
        pass += 1;
        let cells: Vec<Triangle> = (0..systems[0].cells())
            .into_par_iter()
            .map(|cell| joined(&joints, &sigma, cell, total))
            .collect::<Result<_, _>>()?;
        let triangle = Triangle::stack(cells.iter().filter(|t| t.rows() > 0))?;
        let mut estimate = match &given {
            Some(rows) => least_squares(&Triangle::stack([&triangle, rows])?, &settings)?,
            None => least_squares(&triangle, &settings)?,
        };
        let last = pass == passes;
        let feasible = match options.lmi {
            Lmi::Every => true,
            Lmi::Last => last,
            Lmi::Off => false,
        };
        let feasible = if feasible {
            let condition = condition(robot, base, &terms, &triangle)?;
            Some(condition.fit(&triangle, estimate.sigma2)?)
        } else {
            None
        };
        let parameters = feasible.as_ref().map_or(&estimate.parameters, |f| &f.base);
        let mut deviations = Vec::with_capacity(joints.len());
        for (system, map) in &joints {
            let own: Vec<f64> = map.iter().map(|&c| parameters[c]).collect();
            deviations.push(system.deviation(&own)?);
        }
        if !last {
            sigma = deviations;
            continue;
        }
        let blocks = joined_blocks(&joints, &sigma, total)?;
        let covariance = block_covariance(
            &blocks,
            &estimate,
            settings.ridge,
            given.as_ref().map(Gram::from).as_ref(),
        )?;
        estimate = estimate.with_covariance(covariance)?;
        let free = estimate.parameters.clone();
        if let Some(feasible) = &feasible {
            estimate = made_possible(estimate, feasible)?;
        }
        let mut deviations = deviations.into_iter();
        let residual_std: Vec<f64> = systems
            .iter()
            .map(|s| match s.rows() {
                0 => 0.0,
                _ => deviations.next().unwrap_or(f64::NAN),
            })
            .collect();
        return Ok(Solution {
            report: EstimatorReport {
                estimator: options.estimator,
                lmi: options.lmi,
                ridge: settings.ridge,
                prior: options.prior.as_ref().map(|p| p.name.clone()),
                given_part: options.given.as_ref().map(|g| g.part),
                noise: diagonal(&residual_std),
                left_out: vec![0.0; terms.len()],
                exponents: vec![None; terms.len()],
                solutions: passes,
                converged: feasible.as_ref().is_none_or(Feasible::converged),
                every: 1,
            },
            estimate,
            free,
            terms,
            residual_std,
            triangle,
            feasible,
        });
    }
}

fn diagonal(std: &[f64]) -> Vec<Vec<f64>> {
    (0..std.len())
        .map(|i| {
            let mut row = vec![0.0; std.len()];
            row[i] = std[i] * std[i];
            row
        })
        .collect()
}
