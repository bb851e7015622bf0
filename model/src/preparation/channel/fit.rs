//! Joint fit of delay, scale and offset of the torque of all joints.
//!
//! τ_j(t) = k_j (r_j + Σ_i Y_ji δ_i) + a_j q̈_j + friction + offset + e, all of it at t − d_j.
//!
//! Here r is the described robot's torque, Y the regressor of its standard parameters, and δ their errors, which all
//! joints share. Their prior is δ_i ~ N(0, (T s_i)²) with the size s_i of each parameter and one tolerance T. T is
//! determined by the evidence (MacKay 1992), and results for all tolerances are averaged with it.
//!
//! k_j and d_j have no prior. A joint gets no scale where its described torque hardly varies, or varies as its friction
//! and rotor do. It gets no delay where its torque hardly changes with the delay. Residuals are correlated in time:
//! each row counts as one over their correlation time. Standard deviations are the larger ones of posterior and
//! sandwich estimator over blocks of time.

use super::rows::Rows;
use super::systems::Systems;
use faer::linalg::solvers::{Llt, Solve};
use faer::{Mat, Side};
use physics::dynamics::{Workspace, mass_matrix};
use physics::robot::{PARAMETERS_PER_LINK, Robot};
use rayon::prelude::*;
use signal::delay::{Search, student_975};

/// Relative errors of the described inertials that are compared by evidence. No description is better than the first.
const TOLERANCES: [f64; 5] = [0.02, 0.04, 0.08, 0.16, 0.32];
/// Number of Gauss–Newton iterations.
const ROUNDS: usize = 6;
/// Largest change of a delay in one iteration, s.
const STEP: f64 = 0.02;
/// Shortest block for the sandwich estimator, in s and in correlation times of the residual; the longer one counts.
const BLOCK: [f64; 2] = [1.0, 4.0];
/// Index of the offset among a joint's own columns. Their order is scale, rotor, offset, friction, derivative by the
/// delay.
const OFFSET: usize = 2;

/// Value with its variance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moments {
    /// Estimated value.
    pub value: f64,
    /// Variance of the value.
    pub variance: f64,
}

/// Estimated torque channel of one joint.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    /// Delay of the torque after the motion, s.
    pub delay: Moments,
    /// Ratio of recorded to described torque.
    pub scale: Moments,
    /// Offset of the recorded torque, N·m (N).
    pub offset: Moments,
}

/// Estimated torque channels of all joints.
pub(super) struct Fitted {
    /// Channel of each joint; none where it cannot be estimated.
    pub joints: Vec<Option<Found>>,
    /// Number of blocks of time from which the deviations come.
    pub blocks: usize,
}

impl Fitted {
    /// Half width of the 95 % interval for a variance, by Student's quantile for the number of blocks.
    pub fn half_width(&self, variance: f64) -> f64 {
        student_975(self.blocks.saturating_sub(1)) * variance.sqrt()
    }
}

/// Fits all joints, starting from a common delay, s; none where nothing can be fitted.
pub(super) fn all(robot: &Robot, systems: &Systems, start: f64) -> Option<Fitted> {
    let n = robot.dof();
    let prior = Sizes::of(robot);
    let mut delays = vec![start; n];
    let mut k = vec![1.0; n];
    let mut own: Vec<Option<Vec<f64>>> = vec![None; n];
    for round in 0..ROUNDS {
        let rows: Vec<Option<Rows>> = (0..n)
            .into_par_iter()
            .map(|j| {
                Rows::new(
                    systems.joints[j].as_ref()?,
                    systems,
                    delays[j],
                    own[j].as_deref(),
                )
            })
            .collect();
        let each: Vec<Posterior> = TOLERANCES
            .par_iter()
            .filter_map(|t| posterior(&rows, &prior, *t, &k))
            .collect();
        let best = each
            .iter()
            .max_by(|a, b| a.evidence.total_cmp(&b.evidence))?;
        if round + 1 == ROUNDS {
            return Some(mixed(&rows, &each, best, systems, &delays));
        }
        for j in 0..n {
            let Some(rows) = &rows[j] else { continue };
            let coefficients = best.of_joint(j, rows, &k);
            k[j] = coefficients[rows.shared];
            if let Some(change) = rows.slope.then(|| coefficients[rows.width - 1]) {
                let [low, high] = Search::default().range;
                delays[j] = (delays[j] + change.clamp(-STEP, STEP)).clamp(low, high);
            }
            own[j] = Some(coefficients[..rows.shared + rows.own].to_vec());
        }
    }
    None
}

