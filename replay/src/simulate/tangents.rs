//! Sensitivities of the simulated motion to parameters, integrated along with it.

use super::{RENEWED, State};
use crate::arm::Integral;
use crate::friction::Slip;
use crate::parameter::Kind;
use physics::dynamics::inverse_dynamics_derivatives;

/// One step of the sensitivities as a call that [`pulp`] compiles for the widest vectors of this processor; a closure
/// would not be. Sums keep their order.
pub(super) struct Tangents<'s, 'a> {
    pub(super) state: &'s mut State<'a>,
    pub(super) h: f64,
}

impl pulp::NullaryFnOnce for Tangents<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.state.tangents(self.h);
    }
}

impl State<'_> {
    /// Computes the step's accelerations, and every few steps the derivatives of the rigid-body dynamics.
    pub(super) fn renew(&mut self, h: f64) {
        for i in 0..self.arm.dof() {
            self.acceleration[i] = (self.friction.velocity[i] - self.v[i]) / h;
        }
        self.arm.links(&self.acceleration, &mut self.link[2]);
        self.count += 1;
        if self.count % RENEWED != 1 {
            return;
        }
        let robot = &self.arm.robot;
        let [position, velocity, acceleration] = &self.link;
        inverse_dynamics_derivatives(
            robot,
            position,
            velocity,
            acceleration,
            &mut self.derivatives,
        );
        let [by_position, by_velocity] = &mut self.by_motion;
        by_position.copy_from_slice(&self.derivatives.dq);
        by_velocity.copy_from_slice(&self.derivatives.dqd);
        if self.coupled {
            self.arm.of_motors(by_position);
            self.arm.of_motors(by_velocity);
        }
        if let Some(gravity) = &mut self.gravity {
            inverse_dynamics_derivatives(
                &self.arm.given,
                &self.body,
                &self.still,
                &self.still,
                gravity,
            );
        }
    }

    /// Advances the sensitivities by one step. They satisfy the derivative of the step's own equation.
    #[inline(always)]
    fn tangents(&mut self, h: f64) {
        let (n, p) = (self.arm.dof(), self.parameters.len());
        self.rhs.fill(0.0);
        self.dtau.fill(0.0);
        self.commands_by_parameters();
        self.drives_by_parameters();
        for i in 0..n {
            let drive = self.drives[i];
            let joint = &self.arm.joints[i];
            let servo = &self.arm.servos[i];
            // Derivative of the drive's torque by command, integral and position.
            let dtau = &mut self.dtau[i * p..][..p];
            if drive.by_error != 0.0 {
                axpy(dtau, drive.by_error, &self.dsmooth[i * p..][..p]);
                axpy(dtau, -drive.by_error, &self.dq[i * p..][..p]);
            }
            if drive.by_integral != 0.0 {
                axpy(dtau, drive.by_integral, &self.dintegral[i * p..][..p]);
            }
            if servo.integral != Integral::None && drive.integrates {
                let cascade = servo.integral == Integral::Velocity;
                let of_error = if cascade { servo.kp / servo.kd } else { 1.0 };
                let own = &mut self.dintegral[i * p..][..p];
                axpy(own, h * of_error, &self.dsmooth[i * p..][..p]);
                axpy(own, -h * of_error, &self.dq[i * p..][..p]);
                if cascade {
                    axpy(own, -h, &self.dv[i * p..][..p]);
                }
                for (by, parameter) in own.iter_mut().zip(self.parameters) {
                    *by += h * match parameter.kind {
                        _ if parameter.joint != i => 0.0,
                        Kind::Offset => of_error,
                        Kind::Gain if cascade => drive.error / servo.kd,
                        Kind::ServoDamping if cascade => -of_error * drive.error / servo.kd,
                        _ => 0.0,
                    };
                }
            }
            let sign = self.friction.slip[i].sign();
            let pressed = self.pressed(i);
            let rhs = &mut self.rhs[i * p..][..p];
            axpy(rhs, h * (1.0 - pressed), &self.dtau[i * p..][..p]);
            // What is unknown does not pass through the drive, and presses on no gear.
            let [by_position, by_velocity] = drive.smooth_by;
            if drive.smooth_by != [0.0; 2] {
                axpy(rhs, h * by_position, &self.dq[i * p..][..p]);
                axpy(rhs, h * by_velocity, &self.dv[i * p..][..p]);
            }
            for j in 0..n {
                let at = i * n + j;
                let mut mass = self.mass[at] - h * self.by_motion[1][at];
                let mut stiffness = self.by_motion[0][at];
                if let Some(gravity) = &self.gravity {
                    let part = self.arm.gravity_compensation * drive.free();
                    stiffness -= part * (1.0 - pressed) * gravity.dq[at];
                }
                if i == j {
                    mass += joint.armature + h * pressed * drive.damping;
                    mass -= h * (1.0 - drive.implicit) * (joint.damping + drive.damping);
                    // Stribeck's fall with velocity.
                    mass += h * sign * joint.stribeck * drive.stribeck * 2.0 * self.v[i]
                        / joint.stribeck_velocity.powi(2);
                }
                axpy2(
                    rhs,
                    [mass, -h * stiffness],
                    [&self.dv[j * p..][..p], &self.dq[j * p..][..p]],
                );
            }
        }
        self.bodies_by_parameters(h);
        self.couplings_by_parameters(h);
        self.joints_by_parameters(h);
        self.friction.back_substitute(&mut self.rhs, p);
        std::mem::swap(&mut self.rhs, &mut self.dv);
        for (q, v) in self.dq.iter_mut().zip(&self.dv) {
            *q += h * v;
        }
    }

    /// Derivative of joint `i`'s load-dependent friction, with its sign, with respect to the torque of the drive. That
    /// share of a change of the torque is lost in the gear.
    pub(super) fn pressed(&self, i: usize) -> f64 {
        let sign = self.friction.slip[i].sign();
        sign * self.arm.joints[i].load * self.drives[i].transmitted.signum()
    }

    /// Adds the derivatives of the filtered commands, and of the torques by commanded velocity and added torque, by delays
    /// and filter time constants.
    #[inline(always)]
    fn commands_by_parameters(&mut self) {
        let (n, p) = (self.arm.dof(), self.parameters.len());
        for i in 0..n {
            let (drive, servo) = (self.drives[i], &self.arm.servos[i]);
            for s in &mut self.dsmooth[i * p..][..p] {
                *s *= 1.0 - drive.take;
            }
            for (k, parameter) in self.parameters.iter().enumerate() {
                let at = i * p + k;
                let common = parameter.kind == Kind::CommonDelay;
                if common || (parameter.kind == Kind::Delay && parameter.joint == i) {
                    self.dsmooth[at] -= drive.take * drive.command_rate;
                    if drive.drive_cut == 0.0 && drive.cut == 0.0 {
                        self.dtau[at] -= drive.torque_rate;
                    }
                }
                if parameter.kind == Kind::Lag && parameter.joint == i && servo.lag > 0.0 {
                    // take = 1 − exp(−h/T), so that its derivative by T is −h/T² exp(−h/T).
                    let change = (1.0 - drive.take).ln() / servo.lag * (1.0 - drive.take);
                    self.dsmooth[at] += change * drive.to_smooth / drive.take;
                    self.dsmooth[at] -= drive.take * drive.command_rate * drive.late_by_lag;
                }
            }
        }
    }

    /// Adds the derivatives of the drives' torques with respect to their own parameters.
    #[inline(always)]
    fn drives_by_parameters(&mut self) {
        let (n, p) = (self.arm.dof(), self.parameters.len());
        for (k, parameter) in self.parameters.iter().enumerate() {
            if parameter.kind == Kind::GravityCompensation {
                for i in 0..n {
                    self.dtau[i * p + k] += self.held[i] * self.drives[i].free();
                }
                continue;
            }
            let i = parameter.joint;
            let drive = self.drives[i];
            let linear = f64::from(drive.drive_cut == 0.0 && drive.cut == 0.0);
            let by = &mut self.dtau[i * p + k];
            match parameter.kind {
                Kind::Gain => *by += linear * drive.error,
                Kind::Damping if !self.arm.damped_by_drive(i) => {}
                Kind::ServoDamping | Kind::Damping => {
                    let change = self.friction.velocity[i] - self.v[i];
                    *by += linear * (drive.velocity_error - drive.implicit * change)
                }
                Kind::Integral => *by += linear * self.integral[i],
                Kind::DriveLimit => *by += drive.drive_cut * f64::from(drive.cut == 0.0),
                Kind::Limit => *by += drive.cut,
                Kind::Offset => *by += drive.by_error,
                _ => {}
            }
        }
    }

    /// Adds the derivatives by friction, rotor inertia and unknown torque to the right-hand side. A joint at rest has
    /// none.
    #[inline(always)]
    fn joints_by_parameters(&mut self, h: f64) {
        let p = self.parameters.len();
        for (k, parameter) in self.parameters.iter().enumerate() {
            let i = parameter.joint;
            let drive = self.drives[i];
            let slip = self.friction.slip[i];
            let sign = slip.sign();
            let by = match parameter.kind {
                Kind::Damping if !self.arm.damped_by_drive(i) => {
                    self.v[i] + drive.implicit * (self.friction.velocity[i] - self.v[i])
                }
                Kind::Coulomb => sign,
                Kind::Stribeck => sign * drive.stribeck,
                Kind::StribeckVelocity => {
                    let (own, pace) = (&self.arm.joints[i], self.arm.joints[i].stribeck_velocity);
                    sign * own.stribeck * drive.stribeck * 2.0 * self.v[i].powi(2) / pace.powi(3)
                }
                Kind::Load => sign * drive.transmitted.abs(),
                Kind::Armature => self.acceleration[i],
                Kind::Unknown(f) => -self.functions[i][f],
                _ => continue,
            };
            if slip != Slip::Stick {
                self.rhs[i * p + k] -= h * by;
            }
        }
    }
}

/// Adds `a` times `x` to `y`.
#[inline(always)]
fn axpy(y: &mut [f64], a: f64, x: &[f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += a * x;
    }
}

/// Adds `a` times `x`, of two vectors, to `y` in one pass.
#[inline(always)]
fn axpy2(y: &mut [f64], a: [f64; 2], x: [&[f64]; 2]) {
    for ((y, first), second) in y.iter_mut().zip(x[0]).zip(x[1]) {
        *y += a[0] * first + a[1] * second;
    }
}
