//! Drive file: what a URDF cannot say about drives and recordings (`--drive FILE.toml`).
//!
//! ```toml
//! # One value per joint, base first; every key is optional.
//! gear_ratio = [101, 101, 101, 101, 101, 101]              # motor turns per joint turn
//! torque_constant = [0.125, 0.125, 0.125, 0.0922, 0.0922, 0.0922] # N·m/A at the motor
//! rotor_inertia = [0.5, 0.5, 0.3, 0.1, 0.1, 0.1]           # kg·m², seen from the link
//! direction = [1, 1, -1, 1, 1, 1]                          # sign of the recorded motion and torque
//! zero = [0, -1.5708, 0, 0, 0, 0]                          # rad or m: q = direction·recorded + zero
//!
//! [columns]           # the recording's own names; {} is the joint's number, from 1
//! time = "timestamp"
//! q = "actual_q_{}"
//! tau = "motor_current_{}"
//!
//! [units]
//! time = "ms"         # s (default), ms, us, ns
//! angle = "deg"       # rad (default), deg: positions, velocities and accelerations of rotating joints
//! torque = "current"  # link (default), motor (N·m at the motor), current (A)
//!
//! [torque_filter]     # zero-phase Chebyshev low-pass that the recorded torque has been through
//! order = 4
//! cutoff_hz = 2.0
//! ripple_db = 0.2
//! ```

use super::{Robot, RobotError};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// Contents of a drive file.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Drive {
    /// Motor turns per joint turn (motor rad per m for a prismatic joint).
    pub gear_ratio: Option<Vec<f64>>,
    /// Motor torque per current, N·m/A.
    pub torque_constant: Option<Vec<f64>>,
    /// Inertia of motor and gear seen from the link, kg·m² or kg.
    pub rotor_inertia: Option<Vec<f64>>,
    /// Sign (1 or −1) of recorded motion and torque against the URDF's.
    pub direction: Option<Vec<f64>>,
    /// Joint zeros, rad or m: q = direction·recorded + zero.
    pub zero: Option<Vec<f64>>,
    /// The recording's own name of a column (`tau3`) or of a group of columns (`tau`), of `time` and of
    /// `trajectory`; `{}` stands for the joint's number, from 1.
    #[serde(default)]
    pub columns: BTreeMap<String, String>,
    /// Units of the recording.
    #[serde(default)]
    pub units: Units,
    /// Low-pass that the recorded torque has been through.
    pub torque_filter: Option<TorqueFilter>,
}

/// Units of a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Units {
    /// Of `time`.
    pub time: TimeUnit,
    /// Of positions, velocities and accelerations of rotating joints.
    pub angle: AngleUnit,
    /// What the torque columns hold.
    pub torque: TorqueUnit,
}

/// Unit of time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum TimeUnit {
    /// Seconds.
    #[default]
    S,
    /// Milliseconds.
    Ms,
    /// Microseconds.
    Us,
    /// Nanoseconds.
    Ns,
}

/// Unit of angles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum AngleUnit {
    /// Radians.
    #[default]
    Rad,
    /// Degrees.
    Deg,
}

/// What a torque column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum TorqueUnit {
    /// Torque on the link side of the gear, N·m or N.
    #[default]
    Link,
    /// Torque of the motor, N·m.
    Motor,
    /// Current of the motor, A.
    Current,
}

/// Zero-phase Chebyshev type I low-pass.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TorqueFilter {
    /// Order of one pass.
    pub order: usize,
    /// Edge of the pass band, Hz.
    pub cutoff_hz: f64,
    /// Ripple in the pass band of one pass, dB.
    pub ripple_db: f64,
}

/// Recorded value to SI on the link side: value · `scale` + `offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conversion {
    /// Factor.
    pub scale: f64,
    /// Added afterwards, SI.
    pub offset: f64,
}

