//! Criteria of exciting trajectories.

use super::error::ExcitationError;
use super::rows::BaseRows;
use super::series::{Series, State};
use crate::least_squares::{Accumulator, SubRegressors, Triangle, condition_number};
use physics::dynamics::{Workspace, inverse_dynamics};
use physics::robot::Robot;

/// Optimality criterion of a trajectory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Criterion {
    /// Smallest cond(Y) (Han et al., Table II, criterion 1; COMAU paper, eq. 20; UR5 paper, section II-C).
    Condition,
    /// Smallest cond(Y*), with Y* the regressor Y whose rows are divided by the noise of their joint.
    ConditionNoise,
    /// Smallest 10 cond(Y) + 5 cond(Y_i) + cond(Y_g) + cond(Y_f) (Han et al., Table II, criterion 2).
    SubRegressors,
    /// Smallest 10 cond(Y*) + 5 cond(Y*_i) + cond(Y*_g) + cond(Y*_f) (criterion 3).
    SubRegressorsNoise,
    /// Largest determinant of the information matrix Y*ᵀY*.
    DOptimal,
}

impl Criterion {
    /// All criteria, in the order of the enum.
    pub const ALL: [Self; 5] = [
        Self::Condition,
        Self::ConditionNoise,
        Self::SubRegressors,
        Self::SubRegressorsNoise,
        Self::DOptimal,
    ];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Condition => "cond",
            Self::ConditionNoise => "cond-noise",
            Self::SubRegressors => "cond-sub",
            Self::SubRegressorsNoise => "cond-sub-noise",
            Self::DOptimal => "d-optimal",
        }
    }

    /// Whether rows are divided by the noise of their joint.
    fn weighted(self) -> bool {
        !matches!(self, Self::Condition | Self::SubRegressors)
    }
}

/// Cost function of trajectories, which takes the trajectories chosen before into account.
pub trait Goal: Sync {
    /// Cost of the trajectories taken and one more: smaller is better.
    ///
    /// # Errors
    /// Numbers that cannot be judged.
    fn cost(&self, trajectory: &Series) -> Result<f64, ExcitationError>;

    /// Takes a trajectory: the next one is to complement it.
    ///
    /// # Errors
    /// As [`Goal::cost`].
    fn take(&mut self, trajectory: &Series) -> Result<(), ExcitationError>;
}

/// Task of finding trajectories with which a robot's base parameters are identified well.
#[derive(Debug, Clone)]
pub struct Excitation<'a> {
    rows: BaseRows<'a>,
    criterion: Criterion,
    noise: Vec<f64>,
    samples: usize,
    before: Option<Triangle>,
}

impl<'a> Excitation<'a> {
    /// `noise`: standard deviation of each joint's torque noise, N·m; `samples`: rows per joint of one trajectory, evenly over it.
    ///
    /// # Errors
    /// A noise deviation that is missing or not positive; no samples.
    pub fn new(
        rows: BaseRows<'a>,
        criterion: Criterion,
        noise: Vec<f64>,
        samples: usize,
    ) -> Result<Self, ExcitationError> {
        check_noise(&noise, rows.dof())?;
        if samples == 0 {
            return Err(ExcitationError::Empty("the number of samples"));
        }
        Ok(Self {
            rows,
            criterion,
            noise,
            samples,
            before: None,
        })
    }

