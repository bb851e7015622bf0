//! Sensitivities to payload, link factors, tilt and encoder offsets.

use super::State;
use crate::parameter::Kind;
use crate::payload::carrying_by;
use physics::dynamics::{inverse_dynamics, regressor_with_gravity};
use physics::robot::PARAMETERS_PER_LINK;

impl State<'_> {
    /// Adds the derivatives of the rigid-body torques by encoder offsets, payload, link factors and tilt to the right-
    /// hand side.
    #[inline(always)]
    pub(super) fn bodies_by_parameters(&mut self, h: f64) {
        let (n, p) = (self.arm.dof(), self.parameters.len());
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
                    let change = self.last_by(&[0.0; PARAMETERS_PER_LINK], &unit);
                    self.body_by_parameter(n - 1, &change, k, h);
                }
                Kind::LinkScale => {
                    let link = parameter.joint;
                    let own = self.given_link(link);
                    let change = if link + 1 < n {
                        own
                    } else {
                        self.last_by(&own, &[0.0; 5])
                    };
                    self.body_by_parameter(link, &change, k, h);
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

    /// Inertial parameters of a link as described.
    fn given_link(&self, link: usize) -> [f64; PARAMETERS_PER_LINK] {
        std::array::from_fn(|k| self.given[link * PARAMETERS_PER_LINK + k])
    }

    /// Derivative of the inertial parameters of the last link with its payload along a change of the link and of the payload's values.
    fn last_by(
        &self,
        change: &[f64; PARAMETERS_PER_LINK],
        payload: &[f64; 5],
    ) -> [f64; PARAMETERS_PER_LINK] {
        let last = self.arm.dof() - 1;
        let link = self.given_link(last).map(|v| v * self.arm.link_scale[last]);
        carrying_by([&link, change], [&self.arm.payload, payload])
    }

    /// Adds the derivatives of the joints' torques by parameter `k`, which changes the inertial parameters of `link` by `change`.
    fn body_by_parameter(&mut self, link: usize, change: &[f64], k: usize, h: f64) {
        let width = self.arm.dof() * PARAMETERS_PER_LINK;
        for i in 0..=link {
            let row = &self.regressor[i * width + link * PARAMETERS_PER_LINK..];
            let torque: f64 = row.iter().zip(change).map(|(y, c)| y * c).sum();
            self.resist(i, k, torque, h);
        }
    }
}
