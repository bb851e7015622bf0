//! Reweighted and iterative least squares, on rows in memory.

use super::options::{Estimator, EstimatorOptions, Lmi};
use super::possible::{condition, is_plain};
use super::solution::{EstimatorReport, Solution, made_possible, offsets};
use crate::identify::design::Data;
use crate::identify::error::IdentifyError;
use ::identify::iterative::{
    Identification, IterativeOptions, Noise, Physical, PowerLaw, Problem, identify,
};
use ::identify::least_squares::block_covariance;
use faer::Mat;
use ndarray::Array2;
use physics::effects::{Sliding, Term};

/// Largest memory for the rows, bytes. Longer recordings are thinned.
const MEMORY: usize = 1 << 30;

/// Estimates base parameters and terms by reweighted or iterative least squares. Where exponents of viscous friction
/// are found, the terms are changed to them and fitted again.
pub(super) fn solve(
    data: &Data,
    mut terms: Vec<Vec<Term>>,
    load: &[Array2<f64>],
    options: &EstimatorOptions,
) -> Result<Solution, IdentifyError> {
    let n = terms.len();
    let mut exponents = vec![None; n];
    let mut rows = Rows::new(data, &terms, load)?;
    let mut found = rows.identify(data, &terms, options)?;
    let mut solutions = found.solutions;
    let mut converged = found.converged;
    if rows.law.is_some() {
        // Columns of the exponents found, made as finely and filtered like all others.
        for (joint, list) in terms.iter_mut().enumerate() {
            let exponent = found.exponents[joint];
            for term in list.iter_mut().filter(|t| is_viscous(t)) {
                *term = Term::Sliding(Sliding::Power { exponent });
                exponents[joint] = Some(exponent);
            }
        }
        rows = Rows::new(data, &terms, load)?;
        found = rows.identify(data, &terms, options)?;
        solutions += found.solutions;
        converged &= found.converged;
    }
    let settings = options.solve_options(data.base.len(), &terms);
    let covariance = block_covariance(&found.blocks, &found.estimate, settings.ridge, None)?;
    let mut estimate = found.estimate.with_covariance(covariance)?;
    let free = estimate.parameters.clone();
    if let Some(feasible) = &found.feasible {
        estimate = made_possible(estimate, feasible)?;
    }
    let mut residual_std = Vec::with_capacity(n);
    let mut left_out = Vec::with_capacity(n);
    for joint in 0..n {
        let kept = |k: usize| rows.kept[(k, joint)];
        let all = (0..rows.samples).filter(|&k| kept(k)).count();
        let used = (0..rows.samples).filter(|&k| found.weights[(k, joint)] > 0.0);
        let (count, sum) = used.fold((0usize, 0.0), |(count, sum), k| {
            (count + 1, sum + found.residual[(k, joint)].powi(2))
        });
        residual_std.push((sum / count.max(1) as f64).sqrt());
        left_out.push(1.0 - count as f64 / all.max(1) as f64);
    }
    Ok(Solution {
        report: EstimatorReport {
            estimator: options.estimator,
            lmi: options.lmi,
            ridge: settings.ridge,
            prior: options.prior.as_ref().map(|p| p.name.clone()),
            given_part: None,
            noise: found.noise.rows().into_iter().map(|r| r.to_vec()).collect(),
            left_out,
            exponents,
            solutions,
            converged,
            every: rows.every,
        },
        estimate,
        free,
        terms,
        residual_std,
        triangle: found.triangle,
        feasible: found.feasible,
    })
}

/// Whether a term is viscous friction.
fn is_viscous(term: &Term) -> bool {
    *term == Term::Sliding(Sliding::Viscous)
}

/// Rows of all joints, kept in memory.
struct Rows {
    /// Least-squares problem of the rows.
    problem: Problem,
    /// Whether each row is used, shape (samples, joints).
    kept: Array2<bool>,
    /// Number of samples used.
    samples: usize,
    /// Step between the samples that are used.
    every: usize,
    /// Viscous columns whose exponent is free; none where no joint has one.
    law: Option<PowerLaw>,
}

