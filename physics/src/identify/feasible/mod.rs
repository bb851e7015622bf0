//! Estimates that a real robot could have: every link's pseudo-inertia positive definite, rotor inertia and
//! friction not negative.
//!
//! The unknowns are the standard parameters x (10 per link, then extras); the data speak of the base
//! parameters β = G x only, so a nominal model with generous deviations decides the directions
//! that the data leave open. All problems are one: a convex quadratic over a product of 4×4 cones and half-lines
//! (`barrier`), solved to a stated duality gap in milliseconds.
//!
//! Sousa and Cortesão, "Physical feasibility of robot base inertial parameter identification: a linear
//! matrix inequality approach", IJRR 33(6), 2014; Wensing, Kim and Slotine, IEEE RA-L 3(1), 2018 (the 4×4 form,
//! which includes the triangle inequality); Han et al., IEEE T-RO 36(5), 2020, eqs 15 and 23.

mod barrier;
mod cone;
#[cfg(test)]
mod tests;

pub use barrier::{BarrierOptions, Status};

use crate::identify::least_squares::{Gram, LeastSquaresError, Triangle, check_size};
use crate::robot::{Inertia, PARAMETERS_PER_LINK, Robot};
use barrier::{Quadratic, minimise};
use faer::linalg::solvers::Solve;
use faer::{Mat, MatRef, Side};

/// Why a feasibility problem could not be set up or solved.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FeasibilityError {
    /// Sizes that do not agree, or values that are not finite.
    #[error(transparent)]
    LeastSquares(#[from] LeastSquaresError),
    /// A constraint on a parameter that does not exist.
    #[error("a constraint names parameter {index}, but there are {parameters}")]
    NoSuchParameter {
        /// The index.
        index: usize,
        /// Number of parameters.
        parameters: usize,
    },
    /// The nominal deviations must be positive and finite: they bound what the data leave open.
    #[error("the deviation of nominal parameter {index} is not positive and finite")]
    BadDeviation {
        /// The parameter.
        index: usize,
    },
    /// The quadratic is not positive definite to working precision.
    #[error("the system is numerically singular")]
    Singular,
}