    /// Triangle of the rows of a trajectory and of those taken, divided by the noise where the criterion asks for it.
    ///
    /// # Errors
    /// Numbers that are not finite.
    pub fn triangle(&self, trajectory: &Series) -> Result<Triangle, ExcitationError> {
        let (n, p) = (trajectory.dof(), self.rows.columns());
        let mut base = self.rows.clone();
        let mut rows = Accumulator::new(p);
        let mut block = vec![0.0; n * p];
        let weighted = self.criterion.weighted();
        for_each_sample(trajectory, self.samples, |state| {
            base.fill(&state.q, &state.qd, &state.qdd, &mut block);
            for (row, noise) in std::iter::zip(block.chunks_exact(p), &self.noise) {
                rows.push(row, 0.0, if weighted { 1.0 / noise } else { 1.0 })?;
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

impl Goal for Excitation<'_> {
    fn cost(&self, trajectory: &Series) -> Result<f64, ExcitationError> {
        let triangle = self.triangle(trajectory)?;
        Ok(match self.criterion {
            Criterion::Condition | Criterion::ConditionNoise => condition_number(triangle.r())?,
            Criterion::SubRegressors | Criterion::SubRegressorsNoise => {
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

    fn take(&mut self, trajectory: &Series) -> Result<(), ExcitationError> {
        self.before = Some(self.triangle(trajectory)?);
        Ok(())
    }
}

/// The task of telling two models of a robot apart by the torque that they ask for: the largest
/// ½ Σ_j Σ_t ((τ_A − τ_B)/σ_j)², which is the T-criterion of Atkinson and Fedorov (Biometrika 62(1), 1975) for two models
/// with nothing free.
#[derive(Debug, Clone)]
pub struct Separation<'a> {
    models: [&'a Robot; 2],
    noise: Vec<f64>,
    samples: usize,
    before: f64,
}

impl<'a> Separation<'a> {
    /// Task for two models; `noise` and `samples` as in [`Excitation::new`].
    ///
    /// # Errors
    /// A noise deviation that is missing or not positive, robots of different numbers of joints among them.
    pub fn new(
        models: [&'a Robot; 2],
        noise: Vec<f64>,
        samples: usize,
    ) -> Result<Self, ExcitationError> {
        for model in models {
            check_noise(&noise, model.dof())?;
        }
        if samples == 0 {
            return Err(ExcitationError::Empty("the number of samples"));
        }
        Ok(Self {
            models,
            noise,
            samples,
            before: 0.0,
        })
    }

    /// Evidence of a trajectory between the two models, nats.
    ///
    /// # Errors
    /// None beyond those of the samples.
    fn evidence(&self, trajectory: &Series) -> Result<f64, ExcitationError> {
        let [a, b] = self.models;
        let mut spaces = [Workspace::new(a), Workspace::new(b)];
        let n = a.dof();
        let mut tau = [vec![0.0; n], vec![0.0; n]];
        let mut sum = 0.0;
        for_each_sample(trajectory, self.samples, |state| {
            for ((robot, space), tau) in self.models.iter().zip(&mut spaces).zip(&mut tau) {
                torque(robot, space, state, tau);
            }
            let each = tau[0].iter().zip(&tau[1]).zip(&self.noise);
            sum += each.map(|((x, y), s)| ((x - y) / s).powi(2)).sum::<f64>();
            Ok(())
        })?;
        Ok(0.5 * sum)
    }
}

impl Goal for Separation<'_> {
    fn cost(&self, trajectory: &Series) -> Result<f64, ExcitationError> {
        Ok(-self.before - self.evidence(trajectory)?)
    }

    fn take(&mut self, trajectory: &Series) -> Result<(), ExcitationError> {
        self.before += self.evidence(trajectory)?;
        Ok(())
    }
}

/// Torque of a described robot: rigid body, viscous and Coulomb friction, rotor inertia, springs and counterbalance; N·m or N.
pub fn torque(robot: &Robot, workspace: &mut Workspace, state: &State, tau: &mut [f64]) {
    inverse_dynamics(robot, workspace, &state.q, &state.qd, &state.qdd, tau);
    for (j, joint) in robot.joints().iter().enumerate() {
        let qd = state.qd[j];
        let sign = if qd == 0.0 { 0.0 } else { qd.signum() };
        tau[j] += joint.damping * qd + joint.friction * sign + joint.rotor_inertia * state.qdd[j];
    }
    for passive in robot.passive() {
        let j = passive.joint();
        tau[j] += passive.torque(state.q[j]);
    }
}

fn check_noise(noise: &[f64], n: usize) -> Result<(), ExcitationError> {
    if noise.len() == n && noise.iter().all(|s| s.is_finite() && *s > 0.0) {
        Ok(())
    } else {
        Err(ExcitationError::Empty("the noise deviation of every joint"))
    }
}

/// Visits `samples` states, evenly over one run, at the middles of its parts: none is at rest.
fn for_each_sample(
    trajectory: &Series,
    samples: usize,
    mut visit: impl FnMut(&State) -> Result<(), ExcitationError>,
) -> Result<(), ExcitationError> {
    let mut state = State::new(trajectory.dof());
    for k in 0..samples {
        let t = trajectory.duration * (k as f64 + 0.5) / samples as f64;
        trajectory.at(t, &mut state);
        visit(&state)?;
    }
    Ok(())
}
