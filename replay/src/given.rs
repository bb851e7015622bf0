//! Simulator as given: an arm with its drives, and how far each given value is trusted.

use crate::arm::Arm;
use crate::command::Interpolation;
use crate::parameter::{Kind, Parameter};
use model::spread::NINETY;

/// Simulator as given: model, controller and how well each of their values is known.
#[derive(Debug, Clone)]
pub struct Given {
    /// Arm and drives with the given values.
    pub arm: Arm,
    /// Parameters that are known within a tolerance. The number is the standard deviation relative to the given value;
    /// for a parameter fitted as its logarithm, the standard deviation of that.
    pub tolerances: Vec<(Parameter, f64)>,
    /// Parameters of which no value is known. They are fitted under every set of hypotheses and are never a cause.
    pub free: Vec<Parameter>,
    /// Whether the user states the position servos' gains (kp, kd) as exact: without tolerance, and not fitted.
    pub stated: bool,
    /// Command that the drive follows between two recorded commands: the last one, or a straight line.
    pub interpolation: Interpolation,
    /// Name of the drives' controller in the report: `pd`, `pid`, `cascade` or `dc_servo`.
    pub controller: &'static str,
    /// Notes for the reader of the report: assumptions about the simulator and changes to its description.
    pub notes: Vec<String>,
    /// Whether each joint's drive is given no limit of its torque, and has a supposed one in `arm`, which the motion does not meet.
    /// It is empty where none has.
    pub unlimited: Vec<bool>,
    /// Result of the fit to earlier recordings, where the simulator stands for the robot at that time; none otherwise.
    pub earlier: Option<Earlier>,
}

/// Uncertainty and error that remain after a fit to earlier recordings.
#[derive(Debug, Clone)]
pub struct Earlier {
    /// Parameters that were fitted, each with the posterior standard deviation of its coordinate.
    pub open: Vec<(Parameter, f64)>,
    /// Ratio, by joint, of RMS simulation error to RMS of command less position on the earlier recordings. None for a
    /// joint that never moved.
    pub unexplained: Vec<Option<f64>>,
}

impl Given {
    /// Relative tolerance of a parameter; 0 where its given value is taken as exact.
    pub fn tolerance(&self, parameter: Parameter) -> f64 {
        let own = self.tolerances.iter().find(|(p, _)| *p == parameter);
        own.map_or(0.0, |(_, t)| *t)
    }

    /// Whether no value of the parameter is known, so that it is fitted in any case.
    pub fn is_free(&self, parameter: Parameter) -> bool {
        self.free.contains(&parameter)
    }

    /// Whether the parameter's value is given with a tolerance, or not at all.
    pub(crate) fn doubts(&self, parameter: Parameter) -> bool {
        self.tolerance(parameter) > 0.0 || self.is_free(parameter)
    }

    /// Simulator for recordings without commanded velocities. The drive's damping and the viscous friction of a joint
    /// then only show as their sum, which is fitted as viscous friction. Joints under a cascade controller keep both.
    pub fn without_rates(&self) -> Self {
        let mut out = self.clone();
        let merges: Vec<bool> = out
            .arm
            .servos
            .iter()
            .map(|s| s.integral != crate::arm::Integral::Velocity)
            .collect();
        for (j, servo) in out.arm.servos.iter().enumerate() {
            // In a simulator from earlier recordings they are merged already.
            if self.earlier.is_none() {
                out.arm.shared[j] = if merges[j] { servo.kd } else { 0.0 };
            }
        }
        let merged = |p: &mut Parameter| {
            if p.kind == Kind::ServoDamping && merges[p.joint] {
                p.kind = Kind::Damping;
            }
        };
        out.tolerances.iter_mut().for_each(|(p, _)| merged(p));
        out.free.iter_mut().for_each(merged);
        out
    }

    /// Longest time, s, by which each joint follows a ramp of commands late by the given values: delays, and damping over
    /// the proportional gain. Gains are at the ends of the 90 % intervals that their tolerances make. `rates`: the drives get
    /// commanded velocities, so that their own damping does not slow a ramp.
    pub fn lags(&self, rates: bool) -> Vec<f64> {
        let arm = &self.arm;
        let of = |j: usize| {
            let (servo, joint) = (&arm.servos[j], &arm.joints[j]);
            let reach = |kind: Kind| NINETY * self.tolerance(Parameter::new(kind, j));
            let own = if rates {
                0.0
            } else {
                servo.kd * (1.0 + reach(Kind::ServoDamping))
            };
            let back_emf = servo.back_emf * (1.0 + reach(Kind::Damping));
            let damping = own + back_emf + joint.damping;
            arm.late(j) + damping / servo.kp * reach(Kind::Gain).exp()
        };
        (0..arm.dof()).map(of).collect()
    }

    /// Kind of the parameter that limits the torque of these drives: the voltage limit for `dc_servo`, else the torque
    /// limit.
    pub fn limit(&self) -> Kind {
        if self.controller == "dc_servo" {
            Kind::DriveLimit
        } else {
            Kind::Limit
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::{Integral, Servo};
    use physics::robot::Robot;

    #[test]
    fn a_soft_drive_is_late_by_its_damping_over_its_gain() {
        let robot = Robot::builtin("ur5").expect("built in");
        let servo = Servo {
            kp: 100.0,
            kd: 20.0,
            ki: 0.0,
            integral: Integral::None,
            back_emf: 0.0,
            drive_limit: f64::INFINITY,
            limit: f64::INFINITY,
            delay: 0.01,
            lag: 0.0,
            offset: 0.0,
        };
        let mut arm = Arm::new(robot, vec![servo; 6]);
        for joint in &mut arm.joints {
            joint.damping = 5.0;
        }
        let mut given = Given {
            arm,
            tolerances: Vec::new(),
            free: Vec::new(),
            stated: true,
            interpolation: Interpolation::Hold,
            controller: "pd",
            notes: Vec::new(),
            unlimited: Vec::new(),
            earlier: None,
        };
        assert!((given.lags(false)[3] - 0.26).abs() < 1e-12);
        assert!((given.lags(true)[3] - 0.06).abs() < 1e-12);
        given.tolerances = vec![(Parameter::new(Kind::Gain, 3), 0.3)];
        let late = 0.01 + 0.25 * (0.3 * NINETY).exp();
        assert!((given.lags(false)[3] - late).abs() < 1e-12);
        assert!((given.lags(false)[2] - 0.26).abs() < 1e-12);
    }
}
