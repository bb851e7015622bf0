//! How good a trajectory is.

use super::{BaseRows, ExcitationError, Fourier};
use crate::least_squares::{Accumulator, SubRegressors, Triangle};

/// What makes a trajectory good.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Criterion {
    /// Smallest condition number of the weighted regressor.
    Condition,
    /// Smallest 10 cond(Y) + 5 cond(Y_i) + cond(Y_g) + cond(Y_f) (Han et al., Table II, criterion 3).
    SubRegressors,
    /// Largest determinant of the information matrix.
    DOptimal,
}

/// The task of finding a trajectory that tells a robot's base parameters well.
#[derive(Debug, Clone)]
pub struct Excitation<'a> {
    /// Rows of the base regressor.
    pub rows: BaseRows<'a>,
    /// What to look for.
    pub criterion: Criterion,
    /// Standard deviation of each joint's torque noise; rows are divided by it (Han's Y*).
    pub noise: Vec<f64>,
    /// Samples over one period.
    pub samples: usize,
    /// Rows of trajectories chosen before, which this one is to complement.
    pub before: Option<Triangle>,
}

impl Excitation<'_> {
    /// Cost of a trajectory: smaller is better.
    ///
    /// # Errors
    /// A noise deviation that is missing or zero; no samples.
    pub fn cost(&mut self, trajectory: &Fourier) -> Result<f64, ExcitationError> {
        let triangle = self.triangle(trajectory)?;
        Ok(match self.criterion {
            Criterion::Condition => crate::least_squares::condition_number(triangle.r())?,
            Criterion::SubRegressors => {
                let [inertial, gravity, friction] = self.rows.parts();
                SubRegressors::of(&triangle, &inertial, &gravity, &friction)?.criterion()
            }
            Criterion::DOptimal => {
                let r = triangle.r();
                // −log det per parameter; a parameter without any information costs the most.
                let logs = (0..r.ncols()).map(|j| r[(j, j)].abs().max(1e-300).ln());
                -2.0 * logs.sum::<f64>() / r.ncols().max(1) as f64
            }
        })
    }

    /// Triangle of the weighted rows of a trajectory and of those before it.
    ///
    /// # Errors
    /// As [`Excitation::cost`].
    pub fn triangle(&mut self, trajectory: &Fourier) -> Result<Triangle, ExcitationError> {
        let (n, p) = (trajectory.dof(), self.rows.columns());
        check_noise(&self.noise, n)?;
        let mut rows = Accumulator::new(p);
        let mut block = vec![0.0; n * p];
        for_each_sample(trajectory, self.samples, |q, qd, qdd| {
            self.rows.fill(q, qd, qdd, &mut block);
            for (row, noise) in std::iter::zip(block.chunks_exact(p), &self.noise) {
                rows.push(row, 0.0, 1.0 / noise)?;
            }
            Ok(())
        })?;
        let mut triangle = rows.finish()?;
        if let Some(before) = &self.before {
            triangle.merge(before)?;
        }
        Ok(triangle)
    }
}

fn check_noise(noise: &[f64], n: usize) -> Result<(), ExcitationError> {
    if noise.len() == n && noise.iter().all(|s| s.is_finite() && *s > 0.0) {
        Ok(())
    } else {
        Err(ExcitationError::Empty("the noise deviation of every joint"))
    }
}

/// Visits `samples` states, evenly over one period.
fn for_each_sample(
    trajectory: &Fourier,
    samples: usize,
    mut visit: impl FnMut(&[f64], &[f64], &[f64]) -> Result<(), ExcitationError>,
) -> Result<(), ExcitationError> {
    if samples == 0 {
        return Err(ExcitationError::Empty("the number of samples"));
    }
    let n = trajectory.dof();
    let (mut q, mut qd, mut qdd) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    for k in 0..samples {
        let t = trajectory.period * k as f64 / samples as f64;
        trajectory.at(t, &mut q, &mut qd, &mut qdd);
        visit(&q, &qd, &qdd)?;
    }
    Ok(())
}