/// Typical sizes of the parameters that have a prior.
struct Sizes {
    /// Size of each standard parameter of the links, in its unit.
    inertials: Vec<f64>,
    /// Size of each joint's rotor inertia, kg·m²: the described robot's inertia about the joint's axis.
    rotors: Vec<f64>,
}

impl Sizes {
    /// Sizes for the described robot.
    fn of(robot: &Robot) -> Self {
        let n = robot.dof();
        let masses = || robot.joints().iter().map(|j| j.link.inertia.mass);
        let heaviest = masses().fold(f64::MIN_POSITIVE, f64::max);
        let mut inertials = Vec::with_capacity(PARAMETERS_PER_LINK * n);
        for joint in robot.joints() {
            let body = &joint.link.inertia;
            let mass = body.mass.max(1e-3 * heaviest);
            // Distance of the mass from the joint: centre and gyration.
            let arm = (0.5 * body.about_origin.trace().max(0.0) / mass)
                .sqrt()
                .max(1e-2);
            inertials.push(mass);
            inertials.extend([mass * arm; 3]);
            inertials.extend([mass * arm * arm; 6]);
        }
        let mut mass = vec![0.0; n * n];
        mass_matrix(robot, &mut Workspace::new(robot), &vec![0.0; n], &mut mass);
        Self {
            inertials,
            rotors: mass
                .into_iter()
                .step_by(n + 1)
                .map(|m| m.max(1e-6))
                .collect(),
        }
    }
}

/// Gaussian posterior for one tolerance. The unknowns are δ over tolerance and size, then the coefficients of each
/// joint's own columns.
struct Posterior {
    /// Relative error of the described inertials.
    tolerance: f64,
    /// Log evidence of the tolerance, nats, up to a constant.
    evidence: f64,
    /// Cholesky factor of the posterior precision.
    factor: Llt<f64>,
    /// Posterior mean of the unknowns.
    x: Mat<f64>,
    /// Index of the first unknown of each joint's own columns.
    starts: Vec<usize>,
    /// Prior deviation of each shared parameter, in its unit.
    scale_of_shared: Vec<f64>,
    /// Scale k of each joint's torque, as of the iteration before, in the products k·δ.
    k: Vec<f64>,
}

impl Posterior {
    /// Coefficients of one joint's columns: shared ones times its scale, then its own.
    fn of_joint(&self, joint: usize, rows: &Rows, k: &[f64]) -> Vec<f64> {
        let shared = (0..rows.shared).map(|i| k[joint] * self.scale_of_shared[i] * self.x[(i, 0)]);
        let own = (0..rows.width - rows.shared).map(|i| self.x[(self.starts[joint] + i, 0)]);
        shared.chain(own).collect()
    }
}

/// Posterior of all joints for one tolerance; none where it is improper.
fn posterior(rows: &[Option<Rows>], sizes: &Sizes, tolerance: f64, k: &[f64]) -> Option<Posterior> {
    let shared = sizes.inertials.len();
    let scale_of_shared: Vec<f64> = sizes.inertials.iter().map(|s| tolerance * s).collect();
    let mut total = shared;
    let mut starts = Vec::with_capacity(rows.len());
    for own in rows {
        starts.push(total);
        total += own.as_ref().map_or(0, |r| r.width - r.shared);
    }
    let (mut a, mut b) = (Mat::<f64>::zeros(total, total), Mat::<f64>::zeros(total, 1));
    for i in 0..shared {
        a[(i, i)] = 1.0;
    }
    let mut evidence = 0.0;
    for (j, own) in rows.iter().enumerate() {
        let Some(own) = own else { continue };
        let factor = |i: usize| {
            if i < shared {
                k[j] * scale_of_shared[i]
            } else {
                1.0
            }
        };
        let place = |i: usize| {
            if i < shared {
                i
            } else {
                starts[j] + i - shared
            }
        };
        let products = own.products(factor);
        let p = own.width;
        for c in 0..p {
            for d in 0..p {
                a[(place(c), place(d))] += own.weight * products[(c, d)];
            }
            b[(place(c), 0)] += own.weight * products[(c, p)];
        }
        a[(starts[j] + 1, starts[j] + 1)] += (k[j] * sizes.rotors[j]).powi(-2);
        evidence -= 0.5 * own.weight * products[(p, p)];
        // What never shows is kept from being singular.
        for c in shared..p {
            let at = place(c);
            a[(at, at)] += 1e-12 * (1.0 + own.weight * products[(c, c)]);
        }
    }
    let factor = a.llt(Side::Lower).ok()?;
    let x = factor.solve(&b);
    for i in 0..total {
        evidence += 0.5 * x[(i, 0)] * b[(i, 0)] - factor.L()[(i, i)].ln();
    }
    evidence.is_finite().then_some(Posterior {
        tolerance,
        evidence,
        factor,
        x,
        starts,
        scale_of_shared,
        k: k.to_vec(),
    })
}

