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
                &self.link[0],
                &self.link[1],
                &self.link[2],
                &mut self.regressor,
            );
        }
        for k in 0..p {
            let parameter = self.parameters[k];
            match parameter.kind {
                Kind::Zero => {
                    for i in 0..n {
                        let at = i * n + parameter.joint;
                        let mut stiffness = self.by_motion[0][at];
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
                        self.resist(i, k, torque, h);
                    }
                }
                Kind::LinkScale => {
                    let link = parameter.joint;
                    for i in 0..=link {
                        let row = &self.regressor[i * width + link * PARAMETERS_PER_LINK..]
                            [..PARAMETERS_PER_LINK];
                        let own = &self.given[link * PARAMETERS_PER_LINK..];
                        let torque: f64 = row.iter().zip(own).map(|(y, c)| y * c).sum();
                        self.resist(i, k, torque, h);
                    }
                }
                Kind::Tilt(axis) => {
                    inverse_dynamics(
                        &self.tilted[axis],
                        &mut self.workspace,
                        &self.link[0],
                        &self.still,
                        &self.still,
                        &mut self.zero,
                    );
                    for i in 0..n {
                        self.resist(i, k, self.zero[i], h);
                    }
                }
                _ => {}
            }
        }
    }
}
