//! Drive file: properties of drives and recordings that a URDF cannot hold (`--drive FILE.toml`).
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
//!
//! The block `[controller]` stands at [`Controller`].

mod controller;
mod conversion;
mod driven;
mod units;

pub use controller::{
    Controller, ControllerKind, GravityCompensation, Interpolation, Key, PerJoint, Tolerance,
};
pub use conversion::Conversion;
pub use driven::{Driven, DrivenAxis};
pub use units::{AngleUnit, TimeUnit, TorqueUnit, Units};

use super::{Robot, RobotError};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// Highest order of the low-pass that a recorded torque has passed.
const HIGHEST_ORDER: usize = 16;

/// Contents of a drive file.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Drive {
    /// Motor turns per joint turn of each joint (motor rad per m for a prismatic joint).
    pub gear_ratio: Option<Vec<f64>>,
    /// Motor torque per current of each joint, N·m/A.
    pub torque_constant: Option<Vec<f64>>,
    /// Rated (continuous) current of each motor, A.
    pub rated_current: Option<Vec<f64>>,
    /// Travel of a linear axis per turn of its screw (of its pulley: 2π times the radius), m; the gear ratio is then motor
    /// turns per turn of the screw, 1 where none is given. Zero for a joint without screw.
    pub screw_lead: Option<Vec<f64>>,
    /// Inertia of motor and gear seen from the link, kg·m² or kg.
    pub rotor_inertia: Option<Vec<f64>>,
    /// Sign (1 or −1) of each joint's recorded motion and torque against the URDF's.
    pub direction: Option<Vec<f64>>,
    /// Factor on each joint's recorded torque, beside its unit; negative where its sign is not the motion's.
    pub torque_scale: Option<Vec<f64>>,
    /// Zero of each joint, rad or m: q = direction·recorded + zero.
    pub zero: Option<Vec<f64>>,
    /// Whole cycles of the controller by which an additive torque is sent late, to meet a motion that follows its command late.
    pub torque_delay: Option<Vec<u32>>,
    /// Largest additive torque of each joint that the controller sends, N·m or N.
    pub torque_threshold: Option<Vec<f64>>,
    /// The recording's own name of a column (`tau3`) or of a group of columns (`tau`), of `time` and of
    /// `trajectory`; `{}` is replaced by the joint's number, from 1.
    #[serde(default)]
    pub columns: BTreeMap<String, String>,
    /// Units of the recording's columns.
    #[serde(default)]
    pub units: Units,
    /// Low-pass that the recorded torque has been through.
    pub torque_filter: Option<TorqueFilter>,
    /// Controller, which turns commanded motion into torque.
    pub controller: Option<Controller>,
}

/// Zero-phase Chebyshev type I low-pass.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TorqueFilter {
    /// Order of one pass of the filter.
    pub order: usize,
    /// Edge of the pass band, Hz.
    pub cutoff_hz: f64,
    /// Ripple in the pass band of one pass, dB.
    pub ripple_db: f64,
}

impl Drive {
    /// Reads a drive file for `robot`.
    ///
    /// # Errors
    /// The file cannot be read, is not a drive file, or does not fit the robot.
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
            let order = 1..=HIGHEST_ORDER;
            if !order.contains(&filter.order)
                || !positive(filter.cutoff_hz)
                || !positive(filter.ripple_db)
            {
                return Err(RobotError::Drive {
                    reason: format!(
                        "torque_filter needs an order of 1 to {HIGHEST_ORDER} and a positive cutoff_hz and ripple_db"
                    ),
                });
            }
        }
        if let Some(controller) = &self.controller {
            controller.check(robot)?;
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
        if let Some(leads) = &self.screw_lead {
            // Motor rad per m, as a sliding joint's ratio is; the file has motor turns per turn of the screw.
            let turns = |own: Option<f64>| self.gear_ratio.as_ref().and(own).unwrap_or(1.0);
            robot.each_joint("screw_lead", leads, |j, lead| {
                if lead > 0.0 {
                    j.gear_ratio = Some(turns(j.gear_ratio) * std::f64::consts::TAU / lead);
                }
            })?;
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
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ur5() -> Robot {
        Robot::builtin("ur5").expect("built in")
    }

    #[test]
    fn a_screw_turns_its_motor_so_often_per_metre() {
        let text = r#"<robot name="r"><link name="a"/><link name="b"><inertial><mass value="1"/>
            <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
            <joint name="s" type="prismatic"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/>
            <limit lower="0" upper="1" effort="1" velocity="1"/></joint></robot>"#;
        let robot = Robot::from_urdf_str(text).expect("a slide");
        for (drive, turns) in [
            ("screw_lead = [0.02]", 50.0),
            ("gear_ratio = [2]\nscrew_lead = [0.02]", 100.0),
        ] {
            let drive = Drive::from_toml(drive, &robot).expect("a drive");
            let ratio = drive.apply(robot.clone()).expect("one joint").joints()[0].gear_ratio;
            let expected = turns * std::f64::consts::TAU;
            assert!(
                (ratio.expect("a ratio") - expected).abs() < 1e-9,
                "{ratio:?}"
            );
        }
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