impl Rows {
    /// Rows of the recordings with these terms.
    fn new(data: &Data, terms: &[Vec<Term>], load: &[Array2<f64>]) -> Result<Self, IdentifyError> {
        let n = terms.len();
        let (firsts, total) = offsets(data.base.len(), terms);
        let bytes = data.samples() * n * (total + 1) * size_of::<f64>();
        let every = bytes.div_ceil(MEMORY).max(1);
        let places: Vec<(usize, usize)> = data
            .target
            .tau
            .iter()
            .enumerate()
            .flat_map(|(part, tau)| (0..tau.nrows()).map(move |row| (part, row)))
            .step_by(every)
            .collect();
        let samples = places.len();
        let mut joints = Vec::with_capacity(n);
        for (joint, list) in terms.iter().enumerate() {
            let own = data.session.columns(joint, list, load, &[]);
            let first = firsts[joint];
            let rigid = &data.rigid[joint];
            joints.push(Mat::from_fn(samples, total + 1, |k, c| {
                let (part, row) = places[k];
                if !data.counts(part, row, joint) {
                    0.0
                } else if c == total {
                    data.target.tau[part][[row, joint]]
                } else if c < data.base.len() {
                    rigid[part][[row, c]]
                } else if (first..first + list.len()).contains(&c) {
                    own[part][[row, c - first]]
                } else {
                    0.0
                }
            }));
        }
        let kept = Array2::from_shape_fn((samples, n), |(k, joint)| {
            let (part, row) = places[k];
            data.counts(part, row, joint)
        });
        let mut problem = Problem::of_joints(joints)?;
        for ((k, joint), kept) in kept.indexed_iter() {
            if !kept {
                problem.leave_out(k, joint);
            }
        }
        if !kept.iter().any(|k| *k) {
            return Err(IdentifyError::NothingMoves);
        }
        let columns: Vec<Option<usize>> = terms
            .iter()
            .zip(firsts)
            .map(|(list, first)| {
                let viscous = list.iter().position(is_viscous);
                viscous.filter(|_| is_plain(list)).map(|k| first + k)
            })
            .collect();
        let law = columns.iter().any(Option::is_some).then(|| {
            let velocity = Array2::from_shape_fn((samples, n), |(k, joint)| {
                let (part, row) = places[k];
                data.session.parts[part].at_samples.qd[[row, joint]]
            });
            PowerLaw::new(columns, velocity)
        });
        Ok(Self {
            problem,
            kept,
            samples,
            every,
            law,
        })
    }

    /// Solves the problem with the options of the estimator.
    fn identify(
        &mut self,
        data: &Data,
        terms: &[Vec<Term>],
        options: &EstimatorOptions,
    ) -> Result<Identification, IdentifyError> {
        let (noise, power_law) = match options.estimator {
            Estimator::Iterative => (Noise::Full, self.law.clone()),
            _ => {
                self.law = None;
                (Noise::PerJoint, None)
            }
        };
        let settings = IterativeOptions {
            noise,
            weight: options.weight,
            power_law,
            solve: options.solve_options(data.base.len(), terms),
            ..IterativeOptions::default()
        };
        if options.lmi == Lmi::Off {
            return Ok(identify(&mut self.problem, &settings)?);
        }
        // The scale of the friction terms, from a fit without the condition.
        let free = IterativeOptions {
            power_law: None,
            rounds: [2, 1, 1],
            ..settings.clone()
        };
        let scale = identify(&mut self.problem, &free)?.triangle;
        let condition = condition(data.robot, data.base, terms, &scale)?;
        let physical = match options.lmi {
            Lmi::Every => Physical::EveryStep(&condition),
            _ => Physical::LastStep(&condition),
        };
        Ok(identify(
            &mut self.problem,
            &IterativeOptions {
                physical,
                ..settings
            },
        )?)
    }
}
