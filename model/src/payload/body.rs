//! Parameters of a body from the rows of the payload estimate, and which of them are determined.

use super::size::Size;
use ::identify::least_squares::{
    Estimate, Gram, LeastSquaresError, Prior, SolveOptions, Triangle, block_covariance, solve,
};
use nalgebra::{Matrix3, Vector3};
use ndarray::{Array1, Array2};
use physics::robot::{Inertia, PARAMETERS_PER_LINK};
use serde::Serialize;

/// Value with its standard deviation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Figure {
    /// Estimated value of the parameter, in its SI unit.
    pub value: f64,
    /// Standard deviation of the value, in the same unit.
    pub std: f64,
}

/// Parameters of the body on the last link. A parameter is none where the motion does not determine it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Body {
    /// Mass of the body, kg.
    pub mass: Option<Figure>,
    /// Centre of mass in the last joint's frame, m.
    pub com: [Option<Figure>; 3],
    /// First moments m·c in the last joint's frame, kg·m.
    pub first_moment: [Option<Figure>; 3],
    /// Inertia Ixx, Ixy, Iyy, Ixz, Iyz, Izz about the centre of mass, in the directions of the last joint's frame,
    /// kg·m².
    pub inertia: [Option<Figure>; 6],
    /// Whether a body with these ten parameters can exist; none where not all of them are determined.
    pub possible: Option<bool>,
}

/// Result of one pass of the payload estimate.
pub(super) struct Settled {
    /// Determined parameters of the body, with standard deviations.
    pub(super) body: Body,
    /// Ten standard parameters of the body. Undetermined ones have the values of a plausible body.
    pub(super) parameters: [f64; PARAMETERS_PER_LINK],
    /// Values of all unknowns of the pass.
    pub(super) unknowns: Vec<f64>,
}

/// Largest standard deviation of a mass or first moment that counts as determined, relative to the largest that the
/// robot could carry.
const TOLD: f64 = 0.05;
/// Largest standard deviation of an inertia that counts as determined, relative to that of a plausible body.
const TOLD_INERTIA: f64 = 0.1;
/// Radius of gyration of a plausible body: as a part of the distance of its centre of mass, and at least so many m.
const GYRATION: (f64, f64) = (0.5, 0.1);
/// Number of repeated estimates with a prior about a plausible body's inertia, renewed from the last mass and centre of
/// mass. Only a body that the first, free estimate leaves undetermined needs them.
const PLAUSIBLE: usize = 3;

/// Parameters of the body. They are first estimated without constraint. Those that are not determined are then held
/// near the values of a plausible body.
pub(super) fn settle(
    triangle: &Triangle,
    blocks: &[Gram],
    size: &Size,
) -> Result<Settled, LeastSquaresError> {
    let width = triangle.columns();
    let mut prior = Prior {
        mean: vec![0.0; width],
        std: vec![1.0; width],
    };
    let widest = |i: usize| match i {
        0 => size.mass,
        1..=3 => size.mass * size.length,
        _ => size.mass * size.length * size.length,
    };
    for i in 0..PARAMETERS_PER_LINK {
        prior.std[i] = widest(i);
    }
    let mut estimate = solved(triangle, blocks, &prior)?;
    let moments: Vec<bool> = (0..4).map(|i| estimate.std[i] < TOLD * widest(i)).collect();
    let plausible = |e: &Estimate| {
        let p = ten(&e.parameters);
        let mass = p[0].abs();
        let com = Vector3::new(p[1], p[2], p[3]) / mass.max(1e-6 * size.mass);
        let com = com.cap_magnitude(size.length);
        let gyration = (GYRATION.0 * com.norm()).max(GYRATION.1);
        (mass, com, mass * gyration * gyration)
    };
    let (_, _, inertia) = plausible(&estimate);
    let told: Vec<bool> = (4..PARAMETERS_PER_LINK)
        .map(|i| estimate.std[i] < TOLD_INERTIA * inertia)
        .collect();
    let whole = told.iter().all(|&t| t) && moments.iter().all(|&t| t);
    if !whole {
        for _ in 0..PLAUSIBLE {
            let (mass, com, own) = plausible(&estimate);
            let body = Inertia::from_com(mass, com, Matrix3::identity() * own).parameters();
            prior.mean[4..PARAMETERS_PER_LINK].copy_from_slice(&body[4..]);
            for i in 4..PARAMETERS_PER_LINK {
                prior.std[i] = own.max(1e-9 * widest(i));
            }
            estimate = solved(triangle, blocks, &prior)?;
        }
    }
    let parameters = ten(&estimate.parameters);
    let ten_by_ten = (PARAMETERS_PER_LINK, PARAMETERS_PER_LINK);
    let covariance = Array2::from_shape_fn(ten_by_ten, |entry| estimate.covariance[entry]);
    Ok(Settled {
        body: figures(&parameters, &covariance, &moments, whole),
        parameters,
        unknowns: estimate.parameters,
    })
}

