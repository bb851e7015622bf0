//! Quality of an identification: conditioning, residual tests, possible links.

use crate::identify::error::IdentifyError;
use crate::identify::estimators::constrained;
use crate::identify::identification::Identified;
use ::identify::feasible::Feasible;
use ::identify::least_squares::{LeastSquaresError, SubRegressors};
use ::identify::residuals::{ResidualTests, residual_tests};
use physics::effects::Term;
use physics::robot::{Inertia, PARAMETERS_PER_LINK, Robot};
use serde::{Deserialize, Serialize};

/// Relative standard deviation above which a parameter counts as poorly determined.
pub const POOR: f64 = 0.3;

/// Quality of an identification, in `model.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Diagnostics {
    /// Report of the estimator with its options.
    pub estimator: crate::identify::estimators::EstimatorReport,
    /// Condition numbers of the weighted regressor.
    pub conditioning: Conditioning,
    /// Base parameters whose standard deviation exceeds 30 % of their value.
    pub poorly_determined: Vec<String>,
    /// Tests of each joint's training residual; none where it cannot be tested.
    pub residual_tests: Vec<Option<ResidualTests>>,
    /// Links of the identified URDF; empty where no possible links were found.
    pub links: Vec<PossibleLink>,
    /// Largest distance of a base parameter of the possible links from its estimate, in standard deviations.
    pub moved: Option<f64>,
    /// Training error with the possible links, beside that of the free estimate.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cost: Option<PossibleCost>,
}

/// Root mean squared error on the training rows, each joint's over its residual's standard deviation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PossibleCost {
    /// Training error of the estimate without the condition that links be possible.
    pub free: f64,
    /// Training error with the parameters of possible links.
    pub possible: f64,
}

/// Condition numbers of the regressor and its parts, rows weighted as in the fit; none where a part is empty or lacks
/// rank.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Conditioning {
    /// Condition number of all columns.
    pub whole: Option<f64>,
    /// Condition number of all columns, each scaled to unit norm, which removes the units.
    pub scaled: Option<f64>,
    /// Condition number of second moments and rotor inertias.
    pub inertial: Option<f64>,
    /// Condition number of first moments and masses.
    pub gravity: Option<f64>,
    /// Condition number of friction, memory and offset.
    pub friction: Option<f64>,
}

/// Link of the identified URDF.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PossibleLink {
    /// Name of the link in the URDF.
    pub link: String,
    /// Eigenvalues of the link's 4 × 4 pseudo-inertia, ascending, each over the largest: all positive where it is
    /// possible.
    pub eigenvalues: Vec<f64>,
}

impl Conditioning {
    /// Condition numbers of an identification.
    ///
    /// # Errors
    /// A decomposition that fails.
    pub fn of(found: &Identified) -> Result<Self, LeastSquaresError> {
        let (mut inertial, mut gravity, mut friction) = (Vec::new(), Vec::new(), Vec::new());
        for (column, &standard) in found.base.independent().iter().enumerate() {
            if standard % PARAMETERS_PER_LINK < 4 {
                gravity.push(column);
            } else {
                inertial.push(column);
            }
        }
        let terms = found.terms.iter().flatten();
        for (k, term) in terms.enumerate() {
            let column = found.base.len() + k;
            if *term == Term::RotorInertia {
                inertial.push(column);
            } else {
                friction.push(column);
            }
        }
        let triangle = &found.triangle;
        let parts = SubRegressors::of(triangle, &inertial, &gravity, &friction)?;
        let finite = |v: f64| Some(v).filter(|v| v.is_finite());
        Ok(Self {
            whole: finite(parts.whole),
            scaled: finite(SubRegressors::scaled(triangle)?),
            inertial: parts.inertial.and_then(finite),
            gravity: parts.gravity.and_then(finite),
            friction: parts.friction.and_then(finite),
        })
    }
}

/// Names of the base parameters that are poorly determined.
pub fn poorly_determined(found: &Identified) -> Vec<String> {
    let names = found.base.base_names();
    let of = |i: usize| found.estimate.std[i] > POOR * found.estimate.parameters[i].abs();
    let chosen = names.into_iter().enumerate().filter(|(i, _)| of(*i));
    chosen.map(|(_, name)| name).collect()
}

/// Tests of the residual, measured minus predicted, of one joint; none where it cannot be tested.
///
/// `breaks` are the first samples of the trajectories after the first.
pub fn tests(
    measured: &[f64],
    predicted: &[f64],
    velocity: &[f64],
    breaks: &[usize],
) -> Option<ResidualTests> {
    let residual: Vec<f64> = std::iter::zip(measured, predicted)
        .map(|(m, p)| m - p)
        .collect();
    residual_tests(&residual, predicted, velocity, breaks).ok()
}

/// Possible links that explain the training rows best, with friction fitted again. Those of the fit itself,
/// where it required possible links. Directions that the data leave open keep the nominal values.
///
/// # Errors
/// No such links were found.
pub fn possible(robot: &Robot, found: &Identified) -> Result<Feasible, IdentifyError> {
    if let Some(feasible) = &found.feasible {
        return Ok(feasible.clone());
    }
    constrained(
        robot,
        &found.base,
        &found.terms,
        &found.triangle,
        found.estimate.sigma2,
    )
}

/// Training error with possible links, beside that of the free estimate.
///
/// # Errors
/// Parameters that do not belong to the rows.
pub fn cost(found: &Identified, possible: &Feasible) -> Result<PossibleCost, LeastSquaresError> {
    let rows = found.triangle.rows().max(1) as f64;
    let error = |parameters: &[f64]| -> Result<f64, LeastSquaresError> {
        let squares = found.triangle.residual_sum_of_squares(parameters)?;
        Ok((squares / rows).sqrt())
    };
    Ok(PossibleCost {
        free: error(&found.free)?,
        possible: error(&possible.base)?,
    })
}

/// Eigenvalues of the pseudo-inertias of `standard` parameters.
pub fn links(robot: &Robot, standard: &[f64]) -> Vec<PossibleLink> {
    robot
        .joints()
        .iter()
        .zip(standard.chunks_exact(PARAMETERS_PER_LINK))
        .map(|(joint, link)| {
            let mut p = [0.0; PARAMETERS_PER_LINK];
            p.copy_from_slice(link);
            let matrix = Inertia::from_parameters(&p).pseudo_inertia();
            let mut eigenvalues: Vec<f64> =
                matrix.symmetric_eigenvalues().iter().copied().collect();
            eigenvalues.sort_by(f64::total_cmp);
            let largest = eigenvalues[3].abs().max(f64::MIN_POSITIVE);
            PossibleLink {
                link: joint.link.name.clone(),
                eigenvalues: eigenvalues.iter().map(|v| v / largest).collect(),
            }
        })
        .collect()
}

/// Largest distance of a base parameter of the `possible` links from its estimate, in standard deviations.
pub fn moved(found: &Identified, possible: &Feasible) -> Option<f64> {
    let free = &found.free;
    (0..found.base.len())
        .filter(|&i| found.estimate.std[i] > 0.0)
        .map(|i| (possible.base[i] - free[i]).abs() / found.estimate.std[i])
        .max_by(f64::total_cmp)
}
