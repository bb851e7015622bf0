//! Constraints and nominal model of a feasible fit.

use super::cone;
use crate::least_squares::{LeastSquaresError, check_size};
use physics::robot::{PARAMETERS_PER_LINK, Robot};

/// Reason why a feasibility problem could not be set up or solved.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FeasibilityError {
    /// Sizes that do not agree, or values that are not finite.
    #[error(transparent)]
    LeastSquares(#[from] LeastSquaresError),
    /// A constraint on a parameter that does not exist.
    #[error("a constraint names parameter {index}, but there are {parameters}")]
    NoSuchParameter {
        /// Index of the missing parameter.
        index: usize,
        /// Number of parameters of the problem.
        parameters: usize,
    },
    /// A nominal deviation that is not positive and finite: the deviations bound the directions that the data leave open.
    #[error("the deviation of nominal parameter {index} is not positive and finite")]
    BadDeviation {
        /// Index of the parameter with that deviation.
        index: usize,
    },
    /// The quadratic is not positive definite to working precision.
    #[error("the system is numerically singular")]
    Singular,
}

/// Constraints on standard parameters.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Constraints {
    /// First index of the ten parameters of each link that must be a possible body, J ≻ 0 (eq. 15).
    pub links: Vec<usize>,
    /// Indices of parameters that must not be negative: rotor inertia, viscous and Coulomb friction.
    pub nonnegative: Vec<usize>,
}

impl Constraints {
    /// Every one of `links` links at the start of the vector, and the parameters `nonnegative`.
    pub fn new(links: usize, nonnegative: impl IntoIterator<Item = usize>) -> Self {
        Self {
            links: (0..links).map(|i| i * PARAMETERS_PER_LINK).collect(),
            nonnegative: nonnegative.into_iter().collect(),
        }
    }

    /// Whether x satisfies all constraints strictly.
    pub fn hold(&self, x: &[f64]) -> bool {
        self.links.iter().all(|&at| cone::margin(&x[at..]) > 0.0)
            && self.nonnegative.iter().all(|&i| x[i] > 0.0)
    }

    /// The smallest eigenvalue of the links' pseudo-inertias, each relative to its link's largest; infinite
    /// without links.
    pub fn smallest_eigenvalue(&self, x: &[f64]) -> f64 {
        let margins = self.links.iter().map(|&at| cone::margin(&x[at..]));
        margins.fold(f64::INFINITY, f64::min)
    }

    pub(super) fn check(&self, parameters: usize) -> Result<(), FeasibilityError> {
        let last_of_links = self.links.iter().map(|at| at + PARAMETERS_PER_LINK - 1);
        match last_of_links
            .chain(self.nonnegative.iter().copied())
            .find(|&i| i >= parameters)
        {
            Some(index) => Err(FeasibilityError::NoSuchParameter { index, parameters }),
            None => Ok(()),
        }
    }
}

/// The model believed before the data: it decides the directions that the data leave open.
#[derive(Debug, Clone, PartialEq)]
pub struct Nominal {
    /// Standard parameters and extras of the nominal model.
    pub parameters: Vec<f64>,
    /// Standard deviation of each parameter, in its unit; positive and finite.
    pub std: Vec<f64>,
}

impl Nominal {
    /// A robot's own parameters, each free by the size of its link: for a link of mass m and length ℓ
    /// (gyration radius about its joint), m, m·ℓ and m·ℓ². `extras` follow with value and deviation.
    pub fn of_robot(robot: &Robot, extras: &[(f64, f64)]) -> Self {
        let mut parameters = robot.parameters();
        let mut std = Vec::with_capacity(parameters.len() + extras.len());
        for link in parameters.chunks_exact(PARAMETERS_PER_LINK) {
            // Floors for the massless links of sparse descriptions: 0.1 kg, 5 cm.
            let mass = link[0].max(0.1);
            let gyration = (link[4] + link[6] + link[9]).max(0.0) / (2.0 * mass);
            let length = gyration.sqrt().max(0.05);
            std.push(mass);
            std.extend([mass * length; 3]);
            std.extend([mass * length * length; 6]);
        }
        for &(value, deviation) in extras {
            parameters.push(value);
            std.push(deviation);
        }
        Self { parameters, std }
    }

    pub(super) fn check(&self, parameters: usize) -> Result<(), FeasibilityError> {
        check_size("the nominal model", self.parameters.len(), parameters)?;
        check_size("the nominal deviation", self.std.len(), parameters)?;
        if self.parameters.iter().any(|x| !x.is_finite()) {
            return Err(LeastSquaresError::NotFinite.into());
        }
        match self.std.iter().position(|s| !(s.is_finite() && *s > 0.0)) {
            Some(index) => Err(FeasibilityError::BadDeviation { index }),
            None => Ok(()),
        }
    }
}
