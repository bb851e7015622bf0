//! One step of the closed-loop simulation.

use super::tangents::Tangents;
use super::{Drive, State};
use crate::arm::Integral;
use crate::smooth::Here;
use physics::dynamics::{inverse_dynamics, mass_matrix};

impl State<'_> {
    /// Advances the simulation from time `t` by `h` seconds, with the sensitivities where parameters are given.
    pub(super) fn step(&mut self, t: f64, h: f64) {
        let n = self.arm.dof();
        for i in 0..n {
            self.body[i] = self.q[i] + self.arm.zero[i];
        }
        self.arm.links(&self.body, &mut self.link[0]);
        self.arm.links(&self.v, &mut self.link[1]);
        let [position, velocity, _] = &self.link;
        let robot = &self.arm.robot;
        mass_matrix(robot, &mut self.workspace, position, &mut self.mass);
        inverse_dynamics(
            robot,
            &mut self.workspace,
            position,
            velocity,
            &self.still,
            &mut self.bias,
        );
        for passive in robot.passive() {
            let joint = passive.joint();
            self.bias[joint] += passive.torque(position[joint]);
        }
        if self.coupled {
            self.arm.of_motors(&mut self.mass);
            self.arm.on_motors(&mut self.bias);
        }
        if self.compensates {
            // The drive knows the given description, not the payload that it carries.
            inverse_dynamics(
                &self.arm.given,
                &mut self.workspace,
                &self.body,
                &self.still,
                &self.still,
                &mut self.held,
            );
        }
        for i in 0..n {
            let drive = self.drive(i, t, h);
            self.drives[i] = drive;
            let joint = &self.arm.joints[i];
            let shape = (self.v[i] / joint.stribeck_velocity).powi(2);
            self.drives[i].stribeck = (-shape).exp();
            let limit = joint.coulomb
                + joint.stribeck * self.drives[i].stribeck
                + joint.load * drive.transmitted.abs();
            self.limits[i] = h * limit.max(0.0);
            self.b[i] = h * (drive.torque - self.bias[i]);
            for j in 0..n {
                self.a[i * n + j] = self.mass[i * n + j];
            }
            self.a[i * n + i] += joint.armature;
            for j in 0..n {
                self.b[i] += self.a[i * n + j] * self.v[j];
            }
            let damping = h * (joint.damping + drive.damping);
            let implicit = implicit(damping / self.a[i * n + i]);
            self.drives[i].implicit = implicit;
            self.b[i] -= (1.0 - implicit) * damping * self.v[i];
            self.a[i * n + i] += implicit * damping;
        }
        // Inconsistent sets of slipping joints, which rounding can cause, are accepted: they differ little from the
        // solution.
        self.friction.solve(&self.a, &self.b, &self.limits);
        if !self.parameters.is_empty() {
            self.renew(h);
            // Vector instructions of this processor; sums keep their order.
            let arch = self.arch;
            arch.dispatch(Tangents { state: self, h });
        }
        for i in 0..n {
            let drive = &self.drives[i];
            if drive.integrates {
                let servo = &self.arm.servos[i];
                self.integral[i] += h * match servo.integral {
                    Integral::None => 0.0,
                    Integral::Position => drive.error,
                    Integral::Velocity => servo.kp / servo.kd * drive.error + drive.velocity_error,
                };
            }
            self.smooth[i] += drive.to_smooth;
            self.v[i] = self.friction.velocity[i];
            self.q[i] += h * self.v[i];
        }
    }

    /// Torque of the drive of joint `i` in the step from `t` over `h` seconds, with its derivatives.
    fn drive(&mut self, i: usize, t: f64, h: f64) -> Drive {
        let servo = &self.arm.servos[i];
        let mut out = Drive::default();
        let at = t - self.arm.delay - servo.delay - 0.5 * h;
        let [hint, rate_hint, added_hint] = &mut self.hints[i];
        let (take, late, late_by_lag) = filter(servo.lag, h);
        let (mean, rate) = self.track.commands[i].mean(at - late, h, hint);
        (out.take, out.command_rate, out.late_by_lag) = (take, rate, late_by_lag);
        out.to_smooth = out.take * (mean - self.smooth[i]);
        let command = self.smooth[i] + out.to_smooth;
        let (commanded_velocity, later) = match &self.track.rates {
            Some(rates) => rates[i].mean(at, h, rate_hint),
            None => (0.0, 0.0),
        };
        let (added, added_later) = match &self.track.added {
            Some(added) => added[i].mean(at, h, added_hint),
            None => (0.0, 0.0),
        };
        out.torque_rate = servo.kd * later + added_later;
        out.error = command + servo.offset - self.q[i];
        out.velocity_error = commanded_velocity - self.v[i];
        let fixed = servo.kp * out.error + servo.ki * self.integral[i] + added;
        out.wanted = fixed + servo.kd * out.velocity_error;
        if out.wanted.abs() > servo.drive_limit {
            out.drive_cut = out.wanted.signum();
        }
        let (torque, damping) = if out.drive_cut == 0.0 {
            (
                fixed + servo.kd * commanded_velocity,
                servo.kd + servo.back_emf,
            )
        } else {
            (out.drive_cut * servo.drive_limit, servo.back_emf)
        };
        let torque = torque + self.arm.gravity_compensation * self.held[i];
        let now = torque - damping * self.v[i];
        if now.abs() > servo.limit {
            out.cut = now.signum();
            out.torque = out.cut * servo.limit;
            out.transmitted = out.torque;
        } else {
            (out.torque, out.damping, out.transmitted) = (torque, damping, now);
            if out.drive_cut == 0.0 {
                out.by_error = servo.kp;
                out.by_integral = servo.ki;
            }
        }
        out.integrates = servo.integral != Integral::None && out.drive_cut == 0.0 && out.cut == 0.0;
        if self.smooths[i] {
            let smooth = &self.arm.joints[i].unknown;
            let here = Here {
                q: self.q[i],
                v: self.v[i],
                load: out.transmitted,
                rate,
            };
            self.functions[i] = smooth.values(here);
            if smooth.acts() {
                let [torque, by_position, by_velocity] = smooth.torque(here, &self.functions[i]);
                out.torque += torque;
                out.smooth_by = [by_position, by_velocity];
            }
        }
        out
    }
}

/// Share of a damping that acts on the velocity at a step's end, by the damping over the step and the inertia, both of one joint.
/// With a half the step is exact to second order: damping that acts wholly at the end adds inertia, half of itself over the step. A
/// damping so high that its first half would turn the motion round takes as little of the start as stops it.
fn implicit(relative: f64) -> f64 {
    (1.0 - 1.0 / relative).max(0.5)
}

/// Filter of the time constant `lag` over a step of `h`, s: the share of the distance to its input that it covers, how much earlier
/// that input is taken, so that a ramp is followed exactly `lag` late, and the derivative of that time by `lag`.
fn filter(lag: f64, h: f64) -> (f64, f64, f64) {
    if lag == 0.0 {
        return (1.0, 0.0, 0.0);
    }
    let x = h / lag;
    let (take, grown) = (-(-x).exp_m1(), x.exp_m1());
    (take, lag - h / grown, 1.0 - x * x / (grown * take))
}
