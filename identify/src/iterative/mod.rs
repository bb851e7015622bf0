//! The iterative approach: noise covariance, outliers and friction exponent found along with the parameters.
//!
//! Three nested loops around weighted least squares (Han, Wu, Liu and Xiong, "An iterative approach for
//! accurate dynamic model identification of industrial robots", IEEE T-RO 36(5), 2020, section III and fig. 5):
//!
//! - L1 (inner): covariance Ω of the noise across joints, from the residual (eqs 16–18, 26–27);
//! - L2 (middle): weight of each row, from the normalised residual (eq. 28);
//! - L3 (outer): exponent α of each joint's friction Fc·sign(q̇) + Fv·|q̇|^α·sign(q̇) + B, from the torque that the
//!   other terms leave to friction (eqs 29–31).
//!
//! Rows are weighted before they are whitened across joints, by their residual over its own joint's deviation. The
//! paper weights whitened rows; those are mixtures of joints that change whenever Ω does, so that rows left out
//! return as others: on correlated noise with outliers Ω then grew without bound. For diagonal Ω both are the same.
//!
//! Each step solves the same problem (eq. 23), with or without the condition that every link be a possible body.
//! Ordinary and weighted least squares are the same loops with fewer of them ([`Noise`], [`Weight`]).

mod exponent;
mod noise;
mod problem;
#[cfg(test)]
mod tests;
mod weight;

pub use exponent::PowerLaw;
pub use noise::Noise;
use noise::{covariance, inverse_root, largest_change};
pub use problem::Problem;
pub use weight::Weight;

use crate::feasible::{Feasibility, FeasibilityError, Feasible};
use crate::least_squares::{
    Accumulator, Estimate, Gram, LeastSquaresError, SolveOptions, Triangle, solve,
};
use faer::Mat;
use ndarray::Array2;

/// Largest number of blocks of samples from which deviations are computed.
const BLOCKS: usize = 256;

/// Reason why an identification could not be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum IterativeError {
    /// Sizes that do not agree, values that are not finite, columns that do not exist.
    #[error(transparent)]
    LeastSquares(#[from] LeastSquaresError),
    /// The feasibility problem could not be solved.
    #[error(transparent)]
    Feasibility(#[from] FeasibilityError),
    /// Linear dependence of columns that the ridge cannot regularise.
    #[error(
        "the weighted system is numerically singular: too few samples are left, or their noise is zero"
    )]
    Singular,
}

/// Steps in which every link must be a possible body.
#[derive(Debug, Clone, Copy)]
pub enum Physical<'a> {
    /// Never: the estimate is the least-squares one.
    Free,
    /// The last step, on the weights and exponents found without the condition.
    LastStep(&'a Feasibility),
    /// Every step of the iteration.
    EveryStep(&'a Feasibility),
}

/// Settings of [`identify`]. The defaults are "Method 2" of Han et al. (2020).
#[derive(Debug, Clone)]
pub struct IterativeOptions<'a> {
    /// Form of the noise covariance. Default [`Noise::Full`].
    pub noise: Noise,
    /// Weight function of the middle loop. Default [`Weight::Hard`] with threshold 3.
    pub weight: Weight,
    /// Joints whose viscous friction is a power of speed. Default none.
    pub power_law: Option<PowerLaw>,
    /// Physical feasibility. Default [`Physical::Free`].
    pub physical: Physical<'a>,
    /// Change of Ω at which L1 stops: the largest of an entry, relative to the joints' deviations. Default 1e-7.
    pub noise_tolerance: f64,
    /// Mean change of the weights at which L2 stops. Default 1e-5.
    pub weight_tolerance: f64,
    /// Largest change of an exponent at which L3 stops. Default 1e-3.
    pub exponent_tolerance: f64,
    /// Largest number of rounds of L1, L2 and L3. Default 30 each.
    pub rounds: [usize; 3],
    /// Last solution: ridge, prior, subset of columns (see [`solve`]).
    pub solve: SolveOptions,
}

impl Default for IterativeOptions<'_> {
    fn default() -> Self {
        Self {
            noise: Noise::Full,
            weight: Weight::Hard { threshold: 3.0 },
            power_law: None,
            physical: Physical::Free,
            noise_tolerance: 1e-7,
            weight_tolerance: 1e-5,
            exponent_tolerance: 1e-3,
            rounds: [30; 3],
            solve: SolveOptions::default(),
        }
    }
}

