//! Conversion of a recording's numbers to SI units on the link side.

use super::units::{AngleUnit, TimeUnit, TorqueUnit};
use super::{Drive, Driven};
use crate::robot::RobotError;
use std::f64::consts::TAU;

/// Recorded value to SI on the link side: value · `scale` + `offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conversion {
    /// Factor on the recorded value, to the SI unit on the link side.
    pub scale: f64,
    /// Offset that is added after scaling, SI unit.
    pub offset: f64,
}

impl Drive {
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
                            "units.torque = {:?} needs the {name} of joint {:?}; give {name} = [...], or leave units.torque out and give \
                             torque_scale = [...], N·m (N) at the joint per recorded unit",
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
    use super::super::DrivenAxis;
    use super::*;
    use crate::robot::Robot;

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
}