impl Drive {
    /// Reads a drive file for `robot`.
    ///
    /// # Errors
    /// The file cannot be read, is no drive file, or does not fit the robot.
    pub fn from_file(path: impl AsRef<Path>, robot: &Robot) -> Result<Self, RobotError> {
        let path = path.as_ref();
        let text = std::fs::read_to_string(path).map_err(|source| RobotError::Read {
            path: path.to_owned(),
            source,
        })?;
        Self::from_toml(&text, robot)
    }

    /// Reads the text of a drive file for `robot`.
    ///
    /// # Errors
    /// No drive file, wrong numbers of values, or values that are impossible.
    pub fn from_toml(text: &str, robot: &Robot) -> Result<Self, RobotError> {
        let drive: Self = toml::from_str(text).map_err(|e| RobotError::Drive {
            reason: e.to_string(),
        })?;
        drive.check(robot)?;
        Ok(drive)
    }

    fn check(&self, robot: &Robot) -> Result<(), RobotError> {
        let lists = [
            ("gear_ratio", &self.gear_ratio),
            ("torque_constant", &self.torque_constant),
            ("rotor_inertia", &self.rotor_inertia),
            ("direction", &self.direction),
            ("zero", &self.zero),
        ];
        for (name, list) in lists {
            let Some(values) = list else { continue };
            if values.len() != robot.dof() {
                return Err(RobotError::Drive {
                    reason: format!(
                        "{name} has {} values, but {} has {} joints; give one per joint, base first",
                        values.len(),
                        robot.name(),
                        robot.dof()
                    ),
                });
            }
            let possible = |v: f64| match name {
                "zero" => v.is_finite(),
                "direction" => v.abs() == 1.0,
                "rotor_inertia" => v.is_finite() && v >= 0.0,
                _ => v.is_finite() && v > 0.0,
            };
            if let Some(at) = values.iter().position(|&v| !possible(v)) {
                let allowed = match name {
                    "zero" => "a finite number is needed",
                    "direction" => "only 1 and -1 are possible",
                    "rotor_inertia" => "it cannot be negative",
                    _ => "a positive number is needed (give a sign by direction)",
                };
                return Err(RobotError::Drive {
                    reason: format!("{name} of joint {} is {}; {allowed}", at + 1, values[at]),
                });
            }
        }
        if let Some(filter) = &self.torque_filter {
            let positive = |v: f64| v.is_finite() && v > 0.0;
            if filter.order == 0 || !positive(filter.cutoff_hz) || !positive(filter.ripple_db) {
                return Err(RobotError::Drive {
                    reason: "torque_filter needs a positive order, cutoff_hz and ripple_db"
                        .to_owned(),
                });
            }
        }
        self.torque_conversion(&self.apply(robot.clone())?)?;
        Ok(())
    }

    /// The robot with the gear ratios, torque constants and rotor inertias given here.
    ///
    /// # Errors
    /// Another number of joints.
    pub fn apply(&self, robot: Robot) -> Result<Robot, RobotError> {
        let mut robot = robot;
        if let Some(values) = &self.gear_ratio {
            robot.each_joint("gear_ratio", values, |j, v| j.gear_ratio = Some(v))?;
        }
        if let Some(values) = &self.torque_constant {
            robot.each_joint("torque_constant", values, |j, v| {
                j.torque_constant = Some(v);
            })?;
        }
        if let Some(values) = &self.rotor_inertia {
            robot = robot.with_rotor_inertia(values)?;
        }
        Ok(robot)
    }

    /// Seconds per unit of the `time` column.
    pub fn time_scale(&self) -> f64 {
        match self.units.time {
            TimeUnit::S => 1.0,
            TimeUnit::Ms => 1e-3,
            TimeUnit::Us => 1e-6,
            TimeUnit::Ns => 1e-9,
        }
    }

    /// Conversions of position columns, one per joint.
    pub fn position_conversion(&self, robot: &Robot) -> Vec<Conversion> {
        let mut conversions = self.rate_conversion(robot);
        if let Some(zero) = &self.zero {
            for (conversion, &zero) in conversions.iter_mut().zip(zero) {
                conversion.offset = zero;
            }
        }
        conversions
    }

