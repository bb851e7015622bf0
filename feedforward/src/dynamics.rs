//! Rigid-body dynamics of a model for control loops, beside its torque.

use physics::dynamics::{Workspace, forward_dynamics, inverse_dynamics, mass_matrix};
use physics::effects::Term;
use physics::robot::Robot;
use physics::torque_model::TorqueModel;

/// Identified rigid body with the rotors of its drives; no friction, springs or compensator. It allocates when it is made and never
/// again.
///
/// Vectors have one value per joint, base first: rad or m, per s, per s², N·m or N.
#[derive(Debug, Clone)]
pub struct Dynamics {
    robot: Robot,
    workspace: Workspace,
    /// Inertia of each rotor seen from its joint, kg·m² or kg.
    rotors: Vec<f64>,
    zero: Vec<f64>,
}

impl Dynamics {
    pub(crate) fn new(model: &TorqueModel) -> Self {
        let rotor = |terms: &Vec<physics::torque_model::WeightedTerm>| {
            let own = terms.iter().filter(|t| t.term == Term::RotorInertia);
            own.map(|t| t.value).sum()
        };
        Self {
            robot: model.robot().clone(),
            workspace: Workspace::new(model.robot()),
            rotors: model.terms().iter().map(rotor).collect(),
            zero: vec![0.0; model.dof()],
        }
    }

    /// The robot with its identified inertial parameters.
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    /// τ = (M(q) + rotors) q̈ + C(q, q̇) q̇ + g(q).
    ///
    /// # Panics
    /// When a slice has another length than the robot has joints.
    pub fn inverse(&mut self, q: &[f64], qd: &[f64], qdd: &[f64], tau: &mut [f64]) {
        inverse_dynamics(&self.robot, &mut self.workspace, q, qd, qdd, tau);
        for ((tau, rotor), qdd) in tau.iter_mut().zip(&self.rotors).zip(qdd) {
            *tau += rotor * qdd;
        }
    }

    /// Torque that holds the robot at `q` against gravity: g(q).
    ///
    /// # Panics
    /// As [`Self::inverse`].
    pub fn gravity(&mut self, q: &[f64], tau: &mut [f64]) {
        let Self {
            robot,
            workspace,
            zero,
            ..
        } = self;
        inverse_dynamics(robot, workspace, q, zero, zero, tau);
    }

    /// M(q) + rotors, N × N, row by row (symmetric).
    ///
    /// # Panics
    /// When `q` has another length than N, or `m` than N².
    pub fn mass_matrix(&mut self, q: &[f64], m: &mut [f64]) {
        mass_matrix(&self.robot, &mut self.workspace, q, m);
        for (joint, rotor) in self.rotors.iter().enumerate() {
            m[joint * (self.rotors.len() + 1)] += rotor;
        }
    }

    /// Acceleration under the torque `tau`, from which friction and all other terms were subtracted: q̈ = (M(q)
    /// + rotors)⁻¹ (τ − C(q, q̇) q̇ − g(q)).
    ///
    /// # Panics
    /// As [`Self::inverse`].
    pub fn forward(&mut self, q: &[f64], qd: &[f64], tau: &[f64], qdd: &mut [f64]) {
        let Self {
            robot,
            workspace,
            rotors,
            ..
        } = self;
        forward_dynamics(robot, workspace, q, qd, tau, rotors, qdd);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use physics::torque_model::WeightedTerm;

    fn ur5() -> (Dynamics, usize) {
        let robot = Robot::builtin("ur5").unwrap();
        let rotor = |value: f64| WeightedTerm {
            term: Term::RotorInertia,
            value,
            std: 0.0,
        };
        let n = robot.dof();
        let terms = (0..n).map(|j| vec![rotor(0.1 * (j + 1) as f64)]).collect();
        let p = robot.parameters();
        (
            Dynamics::new(&TorqueModel::new(&robot, &p, &p, terms).unwrap()),
            n,
        )
    }

    #[test]
    fn mass_matrix_inverse_and_forward_dynamics_are_one_equation() {
        let (mut body, n) = ur5();
        let q: Vec<f64> = (0..n).map(|j| 0.3 * j as f64 - 0.7).collect();
        let qd: Vec<f64> = (0..n).map(|j| 0.5 - 0.2 * j as f64).collect();
        let qdd: Vec<f64> = (0..n).map(|j| (j as f64).sin()).collect();
        let [mut tau, mut bias, mut held, mut found] = [(); 4].map(|()| vec![0.0; n]);
        let mut m = vec![0.0; n * n];
        body.inverse(&q, &qd, &qdd, &mut tau);
        body.inverse(&q, &qd, &vec![0.0; n], &mut bias);
        body.mass_matrix(&q, &mut m);
        for i in 0..n {
            let inertial: f64 = (0..n).map(|j| m[i * n + j] * qdd[j]).sum();
            assert!((inertial + bias[i] - tau[i]).abs() < 1e-9, "joint {i}");
        }
        body.forward(&q, &qd, &tau, &mut found);
        for (a, b) in found.iter().zip(&qdd) {
            assert!((a - b).abs() < 1e-9, "{found:?} {qdd:?}");
        }
        body.inverse(&q, &vec![0.0; n], &vec![0.0; n], &mut bias);
        body.gravity(&q, &mut held);
        assert_eq!(held, bias);
    }
}
