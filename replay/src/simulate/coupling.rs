//! Links that turn with other joints' motors, too. Positions q of the links follow from those of the motors, θ, by a matrix T
//! that differs from one by the couplings: q = T θ. Torques on the motors are then Tᵀ times those on the links.

use super::State;
use crate::arm::Arm;
use crate::parameter::Kind;
use physics::dynamics::inverse_dynamics;

impl Arm {
    /// Whether any link turns with another joint's motor.
    pub(super) fn is_coupled(&self) -> bool {
        self.coupling.iter().any(|c| *c != 0.0)
    }

    /// Motion of the links (positions, velocities or accelerations), N values, from that of the motors.
    pub(super) fn links(&self, motors: &[f64], links: &mut [f64]) {
        let rows = self.coupling.chunks_exact(motors.len());
        for ((link, own), row) in links.iter_mut().zip(motors).zip(rows) {
            let turned: f64 = row.iter().zip(motors).map(|(c, m)| c * m).sum();
            *link = own - turned;
        }
    }

    /// Derivatives of torques by motion, N × N, of the motors from those of the links: Tᵀ A T, in place.
    pub(super) fn of_motors(&self, a: &mut [f64]) {
        let n = self.dof();
        for row in a.chunks_exact_mut(n) {
            self.on_motors(row);
        }
        for j in 0..n {
            let mut column: Vec<f64> = (0..n).map(|i| a[i * n + j]).collect();
            self.on_motors(&mut column);
            column
                .iter()
                .enumerate()
                .for_each(|(i, v)| a[i * n + j] = *v);
        }
    }

    /// Torques on the motors from those on the links, N values: Tᵀ τ, in place.
    pub(super) fn on_motors(&self, torques: &mut [f64]) {
        let n = torques.len();
        let links = torques.to_vec();
        for (link, row) in links.iter().zip(self.coupling.chunks_exact(n)) {
            let driven = torques.iter_mut().zip(row);
            driven.for_each(|(torque, c)| *torque -= c * link);
        }
    }
}

impl State<'_> {
    /// Adds `torque` on link `i` to the right-hand side of parameter `k`, as an impulse over `h` against the motion of the
    /// motors that turn the link.
    pub(super) fn resist(&mut self, i: usize, k: usize, torque: f64, h: f64) {
        let (n, p) = (self.arm.dof(), self.parameters.len());
        self.rhs[i * p + k] -= h * torque;
        if self.coupled {
            for j in 0..n {
                self.rhs[j * p + k] += h * self.arm.coupling[i * n + j] * torque;
            }
        }
    }

    /// Adds the derivatives of the rigid-body torques by couplings to the right-hand side. A coupling moves its link, and
    /// carries the link's torque to the driving motor.
    pub(super) fn couplings_by_parameters(&mut self, h: f64) {
        let n = self.arm.dof();
        let is_coupling = |kind: Kind| matches!(kind, Kind::Coupling(_));
        if !self.parameters.iter().any(|p| is_coupling(p.kind)) {
            return;
        }
        inverse_dynamics(
            &self.arm.robot,
            &mut self.workspace,
            &self.link[0],
            &self.link[1],
            &self.link[2],
            &mut self.zero,
        );
        for passive in self.arm.robot.passive() {
            let joint = passive.joint();
            self.zero[joint] += passive.torque(self.link[0][joint]);
        }
        let p = self.parameters.len();
        for k in 0..p {
            let Kind::Coupling(motor) = self.parameters[k].kind else {
                continue;
            };
            let link = self.parameters[k].joint;
            let turned = [self.body[motor], self.v[motor], self.acceleration[motor]];
            for i in 0..n {
                let at = i * n + link;
                let by = [
                    self.derivatives.dq[at],
                    self.derivatives.dqd[at],
                    self.derivatives.mass[at],
                ];
                let torque: f64 = by.iter().zip(turned).map(|(b, t)| b * t).sum();
                self.resist(i, k, -torque, h);
            }
            self.rhs[motor * p + k] += h * self.zero[link];
        }
    }
}