    /// Conversions of velocity and acceleration columns, one per joint.
    pub fn rate_conversion(&self, robot: &Robot) -> Vec<Conversion> {
        let joints = robot.joints().iter().enumerate();
        joints
            .map(|(i, joint)| {
                let degrees = self.units.angle == AngleUnit::Deg && joint.kind.is_rotation();
                let unit = if degrees { 1.0_f64.to_radians() } else { 1.0 };
                Conversion {
                    scale: unit * self.sign(i),
                    offset: 0.0,
                }
            })
            .collect()
    }

    /// Conversions of torque columns, one per joint. `robot` may know gear ratios and torque constants that
    /// the file does not give.
    ///
    /// # Errors
    /// A gear ratio or torque constant is needed and not known.
    pub fn torque_conversion(&self, robot: &Robot) -> Result<Vec<Conversion>, RobotError> {
        let robot = self.apply(robot.clone())?;
        let need = |value: Option<f64>, name: &str, joint: &str| {
            value.ok_or_else(|| RobotError::Drive {
                reason: format!(
                    "units.torque = \"{}\" needs the {name} of joint {joint:?}; give {name} = [...]",
                    if self.units.torque == TorqueUnit::Motor {
                        "motor"
                    } else {
                        "current"
                    }
                ),
            })
        };
        let joints = robot.joints().iter().enumerate();
        joints
            .map(|(i, joint)| {
                let gear = || need(joint.gear_ratio, "gear_ratio", &joint.name);
                let constant = || need(joint.torque_constant, "torque_constant", &joint.name);
                let unit = match self.units.torque {
                    TorqueUnit::Link => 1.0,
                    TorqueUnit::Motor => gear()?,
                    TorqueUnit::Current => gear()? * constant()?,
                };
                Ok(Conversion {
                    scale: unit * self.sign(i),
                    offset: 0.0,
                })
            })
            .collect()
    }

    fn sign(&self, joint: usize) -> f64 {
        self.direction
            .as_ref()
            .and_then(|d| d.get(joint))
            .copied()
            .unwrap_or(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ur5() -> Robot {
        Robot::builtin("ur5").expect("built in")
    }

    #[test]
    fn current_becomes_link_torque() {
        let drive = Drive::from_toml(
            "direction = [1, 1, -1, 1, 1, 1]\nzero = [0, -1.5, 0, 0, 0, 0]\n\
             [columns]\ntau = \"current_{}\"\n[units]\nangle = \"deg\"\ntorque = \"current\"\ntime = \"ms\"",
            &ur5(),
        )
        .expect("a valid file");
        // The robot's own ratio 101 and constants serve.
        let torque = drive
            .torque_conversion(&ur5())
            .expect("constants are known");
        assert!((torque[0].scale - 12.625).abs() < 1e-12);
        assert!((torque[2].scale + 12.625).abs() < 1e-12);
        let position = drive.position_conversion(&ur5());
        assert!((position[1].scale - 0.017_453_292_519_943_295).abs() < 1e-17);
        assert_eq!(position[1].offset, -1.5);
        assert_eq!(drive.time_scale(), 1e-3);
        assert_eq!(drive.columns["tau"], "current_{}");
    }

    #[test]
    fn refusals_say_what_to_do() {
        for (text, expected) in [
            ("gear_ratio = [1, 2]", "has 2 values, but ur5 has 6 joints"),
            ("gear_ratio = [0, 1, 1, 1, 1, 1]", "joint 1 is 0"),
            ("direction = [2, 1, 1, 1, 1, 1]", "only 1 and -1"),
            ("gears = [1]", "unknown field"),
            ("gear_ratio = 3", "invalid type"),
            ("[units]\ntorque = \"amps\"", "unknown variant"),
        ] {
            let error = Drive::from_toml(text, &ur5()).expect_err(text).to_string();
            assert!(error.contains(expected), "{error}");
        }
        let foxbot = Robot::builtin("foxbot_a05").expect("built in");
        let error = Drive::from_toml("[units]\ntorque = \"current\"", &foxbot)
            .expect_err("no torque constants are known")
            .to_string();
        assert!(error.contains("torque_constant = [...]"), "{error}");
    }
}
