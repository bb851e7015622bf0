//! Controller of a robot's drives: block `[controller]` of the drive file.
//!
//! ```toml
//! [controller]
//! kind = "pd"            # pd, pid, cascade, dc_servo
//! kp = [80, 120]         # one value per joint, or a number that stands for all
//! kd = 2.5
//! tolerance = 0.1        # relative, of the values above: a number, or a table by key ({ kp = 0.1 })
//! free = ["delay"]       # keys whose value is not known at all
//! limit = [30, 60]       # largest torque, N·m (N)
//! delay = 0.0            # time by which commands reach the drive late, s
//! period = 0.005         # time between commands, s
//! interpolation = "hold" # hold, linear: what the drive does between two commands
//! gravity_compensation = false   # true, false, "unknown"
//! ```

mod value;

pub use value::{GravityCompensation, Interpolation, Key, PerJoint, Tolerance};

use super::Driven;
use crate::robot::RobotError;
use serde::{Deserialize, Serialize};

/// Controller of the drives.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Controller {
    /// Control law of all drives.
    pub kind: ControllerKind,
    /// Gain on the position error: see [`Key::Kp`].
    pub kp: Option<PerJoint>,
    /// Gain on the velocity error: see [`Key::Kd`].
    pub kd: Option<PerJoint>,
    /// Gain on the integral of the position error: see [`Key::Ki`].
    pub ki: Option<PerJoint>,
    /// Gain of a cascade on the velocity error: see [`Key::KpVelocity`].
    pub kp_velocity: Option<PerJoint>,
    /// Gain of a cascade on the integral of the velocity error: see [`Key::KiVelocity`].
    pub ki_velocity: Option<PerJoint>,
    /// Torque of a hobby servo at standstill per error: see [`Key::TorquePerError`].
    pub torque_per_error: Option<PerJoint>,
    /// Torque lost per velocity: see [`Key::BackEmf`].
    pub back_emf: Option<PerJoint>,
    /// Torque at standstill under the full supply voltage: see [`Key::Voltage`].
    pub voltage: Option<PerJoint>,
    /// Largest torque: see [`Key::Limit`].
    pub limit: Option<PerJoint>,
    /// Delay of the commands: see [`Key::Delay`].
    pub delay: Option<PerJoint>,
    /// Relative tolerance (one standard deviation) of the given values.
    #[serde(default)]
    pub tolerance: Tolerance,
    /// Keys whose values are unknown. A value given for them is at most a start of the fit.
    #[serde(default)]
    pub free: Vec<Key>,
    /// Period of the commands, s; taken from the recording where it is not given.
    pub period: Option<f64>,
    /// Set point of the drive between two commands.
    #[serde(default)]
    pub interpolation: Interpolation,
    /// Whether the drive adds the torque against gravity.
    #[serde(default)]
    pub gravity_compensation: GravityCompensation,
}

/// Law of a controller. With the error e = q_ref − q (rad, m):
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ControllerKind {
    /// Torque = kp·e + kd·(q̇_ref − q̇).
    Pd,
    /// Torque = kp·e + kd·(q̇_ref − q̇) + ki·∫e dt.
    Pid,
    /// Velocity set point = kp·e (+ q̇_ref); torque = kp_velocity times its error and ki_velocity times that error's integral.
    Cascade,
    /// Hobby servo: torque = torque_per_error·e, cut at ±voltage, less back_emf·q̇.
    DcServo,
}

impl ControllerKind {
    /// Name of the law in the drive file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Pd => "pd",
            Self::Pid => "pid",
            Self::Cascade => "cascade",
            Self::DcServo => "dc_servo",
        }
    }

    /// Keys of the law, the required ones first, and the number of required keys.
    fn keys(self) -> (&'static [Key], usize) {
        match self {
            Self::Pd => (&[Key::Kp, Key::Kd], 1),
            Self::Pid => (&[Key::Kp, Key::Ki, Key::Kd], 2),
            Self::Cascade => (&[Key::Kp, Key::KpVelocity, Key::KiVelocity], 2),
            Self::DcServo => (&[Key::TorquePerError, Key::BackEmf, Key::Voltage], 1),
        }
    }

    /// Whether the law uses a key.
    fn has(self, key: Key) -> bool {
        matches!(key, Key::Limit | Key::Delay) || self.keys().0.contains(&key)
    }
}

impl Controller {
    /// Values of a key, one per joint; none where it is not given.
    pub fn values(&self, key: Key, joints: usize) -> Option<Vec<f64>> {
        self.given(key).map(|values| match values {
            PerJoint::All(value) => vec![*value; joints],
            PerJoint::Each(values) => values.clone(),
        })
    }

