//! Fit of an arm's parameters to recorded motion. It minimises the prediction error of positions, simulated from the
//! recorded start of each block, with the given values as Gaussian prior.

mod descend;

pub use descend::{Descent, descend};

use crate::arm::Arm;
use crate::parameter::{Parameter, Scale};
use crate::simulate::{Track, Unstable, replay};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// Free parameter of a fit, with its prior. The fit works on its coordinate: the logarithm for [`Scale::Log`], else the
/// value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Free {
    /// Parameter that is fitted.
    pub parameter: Parameter,
    /// Prior mean and standard deviation of the coordinate; none for a flat prior.
    pub prior: Option<(f64, f64)>,
}

impl Free {
    /// Value of the parameter at coordinate `x`.
    pub fn value(&self, x: f64) -> f64 {
        match self.parameter.kind.scale() {
            Scale::Log => x.exp(),
            Scale::Positive => x.max(0.0),
            Scale::Free => x,
        }
    }

    /// Coordinate of the parameter at a value.
    pub fn coordinate(&self, value: f64) -> f64 {
        match self.parameter.kind.scale() {
            Scale::Log => value.ln(),
            _ => value,
        }
    }

    /// Derivative of the value with respect to the coordinate, at coordinate `x`.
    fn slope(&self, x: f64) -> f64 {
        match self.parameter.kind.scale() {
            Scale::Log => x.exp(),
            _ => 1.0,
        }
    }
}

/// Sums over the samples of a block, or of a trajectory: squared error r², and its first and second order terms in P
/// parameters. J is the sensitivity of the simulated position, and r the simulated less the recorded position.
#[derive(Debug, Clone)]
pub struct Sums {
    /// Index of the trajectory that the samples belong to.
    pub trajectory: usize,
    /// Number of samples.
    pub samples: f64,
    /// Sum Σ r² of squared errors of each joint, rad² (m²).
    pub squared: Vec<f64>,
    /// Sum Σ J r of each joint, P values: half the gradient of its squared error in the parameters' values.
    pub gradient: Vec<DVector<f64>>,
    /// Gauss-Newton matrix Σ J Jᵀ of each joint, P × P: half the Hessian of its squared error.
    pub hessian: Vec<DMatrix<f64>>,
}

impl Sums {
    /// Sums over no samples.
    fn zeros(trajectory: usize, joints: usize, parameters: usize) -> Self {
        Self {
            trajectory,
            samples: 0.0,
            squared: vec![0.0; joints],
            gradient: vec![DVector::zeros(parameters); joints],
            hessian: vec![DMatrix::zeros(parameters, parameters); joints],
        }
    }

    /// Adds the sums of another block.
    pub fn add(&mut self, other: &Self) {
        self.samples += other.samples;
        for j in 0..self.squared.len() {
            self.squared[j] += other.squared[j];
            self.gradient[j] += &other.gradient[j];
            self.hessian[j] += &other.hessian[j];
        }
    }
}

/// Noise model of one joint's error in the likelihood.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Variance that is added to the mean squared error, rad² (m²): that of the encoder's quantisation.
    pub floor: f64,
    /// Integrated autocorrelation time of the error, in samples, at least 1. So many samples count as one independent
    /// sample.
    pub correlation: f64,
}

/// Limits on the effort of a fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// Largest number of iterations.
    pub iterations: usize,
    /// Decrease of the objective in one iteration, nats, below which the fit ends.
    pub gain: f64,
    /// Longest integration step during the fit, s.
    pub step: f64,
}

/// Result of a fit: the arm at the optimum, and the expansion of the likelihood there.
#[derive(Debug, Clone)]
pub struct Fitted {
    /// Arm with the fitted values.
    pub arm: Arm,
    /// Fitted coordinate of each of the P free parameters.
    pub x: Vec<f64>,
    /// Objective at the optimum, nats: negative log likelihood plus negative log prior, up to constants.
    pub objective: f64,
    /// Gauss-Newton Hessian of the negative log likelihood in the coordinates, without the prior, P × P.
    pub information: DMatrix<f64>,
    /// Sums of each block at the optimum.
    pub blocks: Vec<Sums>,
    /// Noise model of each joint: the one that the fit's likelihood used. The search replaces it by one from the last
    /// fit's errors.
    pub noise: Vec<Noise>,
}

