//! Newton's method on a logarithmic barrier.

use super::cone;
use super::problem::{Constraints, FeasibilityError};
use faer::linalg::solvers::Solve;
use faer::{Mat, Side};
use physics::robot::PARAMETERS_PER_LINK;

/// Settings of the barrier method.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BarrierOptions {
    /// Duality gap at which to stop, in units of σ² (a thousandth of it moves no parameter by a noticeable part
    /// of its deviation). Default 1e-6.
    pub gap: f64,
    /// Factor on the weight of the objective from one centring to the next. Default 30.
    pub growth: f64,
    /// Largest number of Newton steps in all. Default 300.
    pub steps: usize,
}

impl Default for BarrierOptions {
    fn default() -> Self {
        Self {
            gap: 1e-6,
            growth: 30.0,
            steps: 300,
        }
    }
}

/// End of a barrier iteration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// End with a duality gap as small as asked.
    Solved,
    /// End by rounding before that. The result is feasible and the gap stated.
    Stalled,
    /// End by the largest number of steps. The result is feasible and the gap stated.
    StepLimit,
}

/// Quadratic function f(x) = xᵀ H x − 2 rᵀ x.
pub(super) struct Quadratic {
    pub hessian: Mat<f64>,
    pub right: Vec<f64>,
}

/// Result of the iteration: minimum with its bound.
pub(super) struct Minimum {
    pub x: Vec<f64>,
    pub objective: f64,
    pub gap: f64,
    pub status: Status,
    pub steps: usize,
}

/// Minimises f over the constraints from a strictly feasible `start` (Boyd and Vandenberghe, Convex
/// Optimization, section 11.3): centres t·f(x) + φ(x), φ = −Σ log det J_i − Σ log x_k, for growing t; the gap is
/// ν/t with ν = 4 per link and 1 per half-line. `unit` scales the unknowns, `sigma2` the gap.
pub(super) fn minimise(
    quadratic: &Quadratic,
    constraints: &Constraints,
    unit: &[f64],
    sigma2: f64,
    start: Vec<f64>,
    options: &BarrierOptions,
) -> Result<Minimum, FeasibilityError> {
    let s = start.len();
    let hessian = Mat::from_fn(s, s, |i, j| quadratic.hessian[(i, j)] * unit[i] * unit[j]);
    let nu = (4 * constraints.links.len() + constraints.nonnegative.len()).max(1) as f64;
    let target = options.gap * sigma2.max(f64::MIN_POSITIVE);
    let mut x = start;
    // First weight: barrier and objective pull equally hard at the start.
    let f = quadratic.slope(&x, unit);
    let phi = barrier_slope(constraints, &x, unit);
    let (f_norm, phi_norm) = (norm(&f), norm(&phi));
    let mut t = if f_norm > 0.0 {
        (phi_norm / f_norm).min(nu / target)
    } else {
        nu / target
    };
    let mut steps = 0;
    let mut status = Status::Solved;
    'path: loop {
        let last = nu / t <= target;
        loop {
            if steps == options.steps {
                status = Status::StepLimit;
                break 'path;
            }
            steps += 1;
            let Some(newton) = newton_step(quadratic, &hessian, constraints, unit, &x, t)? else {
                status = Status::Stalled;
                break 'path;
            };
            // λ²/2 estimates the distance from the centre; far less than ν is near enough to go on.
            // The step still to be taken squares what is left.
            let near = newton.decrement2 <= if last { 1e-4 } else { 0.25 };
            let Some(length) = line_search(&newton, constraints, &x, t) else {
                if !near {
                    status = Status::Stalled;
                    break 'path;
                }
                break;
            };
            for (xi, d) in std::iter::zip(&mut x, &newton.direction) {
                *xi += length * d;
            }
            if near {
                break;
            }
        }
        if last {
            break;
        }
        t = (t * options.growth).min(nu / target);
    }
    Ok(Minimum {
        objective: quadratic.value(&x),
        gap: nu / t,
        x,
        status,
        steps,
    })
}

impl Quadratic {
    fn times(&self, x: &[f64]) -> Vec<f64> {
        (0..x.len())
            .map(|i| {
                let column = self.hessian.col(i);
                column.iter().zip(x).map(|(h, x)| h * x).sum()
            })
            .collect()
    }

    fn value(&self, x: &[f64]) -> f64 {
        let hx = self.times(x);
        (0..x.len())
            .map(|i| x[i] * (hx[i] - 2.0 * self.right[i]))
            .sum()
    }

    /// Gradient ∇f in scaled unknowns.
    fn slope(&self, x: &[f64], unit: &[f64]) -> Vec<f64> {
        let hx = self.times(x);
        (0..x.len())
            .map(|i| 2.0 * (hx[i] - self.right[i]) * unit[i])
            .collect()
    }
}

