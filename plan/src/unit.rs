//! Units in which a drive is sent torque.

use clap::ValueEnum;
use physics::robot::drive::{Drive, TorqueUnit};
use physics::robot::{Robot, RobotError};

/// Unit of a torque that is sent.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
#[value(rename_all = "snake_case")]
pub enum Unit {
    /// N·m or N at the joint.
    Nm,
    /// Current of the motor, A.
    Ampere,
    /// Per mille of the motor's rated torque.
    PerMille,
}

/// Whose signs a plan and its torque have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Convention {
    /// Those of the recorded columns, by the drive file's `direction` and `torque_scale`.
    Drive,
    /// Those of the robot's description.
    Joint,
}

impl Unit {
    /// Divisor of each joint's torque for the conversion to this unit. In the drive's convention direction and torque scale of
    /// the drive file are included, so that a sent torque reads as a recorded one does.
    ///
    /// # Errors
    /// The drive file lacks what the conversion needs.
    pub fn divisors(
        self,
        drive: Option<&Drive>,
        robot: &Robot,
        convention: Convention,
    ) -> Result<Vec<f64>, RobotError> {
        let torque = match self {
            Self::Nm if convention == Convention::Joint => return Ok(vec![1.0; robot.dof()]),
            Self::Nm => TorqueUnit::Link,
            Self::Ampere => TorqueUnit::Current,
            Self::PerMille => TorqueUnit::Rated,
        };
        let mut drive = drive.cloned().unwrap_or_default();
        drive.units.torque = torque;
        let conversions = drive.torque_conversion(robot)?;
        let divisor = |scale: f64| match convention {
            Convention::Drive => scale,
            Convention::Joint => scale.abs(),
        };
        Ok(conversions.iter().map(|c| divisor(c.scale)).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn by_hand() {
        let robot = Robot::builtin("ur5").unwrap();
        let text = "gear_ratio = [100, 100, 100, 100, 100, 100]\ntorque_constant = [0.1, 0.1, 0.1, 0.1, 0.1, 0.1]\n\
                    rated_current = [4, 4, 4, 2, 2, 2]\ndirection = [1, -1, 1, 1, 1, 1]";
        let drive = Drive::from_toml(text, &robot).unwrap();
        let of = |unit: Unit| {
            let divisors = unit.divisors(Some(&drive), &robot, Convention::Drive);
            divisors.unwrap()
        };
        // 10 N·m per ampere at the joint; a rated torque of 40 N·m, 0.04 of it per mille.
        let close = |a: &[f64], b: &[f64]| std::iter::zip(a, b).all(|(a, b)| (a - b).abs() < 1e-12);
        assert!(close(
            &of(Unit::Ampere),
            &[10.0, -10.0, 10.0, 10.0, 10.0, 10.0]
        ));
        assert!(close(
            &of(Unit::PerMille),
            &[0.04, -0.04, 0.04, 0.02, 0.02, 0.02]
        ));
        assert_eq!(of(Unit::Nm), [1.0, -1.0, 1.0, 1.0, 1.0, 1.0]);
        // In the joint's convention a positive torque drives the joint forwards.
        let joint = |unit: Unit| unit.divisors(Some(&drive), &robot, Convention::Joint);
        assert!(close(&joint(Unit::Ampere).unwrap(), &[10.0; 6]));
        assert_eq!(joint(Unit::Nm).unwrap(), [1.0; 6]);
        // This robot knows its gears and motors, and no rated current.
        assert!(
            Unit::PerMille
                .divisors(None, &robot, Convention::Drive)
                .is_err()
        );
    }
}
