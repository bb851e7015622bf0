//! Descent by Levenberg and Marquardt with bounds at zero.

use super::{Effort, Free, Noise, Sums, by_trajectory, evidence, likelihood, local, prior, sums};
use crate::arm::Arm;
use crate::parameter::{Parameter, Scale};
use crate::simulate::{Track, Unstable};
use nalgebra::{DMatrix, DVector};

/// End of a descent.
pub struct Descent {
    /// Arm at the lowest objective that was found.
    pub arm: Arm,
    /// Coordinates of that arm, in the order of the free parameters.
    pub x: Vec<f64>,
    /// Sums of each block at that arm; none where their sensitivities were not computed.
    pub(super) blocks: Option<Vec<Sums>>,
}

/// Descent to a lower objective from the values of the arm `start`: [`super::fit`] without the expansion. Where the log
/// evidence `least`, nats, has to be reached, it ends early once its last gain, repeated in every iteration left, would
/// not reach it.
///
/// # Errors
/// The arm as given is unstable.
pub fn descend(
    start: &Arm,
    free: &[Free],
    blocks: &[Track],
    noise: &[Noise],
    effort: Effort,
    least: Option<f64>,
) -> Result<Descent, Unstable> {
    let parameters: Vec<Parameter> = free.iter().map(|f| f.parameter).collect();
    let mut arm = start.clone();
    let scored = start.step;
    arm.step = effort.step;
    let mut x: Vec<f64> = free
        .iter()
        .map(|f| f.coordinate(start.get(f.parameter)))
        .collect();
    let mut lambda = 1e-3;
    let mut iterations = 0;
    let mut expanded = sums(&arm, blocks, &parameters)?;
    let mut objective = likelihood(&by_trajectory(&expanded), noise) + prior(free, &x);
    let reached = loop {
        iterations += 1;
        let (mut slope, mut curved) = local(&by_trajectory(&expanded), noise, free, &x);
        for (i, f) in free.iter().enumerate() {
            if let Some((mean, deviation)) = f.prior {
                slope[i] += (x[i] - mean) / deviation.powi(2);
                curved[(i, i)] += deviation.powi(-2);
            }
        }
        // Most first trials are taken, so that theirs have their sensitivities already.
        let mut next: Option<Step> = None;
        let mut first = true;
        while lambda < 1e8 {
            let coordinates = proposal(&curved, &slope, free, &x, lambda);
            // A step that promises less than ends the fit is not tried.
            if promised(&curved, &slope, &x, &coordinates) < effort.gain {
                break;
            }
            let asked: &[Parameter] = if first { &parameters } else { &[] };
            let tried = Step::to(&arm, free, coordinates, blocks, noise, asked);
            if let Some(step) = tried.filter(|t| t.objective < objective) {
                lambda = (lambda / 5.0).max(1e-9);
                next = Some(step);
                break;
            }
            first = false;
            lambda *= 4.0;
        }
        let Some(step) = next else {
            break Some(expanded);
        };
        let gain = objective - step.objective;
        (arm, x, objective) = (step.arm, step.x, step.objective);
        let own = first.then_some(step.blocks);
        let left = effort.iterations.saturating_sub(iterations) as f64;
        let hopeless =
            least.is_some_and(|least| evidence(free, objective, &curved) + left * gain < least);
        if gain < effort.gain || left == 0.0 || hopeless {
            break own;
        }
        expanded = match own {
            Some(own) => own,
            None => sums(&arm, blocks, &parameters)?,
        };
    };
    arm.step = scored;
    Ok(Descent {
        arm,
        x,
        blocks: reached.filter(|_| scored == effort.step),
    })
}

/// Decrease of the objective by a step to `next`, nats, as the expansion about `x` has it.
fn promised(curved: &DMatrix<f64>, slope: &DVector<f64>, x: &[f64], next: &[f64]) -> f64 {
    let step = DVector::from_iterator(x.len(), next.iter().zip(x).map(|(n, x)| n - x));
    -slope.dot(&step) - 0.5 * step.dot(&(curved * &step))
}

/// Trial step of a descent.
struct Step {
    arm: Arm,
    x: Vec<f64>,
    blocks: Vec<Sums>,
    objective: f64,
}

impl Step {
    /// Trial step to the coordinates `x`, with sensitivities for the parameters `asked`. None where that arm cannot be
    /// simulated.
    fn to(
        arm: &Arm,
        free: &[Free],
        x: Vec<f64>,
        blocks: &[Track],
        noise: &[Noise],
        asked: &[Parameter],
    ) -> Option<Self> {
        let mut arm = arm.clone();
        let values: Vec<(Parameter, f64)> = free
            .iter()
            .zip(&x)
            .map(|(f, &x)| (f.parameter, f.value(x)))
            .collect();
        arm.set(&values).ok()?;
        let blocks = sums(&arm, blocks, asked).ok()?;
        let objective = likelihood(&by_trajectory(&blocks), noise) + prior(free, &x);
        objective.is_finite().then_some(Self {
            arm,
            x,
            blocks,
            objective,
        })
    }
}

/// Coordinates after one Levenberg-Marquardt step with damping `lambda`. `slope` and `curved` are gradient and Hessian of
/// the objective. A coordinate at its bound zero that would cross it stays there.
fn proposal(
    curved: &DMatrix<f64>,
    slope: &DVector<f64>,
    free: &[Free],
    x: &[f64],
    lambda: f64,
) -> Vec<f64> {
    let p = free.len();
    let bounded = |i: usize| free[i].parameter.kind.scale() == Scale::Positive;
    let mut fixed: Vec<bool> = (0..p)
        .map(|i| curved[(i, i)] == 0.0 || (bounded(i) && x[i] <= 0.0 && slope[i] > 0.0))
        .collect();
    let mut next = x.to_vec();
    // What would pass its bound is held there, and the others are solved for again.
    for _ in 0..=p {
        let open: Vec<usize> = (0..p).filter(|&i| !fixed[i]).collect();
        let m = open.len();
        let mut a = DMatrix::zeros(m, m);
        let mut b = DVector::zeros(m);
        for (r, &i) in open.iter().enumerate() {
            b[r] = -slope[i];
            for (c, &k) in open.iter().enumerate() {
                a[(r, c)] = curved[(i, k)];
            }
            // Steps to a bound that are part of this proposal bend the others.
            for k in (0..p).filter(|&k| fixed[k]) {
                b[r] -= curved[(i, k)] * (next[k] - x[k]);
            }
            a[(r, r)] += lambda * curved[(i, i)];
        }
        let Some(factor) = a.cholesky() else { break };
        let step = factor.solve(&b);
        let mut passed = false;
        for (r, &i) in open.iter().enumerate() {
            next[i] = x[i] + step[r];
            match free[i].parameter.kind.scale() {
                // A factor of e at most in one step.
                Scale::Log => next[i] = next[i].clamp(x[i] - 1.0, x[i] + 1.0),
                Scale::Positive if next[i] < 0.0 => {
                    next[i] = 0.0;
                    fixed[i] = true;
                    passed = true;
                }
                _ => {}
            }
        }
        if !passed {
            break;
        }
    }
    next
}