/// Estimate under a prior, with its covariance by the jackknife over blocks.
fn solved(
    triangle: &Triangle,
    blocks: &[Gram],
    prior: &Prior,
) -> Result<Estimate, LeastSquaresError> {
    let options = SolveOptions {
        sigma2: Some(1.0),
        prior: Some(prior.clone()),
        ..SolveOptions::default()
    };
    let estimate = solve(triangle, &options)?;
    // Rows that every fit without a block keeps: those of the prior.
    let root: Array1<f64> = prior.std.iter().map(|s| 1.0 / s).collect();
    let target = &root * &Array1::from(prior.mean.clone());
    let held = Triangle::of(Array2::from_diag(&root).view(), target.view())?;
    let covariance = block_covariance(blocks, &estimate, options.ridge, Some(&Gram::from(&held)))?;
    estimate.with_covariance(covariance)
}

/// Ten standard parameters of the body, the first of the unknowns.
fn ten(unknowns: &[f64]) -> [f64; PARAMETERS_PER_LINK] {
    std::array::from_fn(|i| unknowns[i])
}

/// Parameters of the body with standard deviations; those of quotients and products by linear propagation.
fn figures(
    p: &[f64; PARAMETERS_PER_LINK],
    covariance: &Array2<f64>,
    moments: &[bool],
    whole: bool,
) -> Body {
    let spread = |slope: &dyn Fn(usize) -> f64| {
        let mut sum = 0.0;
        for i in 0..PARAMETERS_PER_LINK {
            for j in 0..PARAMETERS_PER_LINK {
                sum += slope(i) * covariance[[i, j]] * slope(j);
            }
        }
        sum.max(0.0).sqrt()
    };
    let own = |i: usize| Figure {
        value: p[i],
        std: covariance[[i, i]].max(0.0).sqrt(),
    };
    let body = Inertia::from_parameters(p);
    let com = body.com();
    // Slopes of the inertia about the centre of mass, by central differences of a form that is smooth but at zero mass.
    let about = |i: usize, entry: (usize, usize)| {
        let step = 1e-6 * p[i].abs().max(1e-3 * p[0].abs());
        let at = |sign: f64| {
            let mut moved = *p;
            moved[i] += sign * step;
            Inertia::from_parameters(&moved).about_com()[entry]
        };
        (at(1.0) - at(-1.0)) / (2.0 * step)
    };
    let entries = [(0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2)];
    Body {
        mass: moments[0].then(|| own(0)),
        com: std::array::from_fn(|k| {
            let told = moments[0] && moments[k + 1] && p[0] > 2.0 * own(0).std;
            told.then(|| Figure {
                value: com[k],
                std: spread(&|i| match i {
                    0 => -com[k] / p[0],
                    i if i == k + 1 => 1.0 / p[0],
                    _ => 0.0,
                }),
            })
        }),
        first_moment: std::array::from_fn(|k| moments[k + 1].then(|| own(k + 1))),
        inertia: std::array::from_fn(|k| {
            whole.then(|| Figure {
                value: body.about_com()[entries[k]],
                std: spread(&|i| about(i, entries[k])),
            })
        }),
        possible: whole.then(|| body.is_consistent(1e-9)),
    }
}
