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
mod problem;
#[cfg(test)]
mod tests;

pub use barrier::{BarrierOptions, Status};
pub use problem::{Constraints, FeasibilityError, Nominal};

use crate::least_squares::{Gram, Triangle, check_size};
use barrier::{Quadratic, minimise};
use faer::linalg::solvers::Solve;
use faer::{Mat, MatRef, Side};
use physics::robot::PARAMETERS_PER_LINK;

/// Data of a robot that a feasible fit needs besides the recorded rows.
#[derive(Debug, Clone)]
pub struct Feasibility {
    grouping: Mat<f64>,
    constraints: Constraints,
    nominal: Nominal,
    /// Settings of the barrier solver.
    pub options: BarrierOptions,
}

/// A physically possible parameter vector.
#[derive(Debug, Clone, PartialEq)]
pub struct Feasible {
    /// Standard parameters and extras, length s.
    pub standard: Vec<f64>,
    /// Base parameters G x of the standard parameters, length b.
    pub base: Vec<f64>,
    /// Smallest eigenvalue of the links' pseudo-inertias, each relative to the link's largest: positive.
    pub smallest_eigenvalue: f64,
    /// Minimum of the objective, less a constant: data term plus distance from the nominal model. Of
    /// [`Feasibility::standard_from`] before its last step.
    pub objective: f64,
    /// Bound on the excess of `objective` over its minimum.
    pub gap: f64,
    /// Reason why the iteration ended.
    pub status: Status,
    /// Number of Newton steps taken.
    pub steps: usize,
}

impl Feasible {
    /// Whether the iteration went as far as it could: to the gap asked for, or to where rounding stopped it.
    pub fn converged(&self) -> bool {
        self.status != Status::StepLimit
    }
}

impl Feasibility {
    /// Problem for base parameters β = `grouping` (b × s) · x.
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

    /// Constraints on the standard parameters.
    pub fn constraints(&self) -> &Constraints {
        &self.constraints
    }

    /// Nominal model towards which the fit is drawn.
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

    /// Fit as by [`Feasibility::fit`], from normal equations, starting from an earlier solution (standard parameters).
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

    /// Standard parameters nearest the nominal ones (in its deviations) that reproduce the base parameters β
    /// and are possible; an identified URDF is written from them.
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