/// Means and standard deviations over all tolerances, weighted by evidence. Deviations are at least those of the
/// sandwich estimator.
fn mixed(
    rows: &[Option<Rows>],
    each: &[Posterior],
    best: &Posterior,
    systems: &Systems,
    delays: &[f64],
) -> Fitted {
    let blocks = blocks(rows, systems);
    let scores = scores(rows, best, &blocks);
    let joints = rows
        .iter()
        .enumerate()
        .map(|(j, own)| {
            let own = own.as_ref().filter(|r| r.slope)?;
            let of = |which: usize| -> Moments {
                let (mut weight, mut mean, mut square) = (0.0, 0.0, 0.0);
                let mut sandwich = 0.0;
                for p in each {
                    let at = p.starts[j] + which;
                    let mut unit = Mat::zeros(p.x.nrows(), 1);
                    unit[(at, 0)] = 1.0;
                    let row = p.factor.solve(&unit);
                    let value = p.x[(at, 0)];
                    let w = (p.evidence - best.evidence).exp();
                    weight += w;
                    mean += w * value;
                    square += w * (row[(at, 0)] + value * value);
                    if p.tolerance == best.tolerance {
                        let prior: f64 = (0..own.shared).map(|i| row[(i, 0)].powi(2)).sum();
                        let over: f64 = scores
                            .iter()
                            .map(|s| {
                                s.iter()
                                    .enumerate()
                                    .map(|(i, s)| row[(i, 0)] * s)
                                    .sum::<f64>()
                            })
                            .map(|s: f64| s * s)
                            .sum();
                        sandwich = prior
                            + over * blocks.len() as f64 / (blocks.len() as f64 - 1.0).max(1.0);
                    }
                }
                let value = mean / weight;
                Moments {
                    value,
                    variance: (square / weight - value * value).max(sandwich),
                }
            };
            let change = of(own.width - own.shared - 1);
            Some(Found {
                delay: Moments {
                    value: delays[j] + change.value.clamp(-STEP, STEP),
                    ..change
                },
                scale: of(0),
                offset: of(OFFSET),
            })
        })
        .collect();
    Fitted {
        joints,
        blocks: blocks.len(),
    }
}

/// Blocks of rows that are nearly independent, the same for all joints.
fn blocks(rows: &[Option<Rows>], systems: &Systems) -> Vec<std::ops::Range<usize>> {
    let step = systems.steps.first().copied().unwrap_or(0.01);
    let Some(count) = rows.iter().flatten().map(|r| r.target.len()).max() else {
        return Vec::new();
    };
    let times: Vec<f64> = rows
        .iter()
        .flatten()
        .map(|r| r.correlation * step)
        .collect();
    let longest = times.into_iter().fold(0.0, f64::max);
    let size = (BLOCK[0].max(BLOCK[1] * longest) / step).max(1.0);
    let number = ((count as f64 / size).round() as usize).clamp(6.min(count), count.max(1));
    (0..number)
        .map(|b| b * count / number..(b + 1) * count / number)
        .collect()
}

/// Weighted products of columns and residual (scores), summed over each block and all joints.
fn scores(
    rows: &[Option<Rows>],
    best: &Posterior,
    blocks: &[std::ops::Range<usize>],
) -> Vec<Vec<f64>> {
    let mut all = vec![vec![0.0; best.x.nrows()]; blocks.len()];
    for (j, own) in rows.iter().enumerate() {
        let Some(own) = own else { continue };
        let coefficients = best.of_joint(j, own, &best.k);
        for (block, score) in blocks.iter().zip(&mut all) {
            for row in block.start..block.end.min(own.target.len()) {
                let line = &own.values[row * own.width..(row + 1) * own.width];
                let fit: f64 = line.iter().zip(&coefficients).map(|(a, b)| a * b).sum();
                let e = own.weight * (own.target[row] - fit);
                for (i, v) in line.iter().enumerate() {
                    let (at, factor) = if i < own.shared {
                        (i, best.k[j] * best.scale_of_shared[i])
                    } else {
                        (best.starts[j] + i - own.shared, 1.0)
                    };
                    score[at] += e * factor * v;
                }
            }
        }
    }
    all
}
