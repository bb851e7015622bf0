//! New gains, force ranges and delays in the actuators of an MJCF.

use super::actuators::{self, Found, through};
use super::chain::Chain;
use super::edit::Changes;
use super::law::ActuatorKind;
use super::scene::Scene;
use super::write::words;
use crate::robot::{Robot, RobotError};

/// Changes at the drive of one joint, all at the joint: the gear is taken out when they are written. A value that is
/// `None` stays as it is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DriveEdit {
    /// Torque per error of position, N·m/rad (N/m).
    pub kp: Option<f64>,
    /// Torque per velocity, N·m·s/rad (N·s/m).
    pub kv: Option<f64>,
    /// Range of the torque, N·m (N).
    pub force: Option<[f64; 2]>,
    /// Delay with which the control of a servo of position reaches it, s.
    pub delay: Option<f64>,
}

/// Shortest time step for which a written delay is kept whole, s: MuJoCo keeps controls by number, not by time.
const SHORTEST: f64 = 1e-3;

/// Writes `drives`, one per chosen joint, to the actuators' own elements; defaults stay as they are.
pub(super) fn changes(
    scene: &Scene<'_, '_, '_>,
    chain: &Chain,
    drives: &[DriveEdit],
    changes: &mut Changes,
) -> Result<(), RobotError> {
    if drives.len() != chain.joints.len() {
        return Err(RobotError::WrongLength {
            what: "drives",
            expected: chain.joints.len(),
            found: drives.len(),
        });
    }
    let found = actuators::read(scene, chain)?;
    for ((found, edit), joint) in found.iter().zip(drives).zip(&chain.joints) {
        let joint = &scene.joints[*joint].name;
        match found {
            Some(found) if found.actuator.gear != 0.0 => {
                gains(found, edit, joint, changes)?;
                if let Some(range) = edit.force {
                    force(found, through(range, 1.0 / found.actuator.gear), changes);
                }
                if let Some(seconds) = edit.delay {
                    delay(found, seconds, scene.settings.step, changes);
                }
            }
            _ if *edit == DriveEdit::default() => {}
            Some(_) => changes.left_out.push(format!(
                "drive of joint {joint}: its actuator has the gear 0 and moves nothing"
            )),
            None => changes.left_out.push(format!(
                "drive of joint {joint}: the model has no actuator for it; add <position joint=\"{joint}\"/>"
            )),
        }
    }
    Ok(())
}

/// Makes dry friction hold a joint. MuJoCo's own sets in over 10 ms, through which a light joint creeps under its load.
/// MuJoCo raises the time constant written here to twice its step; 0.9999 is the largest impedance that it takes.
pub(super) fn holding_friction(
    scene: &Scene<'_, '_, '_>,
    chain: &Chain,
    robot: &Robot,
    changes: &mut Changes,
) {
    for (joint, own) in robot.joints().iter().zip(&chain.joints) {
        if joint.friction > 0.0 {
            let element = scene.joints[*own].attributes.element;
            changes.set(element, "solreffriction", "0.001 1");
            changes.set(element, "solimpfriction", "0.9999 0.9999");
        }
    }
}

