//! Bounds on the parameters: links must be possible bodies, and friction must dissipate energy.
//!
//! The fit near the given parameters has no bounds. Noise can make a damping near zero negative, and move a
//! light link out of the cone of possible bodies. The estimate is moved to the nearest one inside, in the
//! metric of its own posterior. All that is fitted beside the parameters moves with them, so that text, tables,
//! patch and figures use one set of numbers.

use crate::motion::scene::Scale;
use crate::schema::Bounds;
use crate::search::find::Findings;
use crate::simulator::NominalModel;
use faer::linalg::solvers::Solve;
use faer::{Mat, Side};
use identify::feasible::{Constraints, Feasibility, Nominal};
use ndarray::{Array1, Array2};
use physics::robot::PARAMETERS_PER_LINK;

/// Negative eigenvalue of a pseudo-inertia, over the largest, that counts as rounding.
const ROUNDING: f64 = 1e-9;
/// Prior deviation about the nominal model, over a parameter's size: so wide that the posterior decides.
const FREE: f64 = 1e3;

/// Moves the fit near the given parameters to possible ones. None where they are possible already, and for an
/// identified model, whose parameters are combinations.
pub fn hold(model: &NominalModel, found: &mut Findings, scale: &Scale) -> Option<Bounds> {
    if model.is_identified() {
        return None;
    }
    let n = model.robot.dof();
    let inertial = PARAMETERS_PER_LINK * n;
    let joints = model.robot.joints();
    let friction = || {
        let damping = joints.iter().map(|j| j.damping);
        damping.chain(joints.iter().map(|j| j.friction))
    };
    let mut given = model.robot.parameters();
    given.extend(friction());
    let map = found.parameter_map();
    let beta = found.tight.1.clone();
    let mut fitted = given.clone();
    for (variable, parameter, size) in &map {
        fitted[*parameter] += size * beta[*variable];
    }
    // A link whose description is no body stays what it is: the patch finds one of the same torques.
    let links: Vec<usize> = (0..n)
        .filter(|&l| joints[l].link.inertia.is_consistent(ROUNDING))
        .map(|l| PARAMETERS_PER_LINK * l)
        .collect();
    let constraints = Constraints {
        links,
        nonnegative: (inertial..given.len()).collect(),
    };
    let of_link = |at: usize| Constraints {
        links: vec![at],
        nonnegative: Vec::new(),
    };
    let wrong_links: Vec<usize> = constraints
        .links
        .iter()
        .copied()
        .filter(|&at| of_link(at).smallest_eigenvalue(&fitted) < -ROUNDING)
        .collect();
    let negative: Vec<usize> = (inertial..given.len())
        .filter(|&p| fitted[p] < 0.0)
        .collect();
    if wrong_links.is_empty() && negative.is_empty() {
        return None;
    }
    let mut nominal = Nominal::of_robot(model.sizes(), &[]);
    nominal.parameters = given;
    nominal.std.iter_mut().for_each(|s| *s *= FREE);
    nominal
        .std
        .extend((0..2 * n).map(|f| FREE * scale.torque[f % n].max(1e-9)));

    let fit = found.tight_fit(scale);
    let near = inside(
        &beta,
        &fitted,
        &map,
        &fit.covariance(),
        constraints,
        nominal,
    )?;
    let error = |beta: &Array1<f64>| -> f64 {
        let each = fit.error_of(beta);
        let relative = each.iter().zip(&found.grams.total).zip(&scale.torque);
        let sum: f64 = relative
            .map(|((e, g), t)| (e.max(0.0) / g.samples.max(1.0)).sqrt() / t)
            .sum();
        sum / n as f64
    };
    let cost = error(&near.beta) - error(&beta);
    let names = |p: usize| joints[(p - inertial) % n].name.as_str();
    let kind = |p: usize| {
        if p < inertial + n {
            "viscous"
        } else {
            "Coulomb"
        }
    };
    let beyond = found.settings.measure.said.beyond;
    let clearly = negative
        .into_iter()
        .filter(|&p| fitted[p] < -beyond * near.deviation[p]);
    let links = wrong_links.into_iter().map(|at| {
        let link = &joints[at / PARAMETERS_PER_LINK].link.name;
        format!("inertials of {link}")
    });
    let held = links
        .chain(clearly.map(|p| format!("{} friction of {}", kind(p), names(p))))
        .collect();
    drop(fit);
    found.tight.1 = near.beta;
    Some(Bounds { held, cost })
}