/// Result of [`identify`]: parameters, noise and outliers.
#[derive(Debug, Clone)]
pub struct Identification {
    /// Least-squares estimate on the final weights, in whitened rows (σ² near one); free of the condition of
    /// feasibility, whose estimate is `feasible`.
    pub estimate: Estimate,
    /// The estimate under the condition of feasibility, where that was asked for.
    pub feasible: Option<Feasible>,
    /// Triangle of the whitened, weighted rows.
    pub triangle: Triangle,
    /// Normal equations of the whitened, weighted rows in up to 256 blocks of consecutive samples, for
    /// [`block_covariance`](crate::least_squares::block_covariance).
    pub blocks: Vec<Gram>,
    /// Noise covariance Ω, N × N, squared torque units.
    pub noise: Array2<f64>,
    /// Weight of each row, samples × N, from 0 (left out) to 1.
    pub weights: Array2<f64>,
    /// Measured less predicted torque, samples × N, of the feasible estimate if there is one.
    pub residual: Array2<f64>,
    /// Exponent α of each joint; one where friction is linear.
    pub exponents: Vec<f64>,
    /// Number of least-squares problems solved in all.
    pub solutions: usize,
    /// Whether every loop ended by its tolerance, and the last feasible solution before its steps were used up.
    pub converged: bool,
}

impl Identification {
    /// The parameters to use: the feasible ones where they were asked for.
    pub fn parameters(&self) -> &[f64] {
        match &self.feasible {
            Some(feasible) => &feasible.base,
            None => &self.estimate.parameters,
        }
    }
}

/// Identifies the parameters of `problem`; its power-law columns are left at the exponents found.
///
/// # Errors
/// Sizes that do not agree, values that are not finite, a singular system.
pub fn identify(
    problem: &mut Problem,
    options: &IterativeOptions,
) -> Result<Identification, IterativeError> {
    let n = problem.dof();
    if let Some(law) = &options.power_law {
        law.check(problem)?;
    }
    let mut state = State {
        parameters: vec![0.0; problem.columns()],
        standard: None,
        noise: Mat::identity(n, n),
        weights: problem.kept().clone(),
        solutions: 0,
        converged: true,
    };
    let mut exponents = match &options.power_law {
        Some(law) => law.starts(),
        None => vec![1.0; n],
    };
    if let Some(law) = &options.power_law {
        law.apply(problem, &exponents);
    }
    let mut settled = options.power_law.is_none();
    let mut previous = vec![0.0; n];
    for round in 0..options.rounds[2].max(1) {
        // Weights were judged with another exponent: start them afresh.
        state.weights.assign(problem.kept());
        state.middle_loop(problem, options)?;
        let Some(law) = &options.power_law else { break };
        if settled || round + 1 == options.rounds[2].max(1) {
            break;
        }
        let residual = problem.residual(&state.parameters);
        let steps = law.steps(
            problem,
            &exponents,
            &state.parameters,
            &residual,
            &state.weights,
        );
        settled = true;
        for (joint, step) in steps.iter().enumerate() {
            // Steps shrink geometrically, because the other columns absorb part of a wrong exponent; every second
            // one goes to the limit of the series (Aitken).
            let ratio = if previous[joint] == 0.0 {
                0.0
            } else {
                step / previous[joint]
            };
            let series = 1.0 / (1.0 - ratio.clamp(0.0, 0.9));
            settled &= (step * series).abs() <= options.exponent_tolerance;
            let step = if round % 2 == 1 { step * series } else { *step };
            exponents[joint] = (exponents[joint] + step).clamp(law.range.0, law.range.1);
        }
        law.apply(problem, &exponents);
        previous = steps;
    }
    state.converged &= settled;
    finish(problem, options, state, exponents)
}

/// State that the loops pass from step to step.
struct State {
    parameters: Vec<f64>,
    /// Standard parameters of the last feasible step, to start the next from.
    standard: Option<Vec<f64>>,
    noise: Mat<f64>,
    weights: Array2<f64>,
    solutions: usize,
    converged: bool,
}