fn gains(
    found: &Found<'_, '_, '_>,
    edit: &DriveEdit,
    joint: &str,
    changes: &mut Changes,
) -> Result<(), RobotError> {
    let (element, square) = (found.attributes.element, found.actuator.gear.powi(2));
    let [kp, kv] = [edit.kp, edit.kv].map(|gain| gain.map(|g| g / square));
    match found.actuator.kind {
        ActuatorKind::Position {
            kp: old,
            kv: damping,
        } => {
            if let Some(kp) = kp.filter(|kp| *kp != old) {
                changes.set(element, "kp", &kp.to_string());
            }
            // A damping ratio would follow the new gain and inertias: kv stands in its place.
            let new = kv.unwrap_or(damping);
            if new != damping || found.by_ratio {
                let own = found.attributes.own("dampratio");
                if own {
                    changes.replace(element, "dampratio", "kv", &new.to_string());
                } else {
                    changes.set(element, "kv", &new.to_string());
                }
            }
        }
        ActuatorKind::Pd {
            kp: old,
            kv: damping,
        } => {
            let new = [kp.unwrap_or(old), kv.unwrap_or(damping)];
            if new != [old, damping] || found.by_ratio {
                let mut gain = found.attributes.list("gainprm")?.unwrap_or_default();
                gain.resize(gain.len().max(1), 0.0);
                gain[0] = new[0];
                let mut bias = found.attributes.list("biasprm")?.unwrap_or_default();
                bias.resize(bias.len().max(3), 0.0);
                bias[1..3].copy_from_slice(&new.map(|v| -v));
                changes.set(element, "gainprm", &words(&gain));
                changes.set(element, "biasprm", &words(&bias));
            }
        }
        ActuatorKind::Velocity { kv: old } if edit.kp.is_none() && element.tag() == "velocity" => {
            if let Some(kv) = kv.filter(|kv| *kv != old) {
                changes.set(element, "kv", &kv.to_string());
            }
        }
        ref kind => {
            let what = match kind {
                ActuatorKind::Motor => "motor",
                ActuatorKind::Velocity { .. } => "servo of velocity",
                ActuatorKind::Other(words) => words,
                ActuatorKind::Position { .. } | ActuatorKind::Pd { .. } => "servo",
            };
            for (name, value) in [("kp", edit.kp), ("kv", edit.kv)] {
                if let Some(value) = value {
                    changes.left_out.push(format!(
                        "{name} = {value} of joint {joint}: its actuator {:?}, a {what}, holds none; what computes its control has to",
                        found.actuator.name
                    ));
                }
            }
        }
    }
    Ok(())
}

/// Writes the delay of the actuator's control, s. MuJoCo takes it from past controls: from the line through them where
/// `interp` says so, or else the next whole step is taken. `step` is the file's time step, s.
fn delay(found: &Found<'_, '_, '_>, seconds: f64, step: f64, changes: &mut Changes) {
    if found.actuator.delay.unwrap_or(0.0) == seconds {
        return;
    }
    let kept = (seconds / step.min(SHORTEST)).ceil() + 1.0;
    let element = found.attributes.element;
    changes.set(element, "delay", &seconds.to_string());
    changes.set(element, "nsample", &kept.to_string());
    changes.set(element, "interp", "linear");
}

