//! Drive file: what a URDF cannot say about drives and recordings (`--drive FILE.toml`).
//!
//! ```toml
//! # One value per joint, base first; every key is optional.
//! gear_ratio = [101, 101, 101, 101, 101, 101]              # motor turns per joint turn
//! torque_constant = [0.125, 0.125, 0.125, 0.0922, 0.0922, 0.0922] # N·m/A at the motor
//! rated_current = [4.5, 4.5, 3.0, 1.5, 1.5, 1.5]           # A, what a current "per mille of rated" refers to
//! screw_lead = [0, 0, 0.02, 0, 0, 0]                       # m per turn behind the gear; 0: none
//! rotor_inertia = [0.5, 0.5, 0.3, 0.1, 0.1, 0.1]           # kg·m², seen from the link
//! direction = [1, 1, -1, 1, 1, 1]                          # sign of the recorded motion and torque
//! torque_scale = [1, 1, 1, -1, 1, 1]                       # what the recorded torque is multiplied by, beside its unit
//! zero = [0, -1.5708, 0, 0, 0, 0]                          # rad or m: q = direction·recorded + zero
//! torque_delay = [3, 3, 3, 3, 3, 3]                        # cycles by which the drive is sent its additive torque late
//! torque_threshold = [300, 300, 150, 28, 28, 28]           # N·m or N: more additive torque is refused by the controller
//!
//! [columns]           # the recording's own names; {} is the joint's number, from 1
//! time = "timestamp"
//! q = "actual_q_{}"
//! tau = "motor_current_{}"
//!
//! [units]
//! time = "ms"         # s (default), ms, us, ns
//! angle = "deg"       # rad (default), deg: positions, velocities and accelerations of rotating joints
//! torque = "current"  # link (default), motor (N·m at the motor), current (A), rated, percent (‰, % of rated current)
//!
//! [torque_filter]     # zero-phase Chebyshev low-pass that the recorded torque has been through
//! order = 4
//! cutoff_hz = 2.0
//! ripple_db = 0.2
//! ```

mod driven;
mod units;

pub use driven::{Driven, DrivenAxis};
pub use units::{AngleUnit, TimeUnit, TorqueUnit, Units};

use super::{Robot, RobotError};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::path::Path;