    /// Relative tolerance of a key's values.
    pub fn tolerance(&self, key: Key) -> f64 {
        match &self.tolerance {
            Tolerance::All(value) => *value,
            Tolerance::ByKey(values) => values.get(&key).copied().unwrap_or(0.0),
        }
    }

    /// Whether a key's value is not known.
    pub fn is_free(&self, key: Key) -> bool {
        self.free.contains(&key)
    }

    fn given(&self, key: Key) -> Option<&PerJoint> {
        let value = match key {
            Key::Kp => &self.kp,
            Key::Kd => &self.kd,
            Key::Ki => &self.ki,
            Key::KpVelocity => &self.kp_velocity,
            Key::KiVelocity => &self.ki_velocity,
            Key::TorquePerError => &self.torque_per_error,
            Key::BackEmf => &self.back_emf,
            Key::Voltage => &self.voltage,
            Key::Limit => &self.limit,
            Key::Delay => &self.delay,
        };
        value.as_ref()
    }

    /// Checks that every key belongs to the kind, fits the robot and is possible.
    ///
    /// # Errors
    /// It does not, with the key, the joint and what to do.
    pub(in crate::robot::drive) fn check(&self, robot: &impl Driven) -> Result<(), RobotError> {
        let kind = self.kind.name();
        let (own, needed) = self.kind.keys();
        let foreign = |key: Key, place: &str| {
            let own: Vec<&str> = own.iter().map(|k| k.name()).collect();
            refused(format!(
                "{} means nothing to kind = \"{kind}\"{place}; its keys are {}, limit and delay",
                key.name(),
                own.join(", ")
            ))
        };
        for key in Key::ALL {
            match self.given(key) {
                Some(_) if !self.kind.has(key) => return Err(foreign(key, "")),
                Some(values) => self.check_values(key, values, robot)?,
                None if own[..needed].contains(&key) && !self.is_free(key) => {
                    let name = key.name();
                    return Err(refused(format!(
                        "kind = \"{kind}\" needs {name}; give {name} = [...], or free = [\"{name}\"] where nobody knows it"
                    )));
                }
                None => {}
            }
        }
        if let Some(&key) = self.free.iter().find(|k| !self.kind.has(**k)) {
            return Err(foreign(key, " in free"));
        }
        let tolerances = match &self.tolerance {
            Tolerance::All(value) => vec![*value],
            Tolerance::ByKey(values) => {
                if let Some(&key) = values.keys().find(|k| self.given(**k).is_none()) {
                    return Err(refused(format!(
                        "tolerance of {0}, which is not given; give {0}, or name it in free",
                        key.name()
                    )));
                }
                values.values().copied().collect()
            }
        };
        // A value that may be off by more than itself is not known.
        if let Some(value) = tolerances.iter().find(|v| !(0.0..=1.0).contains(*v)) {
            return Err(refused(format!(
                "tolerance is {value}; it is relative, from 0 to 1 (0.3 for thirty per cent); name a value that nobody knows in free"
            )));
        }
        match self.period {
            Some(period) if !(period.is_finite() && period > 0.0) => Err(refused(format!(
                "period is {period}; a positive time in s is needed, or leave it out"
            ))),
            _ => Ok(()),
        }
    }

    fn check_values(
        &self,
        key: Key,
        values: &PerJoint,
        robot: &impl Driven,
    ) -> Result<(), RobotError> {
        let (name, joints) = (key.name(), robot.axes());
        let values = match values {
            PerJoint::All(value) => std::slice::from_ref(value),
            PerJoint::Each(values) if values.len() == joints.len() => values,
            PerJoint::Each(values) => {
                return Err(refused(format!(
                    "{name} has {} values, but {} has {} joints; give one per joint, base first, or one number for all",
                    values.len(),
                    robot.name(),
                    joints.len()
                )));
            }
        };
        let wrong = |v: &f64| !v.is_finite() || *v < 0.0 || (*v == 0.0 && key.positive());
        let Some(at) = values.iter().position(wrong) else {
            return Ok(());
        };
        let what = match (key, values[at]) {
            (Key::Limit, 0.0) => "leave limit out where none is known".to_owned(),
            (Key::Ki, 0.0) => "take kind = \"pd\", or give the value that is set".to_owned(),
            (_, 0.0) => format!(
                "a drive without it does not follow its commands; give the value that is set, or free = [\"{name}\"] where \
                 nobody knows it"
            ),
            _ => "a number that is finite and not negative is needed".to_owned(),
        };
        let place = if values.len() == joints.len() {
            format!(" of joint {:?}", joints[at].name)
        } else {
            String::new()
        };
        Err(refused(format!("{name}{place} is {}; {what}", values[at])))
    }
}

fn refused(reason: String) -> RobotError {
    RobotError::Drive {
        reason: format!("[controller]: {reason}"),
    }
}

#[cfg(test)]
mod tests {
    use super::super::Drive;
    use super::*;
    use crate::robot::Robot;

