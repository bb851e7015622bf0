//! The drive's controller: feed-forward of the nominal model, position and velocity feedback.

use crate::arm::Arm;
use crate::mechanism::soft_sign;
use crate::reference::Command;
use physics::dynamics::{Workspace, inverse_dynamics, mass_matrix};
use physics::robot::{Robot, RobotError};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::TAU;

/// Errors of the controller's motion sensors.
#[derive(Debug, Clone)]
pub struct Sensing {
    /// Encoder count, rad or m per count.
    pub count: Vec<f64>,
    /// Deviation of the velocity signal, rad/s.
    pub velocity_noise: Vec<f64>,
    /// Corner of the velocity signal's low-pass, Hz.
    pub corner: f64,
}

/// τ = τ̂(q_r, q̇_r, q̈_r) + K_p (q_r − q) + K_d (q̇_r − q̇), with q counted and q̇ filtered and noisy.
pub struct Controller {
    model: Robot,
    workspace: Workspace,
    damping: Vec<f64>,
    friction: Vec<f64>,
    proportional: Vec<f64>,
    derivative: Vec<f64>,
    sensing: Sensing,
    filtered: Vec<f64>,
    period: f64,
    rng: ChaCha8Rng,
}

/// Speed below which the feed-forward of friction is softened, rad/s: commanded speed is smooth, so that a narrow
/// step would only make noise.
const FEEDFORWARD_EPS: f64 = 0.003;

impl Controller {
    /// A controller for the nominal robot `nominal`, with the given position bandwidth (Hz) and control period (s).
    ///
    /// # Errors
    /// The nominal arm is not a robot.
    pub fn new(
        nominal: &Arm,
        bandwidth: f64,
        period: f64,
        sensing: Sensing,
        rng: ChaCha8Rng,
    ) -> Result<Self, RobotError> {
        let model = nominal.robot()?;
        let n = model.dof();
        let mut workspace = Workspace::new(&model);
        let mut mass = vec![0.0; n * n];
        mass_matrix(&model, &mut workspace, &nominal.centre, &mut mass);
        let w = TAU * bandwidth;
        let inertia: Vec<f64> = (0..n)
            .map(|j| mass[j * n + j] + model.joints()[j].rotor_inertia)
            .collect();
        Ok(Self {
            proportional: inertia.iter().map(|m| m * w * w).collect(),
            derivative: inertia.iter().map(|m| 1.6 * m * w).collect(),
            damping: nominal.damping(),
            friction: nominal.friction(),
            filtered: vec![0.0; n],
            model,
            workspace,
            sensing,
            period,
            rng,
        })
    }

    /// Torque command for the measured state, N·m.
    pub fn torque(&mut self, command: &Command, q: &[f64], v: &[f64], u: &mut [f64]) {
        inverse_dynamics(
            &self.model,
            &mut self.workspace,
            &command.q,
            &command.qd,
            &command.qdd,
            u,
        );
        let w = TAU * self.sensing.corner * self.period;
        let pass = w / (1.0 + w);
        for (j, u) in u.iter_mut().enumerate() {
            let noise: f64 = StandardNormal.sample(&mut self.rng);
            let measured = v[j] + self.sensing.velocity_noise[j] * noise;
            self.filtered[j] += pass * (measured - self.filtered[j]);
            let count = self.sensing.count[j];
            let counted = count * (q[j] / count).round();
            let qd = command.qd[j];
            *u += self.model.joints()[j].rotor_inertia * command.qdd[j]
                + self.damping[j] * qd
                + self.friction[j] * soft_sign(qd, FEEDFORWARD_EPS)
                + self.proportional[j] * (command.q[j] - counted)
                + self.derivative[j] * (qd - self.filtered[j]);
        }
    }
}