/// ∇φ in scaled unknowns; zero outside the cone.
fn barrier_slope(constraints: &Constraints, x: &[f64], unit: &[f64]) -> Vec<f64> {
    let mut slope = vec![0.0; x.len()];
    for &at in &constraints.links {
        if let Some((gradient, _)) = cone::derivatives(&x[at..]) {
            for k in 0..PARAMETERS_PER_LINK {
                slope[at + k] += gradient[k] * unit[at + k];
            }
        }
    }
    for &i in &constraints.nonnegative {
        slope[i] -= unit[i] / x[i];
    }
    slope
}

struct Newton {
    /// Newton direction, in the units of x.
    direction: Vec<f64>,
    /// λ², the squared Newton decrement.
    decrement2: f64,
    /// Linear part of f along the direction: f(x + α d) − f(x) = α·slope + α²·curvature.
    slope: f64,
    curvature: f64,
}

/// Newton step; `None` where rounding leaves the Hessian indefinite.
fn newton_step(
    quadratic: &Quadratic,
    scaled_hessian: &Mat<f64>,
    constraints: &Constraints,
    unit: &[f64],
    x: &[f64],
    t: f64,
) -> Result<Option<Newton>, FeasibilityError> {
    let s = x.len();
    let f_slope = quadratic.slope(x, unit);
    let mut hessian = faer::Scale(2.0 * t) * scaled_hessian;
    let mut gradient = Mat::from_fn(s, 1, |i, _| t * f_slope[i]);
    for &at in &constraints.links {
        let Some((g, h)) = cone::derivatives(&x[at..]) else {
            return Ok(None);
        };
        for k in 0..PARAMETERS_PER_LINK {
            gradient[(at + k, 0)] += g[k] * unit[at + k];
            for l in 0..PARAMETERS_PER_LINK {
                hessian[(at + k, at + l)] += h[(k, l)] * unit[at + k] * unit[at + l];
            }
        }
    }
    for &i in &constraints.nonnegative {
        gradient[(i, 0)] -= unit[i] / x[i];
        hessian[(i, i)] += (unit[i] / x[i]).powi(2);
    }
    if !gradient.is_all_finite() {
        return Err(FeasibilityError::Singular);
    }
    let Ok(factor) = hessian.llt(Side::Lower) else {
        return Ok(None);
    };
    let step = factor.solve(&gradient);
    let direction: Vec<f64> = (0..s).map(|i| -step[(i, 0)]).collect();
    let decrement2 = (0..s).map(|i| step[(i, 0)] * gradient[(i, 0)]).sum();
    let slope = (0..s).map(|i| f_slope[i] * direction[i]).sum();
    let curvature = (0..s)
        .map(|i| {
            let column = scaled_hessian.col(i);
            let hd: f64 = column.iter().zip(&direction).map(|(h, d)| h * d).sum();
            direction[i] * hd
        })
        .sum();
    Ok(Some(Newton {
        direction: std::iter::zip(direction, unit)
            .map(|(d, u)| d * u)
            .collect(),
        decrement2,
        slope,
        curvature,
    }))
}

/// Largest halving of the full step that stays inside and decreases t·f + φ enough (Armijo, 0.01); differences
/// of f are taken analytically, so that large t does not drown them. `None` when none does.
fn line_search(newton: &Newton, constraints: &Constraints, x: &[f64], t: f64) -> Option<f64> {
    let here = barrier_value(constraints, x)?;
    let mut length = 1.0;
    let mut moved = x.to_vec();
    for _ in 0..50 {
        for i in 0..x.len() {
            moved[i] = x[i] + length * newton.direction[i];
        }
        if let Some(there) = barrier_value(constraints, &moved) {
            let f = length * newton.slope + length * length * newton.curvature;
            let rounding = 1e-13 * (here.abs() + there.abs());
            if t * f + there - here <= -0.01 * length * newton.decrement2 + rounding {
                return Some(length);
            }
        }
        length *= 0.5;
    }
    None
}

/// Value of the barrier φ at x; `None` where x breaks a constraint.
fn barrier_value(constraints: &Constraints, x: &[f64]) -> Option<f64> {
    let mut sum = 0.0;
    for &at in &constraints.links {
        sum += cone::value(&x[at..])?;
    }
    for &i in &constraints.nonnegative {
        if x[i].is_nan() || x[i] <= 0.0 {
            return None;
        }
        sum -= x[i].ln();
    }
    Some(sum)
}

fn norm(v: &[f64]) -> f64 {
    v.iter().map(|v| v * v).sum::<f64>().sqrt()
}