impl State {
    /// L2: weights from the normalised residual, until they settle.
    fn middle_loop(
        &mut self,
        problem: &Problem,
        options: &IterativeOptions,
    ) -> Result<(), IterativeError> {
        for _ in 0..options.rounds[1].max(1) {
            self.inner_loop(problem, options)?;
            if options.weight == Weight::Equal {
                return Ok(());
            }
            let residual = problem.residual(&self.parameters);
            let mut change = 0.0;
            for joint in 0..problem.dof() {
                let deviation = self.noise[(joint, joint)].sqrt();
                let column = self.weights.column_mut(joint);
                let rows = residual
                    .column(joint)
                    .into_iter()
                    .zip(problem.kept().column(joint));
                for (w, (e, kept)) in std::iter::zip(column, rows) {
                    let new = kept * options.weight.of(e / deviation);
                    change += (new - *w).abs();
                    *w = new;
                }
            }
            if change <= options.weight_tolerance * self.weights.len() as f64 {
                return Ok(());
            }
        }
        self.converged = false;
        Ok(())
    }

    /// L1: parameters and noise covariance in turn, until the latter settles.
    fn inner_loop(
        &mut self,
        problem: &Problem,
        options: &IterativeOptions,
    ) -> Result<(), IterativeError> {
        for _ in 0..options.rounds[0].max(1) {
            let root = inverse_root(&self.noise)?.ok_or(IterativeError::Singular)?;
            let gram = problem.gram(&root, &self.weights);
            self.step(&gram, options)?;
            let residual = problem.residual(&self.parameters);
            let noise = covariance(
                &residual,
                &self.weights,
                problem.columns(),
                options.weight.variance_of_normal(),
                options.noise,
            );
            let change = largest_change(&noise, &self.noise);
            self.noise = noise;
            if change <= options.noise_tolerance {
                return Ok(());
            }
        }
        self.converged = false;
        Ok(())
    }

    fn step(&mut self, gram: &Gram, options: &IterativeOptions) -> Result<(), IterativeError> {
        self.solutions += 1;
        if let Physical::EveryStep(feasibility) = options.physical {
            let found = feasibility.fit_gram(gram, 1.0, self.standard.as_deref())?;
            self.parameters = found.base;
            self.standard = Some(found.standard);
            return Ok(());
        }
        let columns: Vec<usize> = match &options.solve.columns {
            Some(columns) => columns.clone(),
            None => (0..gram.columns()).collect(),
        };
        let mean = match &options.solve.prior {
            Some(prior) => prior.mean.clone(),
            None => vec![0.0; gram.columns()],
        };
        let fit = gram
            .about(&mean)?
            .fit(&columns, options.solve.ridge)?
            .ok_or(IterativeError::Singular)?;
        self.parameters.fill(0.0);
        for (&column, value) in std::iter::zip(&columns, fit.parameters) {
            self.parameters[column] = mean[column] + value;
        }
        Ok(())
    }
}

fn finish(
    problem: &Problem,
    options: &IterativeOptions,
    state: State,
    exponents: Vec<f64>,
) -> Result<Identification, IterativeError> {
    let root = inverse_root(&state.noise)?.ok_or(IterativeError::Singular)?;
    let mut rows = Accumulator::new(problem.columns());
    let all = 0..problem.samples();
    problem.whitened_blocks(all, &root, &state.weights, |block, live| {
        rows.push_block(block, live)
    });
    let triangle = rows.finish()?;
    let estimate = solve(&triangle, &options.solve)?;
    let feasible = match options.physical {
        Physical::Free => None,
        Physical::LastStep(feasibility) | Physical::EveryStep(feasibility) => {
            Some(feasibility.fit(&triangle, 1.0)?)
        }
    };
    let parameters = feasible.as_ref().map_or(&estimate.parameters, |f| &f.base);
    let n = problem.dof();
    Ok(Identification {
        residual: problem.residual(parameters),
        blocks: problem.block_grams(&root, &state.weights, BLOCKS),
        noise: Array2::from_shape_fn((n, n), |(j, k)| state.noise[(j, k)]),
        weights: state.weights,
        exponents,
        solutions: state.solutions + 1,
        converged: state.converged && feasible.as_ref().is_none_or(Feasible::converged),
        estimate,
        feasible,
        triangle,
    })
}