/// Sums of each block, computed in parallel. The result does not depend on the number of threads.
///
/// # Errors
/// Drive that is unstable.
pub fn sums(arm: &Arm, blocks: &[Track], parameters: &[Parameter]) -> Result<Vec<Sums>, Unstable> {
    blocks
        .par_iter()
        .map(|track| {
            let (n, p) = (arm.dof(), parameters.len());
            let mut out = Sums::zeros(track.trajectory, n, p);
            let mut add = |row: usize, q: &[f64], dq: &[f64]| {
                out.samples += 1.0;
                for j in 0..n {
                    let r = q[j] - track.q[(row, j)];
                    out.squared[j] += r * r;
                    let by = &dq[j * p..][..p];
                    for (a, &da) in by.iter().enumerate() {
                        if da == 0.0 {
                            continue;
                        }
                        out.gradient[j][a] += da * r;
                        let column = &mut out.hessian[j].as_mut_slice()[a * p..][..=a];
                        for (h, db) in column.iter_mut().zip(by) {
                            *h += da * db;
                        }
                    }
                }
            };
            replay(arm, track, parameters, &mut add)?;
            for h in &mut out.hessian {
                h.fill_lower_triangle_with_upper_triangle();
            }
            Ok(out)
        })
        .collect()
}

/// Simulated less recorded positions of a track, samples × joints, row by row.
///
/// # Errors
/// Drive that is unstable.
pub fn errors(arm: &Arm, track: &Track) -> Result<Vec<f64>, Unstable> {
    let mut out = Vec::with_capacity(track.q.len());
    replay(arm, track, &[], &mut |row, q, _| {
        out.extend(q.iter().enumerate().map(|(j, q)| q - track.q[(row, j)]));
    })?;
    Ok(out)
}

/// Noise model of each joint from the errors of this arm on all blocks. `floors` are the variances to add, by joint.
/// The autocorrelation time counts lags up to the first zero crossing (initial positive sequence; Geyer, 1992).
///
/// # Errors
/// Drive that is unstable.
pub fn noise(arm: &Arm, blocks: &[Track], floors: &[f64]) -> Result<Vec<Noise>, Unstable> {
    let n = arm.dof();
    let all: Vec<Vec<f64>> = blocks
        .par_iter()
        .map(|track| errors(arm, track))
        .collect::<Result<_, _>>()?;
    Ok((0..n)
        .map(|j| {
            let series: Vec<Vec<f64>> = all
                .iter()
                .map(|e| e.iter().skip(j).step_by(n).copied().collect())
                .collect();
            Noise {
                floor: floors[j],
                correlation: integrated(&series),
            }
        })
        .collect())
}

/// Integrated autocorrelation time 1 + 2 Σ ρ_k of some series together, in samples. Lags k count up to the first ρ_k
/// that is not positive.
fn integrated(series: &[Vec<f64>]) -> f64 {
    let product = |lag: usize| -> f64 {
        let each = series.iter().map(|s| {
            let pairs = s.iter().zip(s.iter().skip(lag));
            pairs.map(|(a, b)| a * b).sum::<f64>()
        });
        each.sum()
    };
    let variance = product(0);
    let longest = series.iter().map(Vec::len).max().unwrap_or(0) / 4;
    let mut time = 1.0;
    for lag in 1..longest {
        let rho = product(lag) / variance;
        if rho.is_nan() || rho <= 0.0 {
            break;
        }
        time += 2.0 * rho;
    }
    time
}

/// Negative log likelihood, nats, up to a constant: ½ Σ n ln(mean squared error + floor) over joints and trajectories. n
/// is the number of independent samples. Each trajectory has a variance of its own, because model errors are larger in
/// fast motions than in slow ones.
pub(crate) fn likelihood(trajectories: &[Sums], noise: &[Noise]) -> f64 {
    let of = |total: &Sums| -> f64 {
        let each = total.squared.iter().zip(noise).map(|(s, noise)| {
            0.5 * total.samples / noise.correlation * (s / total.samples + noise.floor).ln()
        });
        each.sum()
    };
    trajectories.iter().map(of).sum()
}

