//! The forward baseline: a linear state space from torque to position in simulation mode (listing 2).
//!
//! The paper calls MATLAB's `n4sid` with focus on simulation, 12 states for six joints, no feedthrough and
//! normalised data, and simulates from an initial state of zero. Here A and C come from a subspace projection
//! (`subspace`), then B (and D) from least squares of the simulated outputs (`input`), as a focus on simulation
//! requires. Nothing reaches over a break between trajectories: each begins again at state zero, that is at the
//! mean position.

mod input;
mod recorded;
mod settings;
mod state_space;
mod subspace;

pub use recorded::{FORWARD, ForwardBaseline, Simulated};
pub use settings::ForwardSettings;
pub use state_space::StateSpace;

use super::{BaselineError, Normalisation, check};
use ndarray::{Array2, ArrayView2};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Linear state space from normalised torque to normalised position.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LinearForward {
    /// Settings with which the state space was fitted.
    pub settings: ForwardSettings,
    /// Normalisation of the torque τ.
    pub input: Normalisation,
    /// Normalisation of the position q.
    pub output: Normalisation,
    /// State space between the normalised channels; all its eigenvalues lie within the unit circle.
    pub system: StateSpace,
}

impl LinearForward {
    /// Identifies the model from torque and position, of shape (samples, joints), taken at one constant
    /// rate within each of `trajectories` (row ranges).
    ///
    /// # Errors
    /// Tables of different shapes, values that are not finite, ranges beyond the tables, no states, a
    /// horizon below 2, too few samples in trajectories of at least two horizons.
    pub fn fit(
        tau: ArrayView2<f64>,
        q: ArrayView2<f64>,
        trajectories: &[Range<usize>],
        settings: &ForwardSettings,
    ) -> Result<Self, BaselineError> {
        check("the torque", tau, q.dim())?;
        check("the position", q, q.dim())?;
        check_trajectories(trajectories, q.nrows())?;
        if settings.order == 0 || settings.horizon < 2 {
            return Err(BaselineError::Settings);
        }
        let (input, output) = (Normalisation::of(tau), Normalisation::of(q));
        let (u, y) = (input.apply(tau), output.apply(q));
        let dynamics = subspace::identify(&u, &y, trajectories, settings)?;
        let system = input::fit(&dynamics, &u, &y, trajectories, settings.feedthrough)?;
        Ok(Self {
            settings: *settings,
            input,
            output,
            system,
        })
    }

    /// Position for a table of torque (samples, joints): simulation mode, no measured position is used.
    ///
    /// # Errors
    /// A table of another number of joints, values that are not finite, ranges beyond the table.
    pub fn simulate(
        &self,
        tau: ArrayView2<f64>,
        trajectories: &[Range<usize>],
    ) -> Result<Array2<f64>, BaselineError> {
        check("the torque", tau, (tau.nrows(), self.input.mean.len()))?;
        check_trajectories(trajectories, tau.nrows())?;
        let y = self
            .system
            .simulate(self.input.apply(tau).view(), trajectories);
        Ok(self.output.undo(y.view()))
    }
}

fn check_trajectories(trajectories: &[Range<usize>], rows: usize) -> Result<(), BaselineError> {
    match trajectories.iter().position(|t| t.end > rows) {
        Some(index) => Err(BaselineError::Trajectory(index)),
        None => Ok(()),
    }
}
