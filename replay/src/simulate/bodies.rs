//! Sensitivities to payload, link factors, tilt and encoder offsets.

use super::State;
use crate::parameter::Kind;
use physics::dynamics::{inverse_dynamics, regressor_with_gravity};
use physics::robot::PARAMETERS_PER_LINK;

impl State<'_> {
    /// Adds the derivatives of the rigid-body torques by encoder offsets, payload, link factors and tilt to the right-
    /// hand side.
    #[inline(always)]
    pub(super) fn bodies_by_parameters(&mut self, h: f64) {
        let (n, p) = (self.arm.dof(), self.parameters.len());
        let width = n * PARAMETERS_PER_LINK;
        if self.bodies {
            regressor_with_gravity(
                &self.arm.robot,
                &mut self.workspace,
                &self.arm.robot.gravity(),
                &self.body,
                &self.v,
                &self.acceleration,
                &mut self.regressor,
            );
        }
        for (k, parameter) in self.parameters.iter().enumerate() {
            match parameter.kind {
                Kind::Zero => {
                    for i in 0..n {
                        let at = i * n + parameter.joint;
                        let mut stiffness = self.derivatives.dq[at];
                        if let Some(gravity) = &self.gravity {
                            let part = self.arm.gravity_compensation
                                * self.drives[i].free()
                                * (1.0 - self.pressed(i));
                            stiffness -= part * gravity.dq[at];
                        }
                        self.rhs[i * p + k] -= h * stiffness;
                    }
                }
                Kind::Payload(part) => {
                    let mut unit = [0.0; 5];
                    unit[part] = 1.0;
                    let change = crate::arm::payload(&unit);
                    let last = width - PARAMETERS_PER_LINK;
                    for i in 0..n {
                        let row = &self.regressor[i * width + last..][..PARAMETERS_PER_LINK];
                        let torque: f64 = row.iter().zip(&change).map(|(y, c)| y * c).sum();
                        self.rhs[i * p + k] -= h * torque;
                    }
                }
                Kind::LinkScale => {
                    let link = parameter.joint;
                    let own = &self.given[link * PARAMETERS_PER_LINK..][..PARAMETERS_PER_LINK];
                    for i in 0..=link {
                        let row = &self.regressor[i * width + link * PARAMETERS_PER_LINK..]
                            [..PARAMETERS_PER_LINK];
                        let torque: f64 = row.iter().zip(own).map(|(y, c)| y * c).sum();
                        self.rhs[i * p + k] -= h * torque;
                    }
                }
                Kind::Tilt(axis) => {
                    inverse_dynamics(
                        &self.tilted[axis],
                        &mut self.workspace,
                        &self.body,
                        &self.still,
                        &self.still,
                        &mut self.zero,
                    );
                    for i in 0..n {
                        self.rhs[i * p + k] -= h * self.zero[i];
                    }
                }
                _ => {}
            }
        }
    }
}