    fn read(text: &str) -> Result<Controller, RobotError> {
        let robot = Robot::builtin("ur5").expect("built in");
        let drive = Drive::from_toml(&format!("[controller]\n{text}"), &robot)?;
        Ok(drive.controller.expect("the block is there"))
    }

    #[test]
    fn one_number_stands_for_all_joints() {
        let pd = read(
            "kind = \"pd\"\nkp = [80, 120, 120, 80, 80, 80]\nkd = 2.5\ntolerance = { kp = 0.1 }\n\
             free = [\"delay\"]\nperiod = 0.005\ninterpolation = \"linear\"\ngravity_compensation = \"unknown\"",
        )
        .expect("a controller");
        assert_eq!(pd.values(Key::Kp, 6).expect("given")[1], 120.0);
        assert_eq!(pd.values(Key::Kd, 6), Some(vec![2.5; 6]));
        assert_eq!(pd.values(Key::Limit, 6), None);
        assert_eq!((pd.tolerance(Key::Kp), pd.tolerance(Key::Kd)), (0.1, 0.0));
        assert!(pd.is_free(Key::Delay) && !pd.is_free(Key::Kp));
        assert_eq!(pd.interpolation, Interpolation::Linear);
        assert_eq!(pd.gravity_compensation.known(), None);
        let servo = read("kind = \"dc_servo\"\nfree = [\"torque_per_error\"]\ntolerance = 0.3")
            .expect("nothing is known of it");
        assert_eq!(servo.gravity_compensation.known(), Some(false));
        assert_eq!(servo.tolerance(Key::BackEmf), 0.3);
    }

    #[test]
    fn it_is_written_as_it_is_read() {
        let robot = Robot::builtin("ur5").expect("built in");
        for text in [
            "kind = \"cascade\"\nkp = 12\nkp_velocity = [1, 2, 3, 4, 5, 6]\ntolerance = { kp = 0.1 }",
            "kind = \"pid\"\nkp = 12\nki = 3\ngravity_compensation = \"unknown\"",
        ] {
            let text = format!("[controller]\n{text}");
            let drive = Drive::from_toml(&text, &robot).expect("a drive file");
            let written = toml::to_string(&drive).expect("it can be written");
            assert_eq!(Drive::from_toml(&written, &robot).expect(&written), drive);
        }
    }

    #[test]
    fn refusals_say_what_to_do() {
        for (text, expected) in [
            ("kp = 1", "missing field `kind`"),
            ("kind = \"pd2\"", "unknown variant"),
            ("kind = \"pd\"", "needs kp; give kp = [...]"),
            ("kind = \"pid\"\nkp = 1", "needs ki"),
            (
                "kind = \"cascade\"\nkp = 1\nkd = 1\nkp_velocity = 1",
                "kd means nothing to kind = \"cascade\"",
            ),
            (
                "kind = \"pd\"\nkp = 1\nfree = [\"voltage\"]",
                "in free; its keys are kp, kd",
            ),
            (
                "kind = \"pd\"\nkp = 1\nfree = [\"gain\"]",
                "unknown variant",
            ),
            (
                "kind = \"pd\"\nkp = [1, 2]",
                "has 2 values, but ur5 has 6 joints",
            ),
            (
                "kind = \"pd\"\nkp = [1, 0, 1, 1, 1, 1]",
                "kp of joint \"shoulder_lift_joint\" is 0; a drive without it",
            ),
            ("kind = \"pd\"\nkp = 0", "kp is 0; a drive without it"),
            ("kind = \"pid\"\nkp = 1\nki = 0", "take kind = \"pd\""),
            ("kind = \"pd\"\nkp = -1", "not negative"),
            ("kind = \"pd\"\nkp = nan", "finite"),
            (
                "kind = \"pd\"\nkp = \"high\"",
                "a list with one number per joint",
            ),
            ("kind = \"pd\"\nkp = 1\nlimit = 0", "leave limit out"),
            ("kind = \"pd\"\nkp = 1\ndelay = -0.01", "not negative"),
            ("kind = \"pd\"\nkp = 1\nperiod = 0", "a positive time"),
            (
                "kind = \"pd\"\nkp = 1\ntolerance = -0.1",
                "relative, from 0 to 1",
            ),
            (
                "kind = \"pd\"\nkp = 1\ntolerance = { kd = 0.1 }",
                "tolerance of kd, which is not given",
            ),
            ("kind = \"pd\"\nkp = 1\nkv = 1", "unknown field"),
            (
                "kind = \"pd\"\nkp = 1\ngravity_compensation = \"maybe\"",
                "true, false or \"unknown\"",
            ),
        ] {
            let error = read(text).expect_err(text).to_string();
            assert!(error.contains(expected), "{text}: {error}");
        }
    }
}