/// A fit with possible parameters.
struct Inside {
    beta: Array1<f64>,
    /// Standard deviation of each parameter before the move.
    deviation: Vec<f64>,
}

/// Coefficients after their parameters are moved to the nearest possible ones, in the metric of the posterior,
/// so that correlated coefficients move along. `map` lists coefficient, parameter and change per unit. None
/// where the numerics fail.
fn inside(
    beta: &Array1<f64>,
    fitted: &[f64],
    map: &[(usize, usize, f64)],
    covariance: &Array2<f64>,
    constraints: Constraints,
    nominal: Nominal,
) -> Option<Inside> {
    // Covariance of variables and parameters, and of parameters.
    let (count, parameters) = (beta.len(), fitted.len());
    let mut cross = Mat::<f64>::zeros(count, parameters);
    for (variable, parameter, size) in map {
        for i in 0..count {
            cross[(i, *parameter)] += size * covariance[[i, *variable]];
        }
    }
    let mut own = Mat::<f64>::zeros(parameters, parameters);
    for (variable, parameter, size) in map {
        for p in 0..parameters {
            own[(*parameter, p)] += size * cross[(*variable, p)];
        }
    }
    let deviation: Vec<f64> = (0..parameters).map(|p| own[(p, p)].sqrt()).collect();
    let scaled = Mat::from_fn(parameters, parameters, |i, j| {
        own[(i, j)] / (deviation[i] * deviation[j])
    });
    let factor = scaled.llt(Side::Lower).ok()?;
    let inverse = factor.solve(Mat::<f64>::identity(parameters, parameters));
    let information = Mat::from_fn(parameters, parameters, |i, j| {
        inverse[(i, j)] / (deviation[i] * deviation[j])
    });
    let identity = Mat::<f64>::identity(parameters, parameters);
    let near = Feasibility::new(identity.as_ref(), constraints, nominal)
        .and_then(|f| f.nearest(fitted, information.as_ref()))
        .ok()?;
    let step = Mat::from_fn(parameters, 1, |i, _| {
        (near.standard[i] - fitted[i]) / deviation[i]
    });
    let weights = factor.solve(step);
    let moved = |i: usize| {
        let change: f64 = (0..parameters)
            .map(|p| cross[(i, p)] * weights[(p, 0)] / deviation[p])
            .sum();
        beta[i] + change
    };
    Some(Inside {
        beta: (0..count).map(moved).collect(),
        deviation,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::array;

    #[test]
    fn what_is_correlated_with_a_bounded_parameter_moves_with_it() {
        // Two frictions, the second in units of 2, and a cause that changes no parameter.
        let beta = array![-0.1, 0.2, 1.0];
        let fitted = [-0.1, 0.4];
        let map = [(0, 0, 1.0), (1, 1, 2.0)];
        let covariance = array![[0.04, 0.0, 0.03], [0.0, 0.01, 0.0], [0.03, 0.0, 0.09]];
        let constraints = Constraints {
            links: Vec::new(),
            nonnegative: vec![0, 1],
        };
        let nominal = Nominal {
            parameters: vec![0.0; 2],
            std: vec![1e3; 2],
        };
        let near = inside(&beta, &fitted, &map, &covariance, constraints, nominal).unwrap();
        assert!((near.deviation[1] - 0.2).abs() < 1e-12);
        let moved = near.beta;
        assert!(moved[0].abs() < 1e-5, "{moved}");
        assert!((moved[1] - 0.2).abs() < 1e-5, "{moved}");
        // 0.1 more of the first, times 0.03 over 0.04.
        assert!((moved[2] - 1.075).abs() < 1e-4, "{moved}");
    }
}