/// Contents of a drive file.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Drive {
    /// Motor turns per joint turn (motor rad per m for a prismatic joint).
    pub gear_ratio: Option<Vec<f64>>,
    /// Motor torque per current, N·m/A.
    pub torque_constant: Option<Vec<f64>>,
    /// Rated (continuous) current of the motor, A.
    pub rated_current: Option<Vec<f64>>,
    /// Travel of a linear axis per turn of its screw (of its pulley: 2π times the radius), m; the gear ratio is then motor
    /// turns per turn of the screw, 1 where none is given. Zero for a joint without screw.
    pub screw_lead: Option<Vec<f64>>,
    /// Inertia of motor and gear seen from the link, kg·m² or kg.
    pub rotor_inertia: Option<Vec<f64>>,
    /// Sign (1 or −1) of recorded motion and torque against the URDF's.
    pub direction: Option<Vec<f64>>,
    /// What recorded torque is multiplied by, beside its unit; negative where its sign is not the motion's.
    pub torque_scale: Option<Vec<f64>>,
    /// Joint zeros, rad or m: q = direction·recorded + zero.
    pub zero: Option<Vec<f64>>,
    /// Whole cycles of the controller by which an additive torque is sent late, to meet a motion that follows its command late.
    pub torque_delay: Option<Vec<u32>>,
    /// Largest additive torque that the controller sends, N·m or N.
    pub torque_threshold: Option<Vec<f64>>,
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
    pub fn from_file(path: impl AsRef<Path>, robot: &impl Driven) -> Result<Self, RobotError> {
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
    pub fn from_toml(text: &str, robot: &impl Driven) -> Result<Self, RobotError> {
        let drive: Self = toml::from_str(text).map_err(|e| RobotError::Drive {
            reason: e.to_string(),
        })?;
        drive.check(robot)?;
        Ok(drive)
    }

    fn check(&self, robot: &impl Driven) -> Result<(), RobotError> {
        let delay: Option<Vec<f64>> = self
            .torque_delay
            .as_ref()
            .map(|cycles| cycles.iter().copied().map(f64::from).collect());
        let lists = [
            ("gear_ratio", &self.gear_ratio),
            ("torque_constant", &self.torque_constant),
            ("rated_current", &self.rated_current),
            ("screw_lead", &self.screw_lead),
            ("rotor_inertia", &self.rotor_inertia),
            ("direction", &self.direction),
            ("torque_scale", &self.torque_scale),
            ("zero", &self.zero),
            ("torque_delay", &delay),
            ("torque_threshold", &self.torque_threshold),
        ];
        let joints = robot.axes();
        for (name, list) in lists {
            let Some(values) = list else { continue };
            if values.len() != joints.len() {
                return Err(RobotError::Drive {
                    reason: format!(
                        "{name} has {} values, but {} has {} joints; give one per joint, base first",
                        values.len(),
                        robot.name(),
                        joints.len()
                    ),
                });
            }
            let possible = |v: f64| match name {
                "zero" => v.is_finite(),
                "direction" => v.abs() == 1.0,
                "torque_scale" => v.is_finite() && v != 0.0,
                "rotor_inertia" | "screw_lead" | "torque_delay" => v.is_finite() && v >= 0.0,
                _ => v.is_finite() && v > 0.0,
            };
            if let Some(at) = values.iter().position(|&v| !possible(v)) {
                let allowed = match name {
                    "zero" => "a finite number is needed",
                    "direction" => "only 1 and -1 are possible",
                    "torque_scale" => "a number that is not zero is needed",
                    "rotor_inertia" | "screw_lead" | "torque_delay" => "it cannot be negative",
                    _ => "a positive number is needed (give a sign by direction)",
                };
                return Err(RobotError::Drive {
                    reason: format!("{name} of joint {} is {}; {allowed}", at + 1, values[at]),
                });
            }
        }
        let mut screws = self.screw_lead.iter().flatten().zip(&joints);
        if let Some((_, joint)) = screws.find(|(lead, j)| **lead > 0.0 && j.rotates) {
            return Err(RobotError::Drive {
                reason: format!(
                    "screw_lead of joint {:?}, which rotates; give 0 for joints without a screw",
                    joint.name
                ),
            });
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
        self.torque_conversion(robot)?;
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
    pub fn position_conversion(&self, robot: &impl Driven) -> Vec<Conversion> {
        let mut conversions = self.rate_conversion(robot);
        if let Some(zero) = &self.zero {
            for (conversion, &zero) in conversions.iter_mut().zip(zero) {
                conversion.offset = zero;
            }
        }
        conversions
    }

    /// Conversions of velocity and acceleration columns, one per joint.
    pub fn rate_conversion(&self, robot: &impl Driven) -> Vec<Conversion> {
        let joints = robot.axes().into_iter().enumerate();
        joints
            .map(|(i, joint)| {
                let degrees = self.units.angle == AngleUnit::Deg && joint.rotates;
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
    /// Per mille of rated current becomes torque by rated current / 1000 · torque constant · gear ratio, and force by
    /// 2π / screw lead on top of that: the torque factor of the softMC manual ("torque units", "how to include the gear
    /// ratio", "linear axes").
    ///
    /// # Errors
    /// A gear ratio, torque constant or rated current is needed and not known.
    pub fn torque_conversion(&self, robot: &impl Driven) -> Result<Vec<Conversion>, RobotError> {
        let joints = robot.axes().into_iter().enumerate();
        joints
            .map(|(i, joint)| {
                let own = |list: &Option<Vec<f64>>| list.as_ref().and_then(|l| l.get(i)).copied();
                let need = |value: Option<f64>, name: &str| {
                    value.ok_or_else(|| RobotError::Drive {
                        reason: format!(
                            "units.torque = {:?} needs the {name} of joint {:?}; give {name} = [...]",
                            self.units.torque.name(),
                            joint.name
                        ),
                    })
                };
                let gear = || {
                    let ratio = own(&self.gear_ratio);
                    match own(&self.screw_lead).filter(|lead| *lead > 0.0) {
                        Some(lead) => Ok(ratio.unwrap_or(1.0) * TAU / lead),
                        None => need(ratio.or(joint.gear_ratio), "gear_ratio"),
                    }
                };
                let constant = || {
                    let known = own(&self.torque_constant).or(joint.torque_constant);
                    need(known, "torque_constant")
                };
                let unit = match self.units.torque {
                    TorqueUnit::Link => 1.0,
                    TorqueUnit::Motor => gear()?,
                    TorqueUnit::Current => gear()? * constant()?,
                    TorqueUnit::Rated | TorqueUnit::Percent => {
                        let rated = need(own(&self.rated_current), "rated_current")?;
                        self.units.torque.part_of_rated() * rated * constant()? * gear()?
                    }
                };
                Ok(Conversion {
                    scale: unit * self.sign(i) * own(&self.torque_scale).unwrap_or(1.0),
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
    fn per_mille_of_rated_current_becomes_torque() {
        let drive = Drive::from_toml(
            "rated_current = [2, 2, 2, 2, 2, 2]\ntorque_delay = [3, 3, 3, 3, 3, 3]\n\
             torque_threshold = [9, 9, 9, 9, 9, 9]\n[units]\ntorque = \"rated\"",
            &ur5(),
        )
        .expect("a valid file");
        let torque = drive
            .torque_conversion(&ur5())
            .expect("everything is known");
        // 2 A / 1000 · 0.125 N·m/A · 101
        assert!((torque[0].scale - 0.025_25).abs() < 1e-15);
        let text = "rated_current = [2, 2, 2, 2, 2, 2]\ntorque_scale = [1, -2, 1, 1, 1, 1]\n\
                    units.torque = \"percent\"";
        let percent = Drive::from_toml(text, &ur5()).expect("a valid file");
        let torque = percent.torque_conversion(&ur5()).expect("all known");
        assert!((torque[0].scale - 0.2525).abs() < 1e-14);
        assert!((torque[1].scale + 0.505).abs() < 1e-14);
    }

    /// A screw of 20 mm lead behind a 2:1 gear: one turn of the motor is 10 mm, so 1 N·m is 2π / 0.01 N.
    #[test]
    fn a_screw_turns_torque_into_force() {
        struct Spindle;
        impl Driven for Spindle {
            fn name(&self) -> &str {
                "spindle"
            }
            fn axes(&self) -> Vec<DrivenAxis> {
                vec![DrivenAxis {
                    name: "A1".to_owned(),
                    rotates: false,
                    gear_ratio: None,
                    torque_constant: None,
                }]
            }
        }
        let text = "gear_ratio = [2]\nscrew_lead = [0.02]\n[units]\ntorque = \"motor\"";
        let drive = Drive::from_toml(text, &Spindle).expect("a valid file");
        let force = drive.torque_conversion(&Spindle).expect("all known");
        assert!((force[0].scale - TAU / 0.01).abs() < 1e-9);
        let none = Drive::from_toml("[units]\ntorque = \"rated\"", &Spindle);
        let error = none.expect_err("nothing is known").to_string();
        assert!(error.contains("needs the rated_current"), "{error}");
    }

    #[test]
    fn refusals_say_what_to_do() {
        for (text, expected) in [
            ("gear_ratio = [1, 2]", "has 2 values, but ur5 has 6 joints"),
            ("gear_ratio = [0, 1, 1, 1, 1, 1]", "joint 1 is 0"),
            ("direction = [2, 1, 1, 1, 1, 1]", "only 1 and -1"),
            ("screw_lead = [0.02, 0, 0, 0, 0, 0]", "which rotates"),
            (
                "torque_scale = [0, 1, 1, 1, 1, 1]",
                "torque_scale of joint 1",
            ),
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
