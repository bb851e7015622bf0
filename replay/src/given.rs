//! The simulator as given: an arm under its drives, with how far each given value is trusted.

use crate::arm::Arm;
use crate::command::Interpolation;
use crate::parameter::{Kind, Parameter};

/// The simulator's model and controller, as they stand.
#[derive(Debug, Clone)]
pub struct Given {
    /// Arm and drives with the given values.
    pub arm: Arm,
    /// Parameters that are known within a tolerance, each with its standard deviation relative to the given value; that
    /// of the logarithm where the parameter is searched by it.
    pub tolerances: Vec<(Parameter, f64)>,
    /// Parameters of which nothing is known: they are fitted, and are no cause.
    pub free: Vec<Parameter>,
    /// Whether the user states the position servos' gains (kp, kd) as exact: without tolerance, and not fitted.
    pub stated: bool,
    /// How the drive fills the time between commands.
    pub interpolation: Interpolation,
    /// What the drive is called in the report (`pd`, `pid`, `cascade`, `dc_servo`).
    pub controller: &'static str,
    /// What was assumed or changed, for the reader.
    pub notes: Vec<String>,
    /// What earlier recordings of the robot say, where it is given by them.
    pub earlier: Option<Earlier>,
}

/// What a fit to earlier recordings leaves open.
#[derive(Debug, Clone)]
pub struct Earlier {
    /// Parameters with the deviations of their coordinates.
    pub open: Vec<(Parameter, f64)>,
    /// By joint the unexplained part of the earlier recordings; none of a joint that never moved.
    pub unexplained: Vec<Option<f64>>,
}

impl Given {
    /// Tolerance of a parameter; 0 where its value stands as it is.
    pub fn tolerance(&self, parameter: Parameter) -> f64 {
        let own = self.tolerances.iter().find(|(p, _)| *p == parameter);
        own.map_or(0.0, |(_, t)| *t)
    }

    /// Whether nothing is known of a parameter.
    pub fn is_free(&self, parameter: Parameter) -> bool {
        self.free.contains(&parameter)
    }

    /// The same simulator where no velocities are commanded: the drive's damping and viscous friction then are one number,
    /// which is held as viscous friction.
    pub fn without_rates(&self) -> Self {
        let mut out = self.clone();
        let merges: Vec<bool> = out
            .arm
            .servos
            .iter()
            .map(|s| s.integral != crate::arm::Integral::Velocity)
            .collect();
        for (j, servo) in out.arm.servos.iter().enumerate() {
            // Of a simulator that is given by earlier recordings they are merged already.
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

    /// The kind of the parameter that cuts the torque of these drives.
    pub fn limit(&self) -> Kind {
        if self.controller == "dc_servo" {
            Kind::DriveLimit
        } else {
            Kind::Limit
        }
    }
}