/// Which standard parameters must satisfy what.
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

    /// Whether x satisfies them strictly.
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

    fn check(&self, parameters: usize) -> Result<(), FeasibilityError> {
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
    /// Standard parameters and extras.
    pub parameters: Vec<f64>,
    /// How far each may be off, in its unit; positive and finite.
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

    fn check(&self, parameters: usize) -> Result<(), FeasibilityError> {
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

/// Everything about a robot that a feasible fit needs besides the data.
#[derive(Debug, Clone)]
pub struct Feasibility {
    grouping: Mat<f64>,
    constraints: Constraints,
    nominal: Nominal,
    /// Settings of the solver.
    pub options: BarrierOptions,
}

/// A physically possible parameter vector.
#[derive(Debug, Clone, PartialEq)]
pub struct Feasible {
    /// Standard parameters and extras, length s.
    pub standard: Vec<f64>,
    /// The base parameters that they give, G x, length b.
    pub base: Vec<f64>,
    /// Smallest eigenvalue of the links' pseudo-inertias, each relative to the link's largest: positive.
    pub smallest_eigenvalue: f64,
    /// What was minimised, less a constant: data term plus distance from the nominal model.
    pub objective: f64,
    /// Bound on how far `objective` is above the minimum.
    pub gap: f64,
    /// How the iteration ended.
    pub status: Status,
    /// Newton steps taken.
    pub steps: usize,
}

impl Feasibility {
    /// For base parameters β = `grouping` (b × s) · x.
    ///
    /// # Errors
    /// Constraints on parameters that do not exist; a nominal model of another size or without positive
    /// deviations.
    pub fn new(
        grouping: MatRef<'_, f64>,
        constraints: Constraints,
        nominal: Nominal,
    ) -> Result<Self, FeasibilityError> {
        constraints.check(grouping.ncols())?;
        nominal.check(grouping.ncols())?;
        Ok(Self {
            grouping: grouping.to_owned(),
            constraints,
            nominal,
            options: BarrierOptions::default(),
        })
    }

    /// The constraints.
    pub fn constraints(&self) -> &Constraints {
        &self.constraints
    }

    /// The nominal model.
    pub fn nominal(&self) -> &Nominal {
        &self.nominal
    }

    /// Minimises ‖R G x − z‖² + σ² Σ ((x_j − x̄_j)/s_j)² over possible robots (Han et al., eq. 23, with the
    /// nominal model as regulariser); σ² is the variance of the triangle's rows, one where they are whitened.
    ///
    /// # Errors
    /// Sizes that do not agree; a singular system.
    pub fn fit(&self, triangle: &Triangle, sigma2: f64) -> Result<Feasible, FeasibilityError> {
        let r = triangle.r();
        let z = triangle.z();
        let z = Mat::from_fn(z.len(), 1, |i, _| z[i]);
        self.minimise(&(r.transpose() * r), &(r.transpose() * z), sigma2, None)
    }

    /// As [`Feasibility::fit`], from normal equations, starting where an earlier solution (standard
    /// parameters) ended.
    ///
    /// # Errors
    /// As [`Feasibility::fit`].
    pub fn fit_gram(
        &self,
        gram: &Gram,
        sigma2: f64,
        start: Option<&[f64]>,
    ) -> Result<Feasible, FeasibilityError> {
        let p = gram.columns();
        let products = gram.products();
        let normal = products.submatrix(0, 0, p, p).to_owned();
        let right = products.submatrix(0, p, p, 1).to_owned();
        self.minimise(&normal, &right, sigma2, start)
    }

    /// The possible robot nearest to a finished estimate β̂ in the metric of its information matrix (b × b, the
    /// inverse of its covariance).
    ///
    /// # Errors
    /// Sizes that do not agree; a singular system.
    pub fn nearest(
        &self,
        base: &[f64],
        information: MatRef<'_, f64>,
    ) -> Result<Feasible, FeasibilityError> {
        let b = self.grouping.nrows();
        check_size("the estimate", base.len(), b)?;
        check_size("the information matrix", information.nrows(), b)?;
        check_size("the information matrix", information.ncols(), b)?;
        let base = Mat::from_fn(b, 1, |i, _| base[i]);
        self.minimise(&information.to_owned(), &(information * base), 1.0, None)
    }

    /// The standard parameters nearest the nominal ones (in its deviations) that reproduce the base parameters β
    /// and are possible; what an identified URDF is written from.
    ///
    /// Reproduction is exact (to rounding) where β is possible with room to spare. On the border or outside,
    /// `base` of the result differs from β by as little as the cone allows.
    ///
    /// # Errors
    /// Sizes that do not agree; a singular system.
    pub fn standard_from(&self, base: &[f64]) -> Result<Feasible, FeasibilityError> {
        let (b, s) = (self.grouping.nrows(), self.grouping.ncols());
        check_size("the base parameters", base.len(), b)?;
        let scaled = Mat::from_fn(b, s, |i, j| self.grouping[(i, j)] * self.nominal.std[j]);
        // A ten-thousandth of what the nominal deviations let a base parameter vary.
        const TIGHTNESS: f64 = 1e8;
        let weight: Vec<f64> = (0..b)
            .map(|i| {
                let variance = scaled.row(i).squared_norm_l2();
                if variance > 0.0 {
                    TIGHTNESS / variance
                } else {
                    0.0
                }
            })
            .collect();
        let information = Mat::from_fn(b, b, |i, j| if i == j { weight[i] } else { 0.0 });
        let mut found = self.nearest(base, information.as_ref())?;

        // The last digits: the smallest step (in nominal deviations) back onto G x = β, if it stays inside.
        let gram = &scaled * scaled.transpose();
        let missing = Mat::from_fn(b, 1, |i, _| base[i] - found.base[i]);
        if let Ok(factor) = gram.llt(Side::Lower) {
            let step = scaled.transpose() * factor.solve(&missing);
            let moved: Vec<f64> = (0..s)
                .map(|j| found.standard[j] + self.nominal.std[j] * step[(j, 0)])
                .collect();
            if self.constraints.hold(&moved) {
                found.base = self.base_of(&moved);
                found.smallest_eigenvalue = self.constraints.smallest_eigenvalue(&moved);
                found.standard = moved;
            }
        }
        Ok(found)
    }

    fn minimise(
        &self,
        normal: &Mat<f64>,
        right: &Mat<f64>,
        sigma2: f64,
        start: Option<&[f64]>,
    ) -> Result<Feasible, FeasibilityError> {
        let (b, s) = (self.grouping.nrows(), self.grouping.ncols());
        check_size("the data", normal.nrows(), b)?;
        let g = &self.grouping;
        let mut hessian = g.transpose() * (normal * g);
        let mut gradient = g.transpose() * right;
        for j in 0..s {
            let weight = sigma2 / self.nominal.std[j].powi(2);
            hessian[(j, j)] += weight;
            gradient[(j, 0)] += weight * self.nominal.parameters[j];
        }
        let quadratic = Quadratic {
            hessian,
            right: (0..s).map(|j| gradient[(j, 0)]).collect(),
        };
        let start = match start {
            Some(x) if x.len() == s && self.constraints.hold(x) => x.to_vec(),
            _ => self.inside(),
        };
        let minimum = minimise(
            &quadratic,
            &self.constraints,
            &self.nominal.std,
            sigma2,
            start,
            &self.options,
        )?;
        Ok(Feasible {
            base: self.base_of(&minimum.x),
            smallest_eigenvalue: self.constraints.smallest_eigenvalue(&minimum.x),
            standard: minimum.x,
            objective: minimum.objective,
            gap: minimum.gap,
            status: minimum.status,
            steps: minimum.steps,
        })
    }

    fn base_of(&self, x: &[f64]) -> Vec<f64> {
        let x = Mat::from_fn(x.len(), 1, |i, _| x[i]);
        let base = &self.grouping * x;
        (0..base.nrows()).map(|i| base[(i, 0)]).collect()
    }

    /// The nominal model moved well inside the constraints.
    fn inside(&self) -> Vec<f64> {
        let mut x = self.nominal.parameters.clone();
        for &at in &self.constraints.links {
            let link = &mut x[at..at + PARAMETERS_PER_LINK];
            let std = &self.nominal.std[at..];
            link.copy_from_slice(&cone::pushed_inside(link, std[0], std[4]));
        }
        for &i in &self.constraints.nonnegative {
            x[i] = x[i].max(0.1 * self.nominal.std[i]);
        }
        x
    }
}

/// Pseudo-inertia of ten standard parameters.
fn pseudo_inertia(x: &[f64]) -> nalgebra::Matrix4<f64> {
    let mut p = [0.0; PARAMETERS_PER_LINK];
    p.copy_from_slice(&x[..PARAMETERS_PER_LINK]);
    Inertia::from_parameters(&p).pseudo_inertia()
}