/// Negative log prior of the coordinates `x`, nats, up to a constant.
pub(crate) fn prior(free: &[Free], x: &[f64]) -> f64 {
    let each = free.iter().zip(x).filter_map(|(f, x)| {
        let (mean, deviation) = f.prior?;
        Some(0.5 * ((x - mean) / deviation).powi(2))
    });
    each.sum()
}

/// Log evidence, nats, up to a constant: Laplace approximation from the objective at a fit and its Hessian there.
pub(crate) fn evidence(free: &[Free], objective: f64, precision: &DMatrix<f64>) -> f64 {
    let deviations = free.iter().filter_map(|f| f.prior);
    let log_prior: f64 = deviations.map(|(_, deviation)| -deviation.ln()).sum();
    let determinant = precision.clone().cholesky().map_or(f64::INFINITY, |c| {
        c.l_dirty().diagonal().iter().map(|l| l.ln()).sum()
    });
    log_prior - objective - determinant
}

/// Maximum a posteriori fit by Levenberg and Marquardt, from the values of the arm `start`, with the expansion about
/// its optimum. Parameters of [`Scale::Positive`] stay at zero or above. `least` is the evidence that is worth all of the
/// effort (see [`descend`]).
///
/// # Errors
/// Arm at the start that is unstable.
pub fn fit(
    start: &Arm,
    free: &[Free],
    blocks: &[Track],
    noise: &[Noise],
    effort: Effort,
    least: Option<f64>,
) -> Result<Fitted, Unstable> {
    let Descent {
        arm,
        x,
        blocks: expanded,
    } = descend(start, free, blocks, noise, effort, least)?;
    let parameters: Vec<Parameter> = free.iter().map(|f| f.parameter).collect();
    let per_block = match expanded {
        Some(expanded) => expanded,
        None => sums(&arm, blocks, &parameters)?,
    };
    let total = by_trajectory(&per_block);
    let (_, information) = local(&total, noise, free, &x);
    Ok(Fitted {
        objective: likelihood(&total, noise) + prior(free, &x),
        arm,
        x,
        information,
        blocks: per_block,
        noise: noise.to_vec(),
    })
}

/// Negative log posterior of an arm in its free parameters, nats, up to a constant.
///
/// # Errors
/// Arm that is unstable.
pub fn objective(
    arm: &Arm,
    free: &[Free],
    blocks: &[Track],
    noise: &[Noise],
) -> Result<f64, Unstable> {
    let total = by_trajectory(&sums(arm, blocks, &[])?);
    let x: Vec<f64> = free
        .iter()
        .map(|f| f.coordinate(arm.get(f.parameter)))
        .collect();
    Ok(likelihood(&total, noise) + prior(free, &x))
}

/// Sums of each trajectory, from those of its blocks.
pub fn by_trajectory(blocks: &[Sums]) -> Vec<Sums> {
    let mut totals: Vec<Sums> = Vec::new();
    for block in blocks {
        match totals.iter_mut().find(|t| t.trajectory == block.trajectory) {
            Some(total) => total.add(block),
            None => totals.push(block.clone()),
        }
    }
    totals
}

/// Gradient (P values) and Gauss-Newton Hessian (P × P) of the negative log likelihood in the coordinates `x`.
pub fn local(
    trajectories: &[Sums],
    noise: &[Noise],
    free: &[Free],
    x: &[f64],
) -> (DVector<f64>, DMatrix<f64>) {
    let p = free.len();
    let slopes = DVector::from_iterator(p, free.iter().zip(x).map(|(f, x)| f.slope(*x)));
    let (mut gradient, mut information) = (DVector::zeros(p), DMatrix::zeros(p, p));
    for total in trajectories {
        for (j, noise) in noise.iter().enumerate() {
            let variance = total.squared[j] / total.samples + noise.floor;
            let weight = 1.0 / (noise.correlation * variance);
            gradient += &total.gradient[j] * weight;
            information += &total.hessian[j] * weight;
        }
    }
    gradient.component_mul_assign(&slopes);
    for i in 0..p {
        for k in 0..p {
            information[(i, k)] *= slopes[i] * slopes[k];
        }
    }
    (gradient, information)
}