/// Writes the range of the actuator's force; that of a motor where it has it, in its control.
fn force(found: &Found<'_, '_, '_>, range: [f64; 2], changes: &mut Changes) {
    let actuator = &found.actuator;
    let by_control = actuator.kind == ActuatorKind::Motor && actuator.control.is_some();
    let mut put = |old: Option<[f64; 2]>, limited: &str, name: &str| {
        if old == Some(range) {
            return;
        }
        let element = found.attributes.element;
        changes.set(element, name, &words(&range));
        if old.is_none() {
            changes.set(element, limited, "true");
        }
    };
    if by_control {
        put(actuator.control, "ctrllimited", "ctrlrange");
    }
    if !by_control || actuator.force.is_some() {
        put(actuator.force, "forcelimited", "forcerange");
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Actuator, Edited, Mjcf};
    use super::*;
    use std::path::Path;

    /// As the SO-101's makers have it: gains in a class, ranges at the actuators.
    const SERVOS: &str = r#"<mujoco><compiler angle="radian" autolimits="true"/><default><default class="sts3215">
        <joint damping="0.60" frictionloss="0.052" armature="0.028"/>
        <position kp="998.22" kv="2.731" forcerange="-2.94 2.94"/></default></default>
        <worldbody><body><joint name="pan" axis="0 0 1" class="sts3215"/><inertial mass="1" pos="0 0 0" diaginertia="1 1 1"/>
        <body><joint name="lift" axis="0 1 0" class="sts3215"/><inertial mass="1" pos="0 0 1" diaginertia="1 1 1"/>
        </body></body></worldbody><actuator>
        <position class="sts3215" name="p" joint="pan" forcerange="-3.35 3.35" ctrlrange="-1.9 1.9"/>
        <position class="sts3215" name="l" joint="lift" gear="2"/></actuator></mujoco>"#;

    fn edited(text: &str, drives: &[DriveEdit]) -> (Edited, String) {
        let mjcf = Mjcf::from_text(text, &[]).expect("an MJCF");
        let robot = mjcf.robot().expect("a robot");
        let edited = mjcf.with_drives(&robot, &[], drives).expect("drives");
        let files = edited.files(Path::new("out.xml")).expect("files");
        (edited, files[0].1.clone())
    }

    fn actuators(text: &str) -> Vec<Option<Actuator>> {
        Mjcf::from_text(text, &[])
            .and_then(|m| m.actuators())
            .expect(text)
    }

    fn drive(kp: f64, kv: f64, force: f64) -> DriveEdit {
        DriveEdit {
            kp: Some(kp),
            kv: Some(kv),
            force: Some([-force, force]),
            delay: None,
        }
    }

    #[test]
    fn gains_of_a_class_are_set_at_the_actuators() {
        let given = actuators(SERVOS);
        let servo = given[0].as_ref().expect("an actuator");
        assert_eq!(
            servo.kind,
            ActuatorKind::Position {
                kp: 998.22,
                kv: 2.731
            }
        );
        assert_eq!(servo.effort(), Some([-3.35, 3.35]));
        let (edit, text) = edited(SERVOS, &[drive(13.5, 0.25, 1.5), drive(17.0, 0.5, 6.0)]);
        assert_eq!(edit.left_out(), &[] as &[String]);
        assert!(
            text.contains(r#"<position kp="998.22" kv="2.731" forcerange="-2.94 2.94"/>"#),
            "{text}"
        );
        for (found, (gains, force)) in actuators(&text)
            .iter()
            .zip([([13.5, 0.25], 1.5), ([17.0, 0.5], 6.0)])
        {
            let found = found.as_ref().expect("an actuator");
            assert_eq!(
                (found.gains(), found.effort()),
                (Some(gains), Some([-force, force]))
            );
        }
        assert!(
            text.contains(r#"forcerange="-1.5 1.5" ctrlrange="-1.9 1.9" kp="13.5" kv="0.25"/>"#),
            "{text}"
        );
        assert!(
            text.contains(r#"gear="2" kp="4.25" kv="0.125" forcerange="-3 3"/>"#),
            "{text}"
        );
        let holds = r#" class="sts3215" solreffriction="0.001 1" solimpfriction="0.9999 0.9999"/>"#;
        let friction = SERVOS.replace(r#"0 1" class="sts3215"/>"#, &format!(r#"0 1"{holds}"#));
        let friction = friction.replace(r#"1 0" class="sts3215"/>"#, &format!(r#"1 0"{holds}"#));
        let (_, same) = edited(SERVOS, &[DriveEdit::default(); 2]);
        assert_eq!(same, friction);
    }

    #[test]
    fn joints_and_drives_change_in_one_file() {
        let mjcf = Mjcf::from_text(SERVOS, &[]).expect("an MJCF");
        let robot = mjcf
            .robot()
            .expect("a robot")
            .with_rotor_inertia(&[0.01, 0.02])
            .expect("two");
        let edited = mjcf
            .with_drives(&robot, &[], &[drive(13.5, 0.0, 2.0); 2])
            .expect("drives");
        let text = &edited.files(Path::new("out.xml")).expect("files")[0].1;
        let again = Mjcf::from_text(text, &[]).expect("an MJCF");
        assert_eq!(
            again.robot().expect("a robot").joints()[1].rotor_inertia,
            0.02
        );
        assert_eq!(
            again.actuators().expect("two")[1]
                .as_ref()
                .and_then(Actuator::gains),
            Some([13.5, 0.0])
        );
        let one = mjcf.with_drives(&robot, &[], &[DriveEdit::default()]);
        assert!(
            one.expect_err("one of two")
                .to_string()
                .contains("drives: 1 values")
        );
    }

    #[test]
    fn each_law_has_its_own_attributes() {
        let with = |actuator: &str| {
            format!(
                r#"<mujoco><worldbody><body><joint name="a"/><inertial mass="1" pos="1 0 0" diaginertia="1 1 1"/></body>
                </worldbody><actuator>{actuator}</actuator></mujoco>"#
            )
        };
        for (given, written) in [
            (
                r#"<general joint="a" gainprm="20 0 0" biasprm="0 -20 -2" biastype="affine"/>"#,
                r#"<general joint="a" gainprm="5 0 0" biasprm="0 -5 -1" biastype="affine" forcerange="-3 3" forcelimited="true"/>"#,
            ),
            (
                r#"<position joint="a" kp="20" dampratio="1"/>"#,
                r#"<position joint="a" kp="5" kv="1" forcerange="-3 3" forcelimited="true"/>"#,
            ),
            (
                r#"<position joint="a" forcerange="-9 9" forcelimited="false"/>"#,
                r#"<position joint="a" forcerange="-3 3" forcelimited="true" kp="5" kv="1"/>"#,
            ),
        ] {
            let (edit, text) = edited(&with(given), &[drive(5.0, 1.0, 3.0)]);
            assert_eq!((text, edit.left_out()), (with(written), &[] as &[String]));
        }
    }

    /// MuJoCo 4.0 loads these attributes and delays by them (`python/tests/test_verify_replay.py`).
    #[test]
    fn a_delay_keeps_enough_controls() {
        let late = |delay: f64| DriveEdit {
            delay: Some(delay),
            ..DriveEdit::default()
        };
        let (edit, text) = edited(SERVOS, &[late(0.0154), late(0.0)]);
        assert_eq!(edit.left_out(), &[] as &[String]);
        assert!(
            text.contains(r#"ctrlrange="-1.9 1.9" delay="0.0154" nsample="17" interp="linear"/>"#),
            "{text}"
        );
        let read = actuators(&text);
        let delays = read.iter().flatten().map(|a| a.delay);
        assert_eq!(delays.collect::<Vec<_>>(), [Some(0.0154), None]);
        // Of a file that has one already, and a finer step.
        let fine = text.replace("<default>", r#"<option timestep="0.0005"/><default>"#);
        let (_, text) = edited(&fine, &[late(0.01), late(0.0)]);
        assert!(
            text.contains(r#"delay="0.01" nsample="21" interp="linear"/>"#),
            "{text}"
        );
    }

    /// As the Z1's authors have it: motors, whose limits are those of their controls.
    #[test]
    fn a_motor_holds_no_gains() {
        let text = r#"<mujoco><worldbody><body><joint name="a"/><inertial mass="1" pos="1 0 0" diaginertia="1 1 1"/>
            <body><joint name="b" axis="0 1 0"/><inertial mass="1" pos="1 0 0" diaginertia="1 1 1"/></body></body></worldbody>
            <actuator><motor name="motor1" joint="a" ctrlrange="-30.0 30.0"/></actuator></mujoco>"#;
        let named = ["a", "b"].map(str::to_owned);
        let mjcf = Mjcf::from_text(text, &named).expect("an MJCF");
        assert!(mjcf.actuators().expect("one")[1].is_none());
        let robot = mjcf.robot().expect("a robot");
        let edits = [drive(80.0, 2.5, 20.0), drive(1.0, 1.0, 1.0)];
        let edited = mjcf.with_drives(&robot, &[], &edits).expect("drives");
        let said = edited.left_out();
        assert_eq!(said.len(), 3, "{said:?}");
        assert!(said[0].contains("kp = 80 of joint a") && said[0].contains("a motor, holds none"));
        assert!(said[2].contains("no actuator for it"), "{said:?}");
        let files = edited.files(Path::new("out.xml")).expect("files");
        assert!(
            files[0].1.contains(r#"joint="a" ctrlrange="-20 20"/>"#),
            "{}",
            files[0].1
        );
    }
}
