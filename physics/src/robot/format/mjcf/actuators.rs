//! Actuators of the chosen joints.

use super::apparent;
use super::attributes::Attributes;
use super::chain::Chain;
use super::couplings;
use super::law::{ActuatorKind, first, law};
use super::refusal::refused;
use super::scene::Scene;
use crate::robot::{Robot, RobotError};

/// Actuator of one joint with the values of the file, class defaults included. Gains and forces are those of the actuator; at
/// the joint gains are multiplied by the square of the gear, forces by the gear.
#[derive(Clone, Debug, PartialEq)]
pub struct Actuator {
    /// Name of the actuator; without one, that of its joint.
    pub name: String,
    /// Law of the actuator's force.
    pub kind: ActuatorKind,
    /// Joint force per force of the actuator. A control is compared with `gear` times the joint's position.
    pub gear: f64,
    /// Range of the actuator's force, N·m (N); none where it is not limited.
    pub force: Option<[f64; 2]>,
    /// Range of the actuator's control: rad (m) for position servos, N·m (N) for motors; none where it is not limited.
    pub control: Option<[f64; 2]>,
    /// Time constant by which the actuator smooths its control, s.
    pub lag: Option<f64>,
    /// Delay with which the control reaches the actuator, s.
    pub delay: Option<f64>,
}

impl Actuator {
    /// Gains at the joint, N·m/rad and N·m·s/rad (N/m and N·s/m); none where it does not servo a position.
    pub fn gains(&self) -> Option<[f64; 2]> {
        let square = self.gear * self.gear;
        match self.kind {
            ActuatorKind::Position { kp, kv } | ActuatorKind::Pd { kp, kv } => {
                Some([kp * square, kv * square])
            }
            _ => None,
        }
    }

    /// Range of its force at the joint, N·m (N): that of the force, and of a motor that of the control, too.
    pub fn effort(&self) -> Option<[f64; 2]> {
        let motor = self.control.filter(|_| self.kind == ActuatorKind::Motor);
        let both = match (self.force, motor) {
            (Some(a), Some(b)) => Some([a[0].max(b[0]), a[1].min(b[1])]),
            (one, other) => one.or(other),
        };
        both.map(|range| through(range, self.gear))
    }
}

/// A range times a factor, the lower end first.
pub(super) fn through(range: [f64; 2], factor: f64) -> [f64; 2] {
    let [a, b] = range.map(|v| v * factor);
    [a.min(b), a.max(b)]
}

/// An actuator and the element that it stands in.
pub(super) struct Found<'c, 'd, 't> {
    pub attributes: Attributes<'c, 'd, 't>,
    pub actuator: Actuator,
    /// Whether the servo's kv follows from a damping ratio, and so from the model's inertias.
    pub by_ratio: bool,
}

/// The actuator of each chosen joint; none where nothing drives it.
pub(super) fn read<'c, 'd, 't>(
    scene: &Scene<'c, 'd, 't>,
    chain: &Chain,
) -> Result<Vec<Option<Found<'c, 'd, 't>>>, RobotError> {
    let mut found: Vec<Option<Found<'c, 'd, 't>>> = chain.joints.iter().map(|_| None).collect();
    let robot = chain.robot(scene)?;
    for own in couplings::actuators(scene)? {
        let (a, Some(driven)) = (own.attributes, own.joint) else {
            continue;
        };
        let Some(link) = chain.joints.iter().position(|j| *j == driven) else {
            continue;
        };
        let joint = &scene.joints[driven].name;
        if let Some(first) = &found[link] {
            return Err(refused(format!(
                "actuators {:?} and {:?} both drive joint {joint:?}, and no one law stands for two; leave one, for a servo \
                 <position kp=\"…\" kv=\"…\">",
                first.actuator.name,
                name(&a, joint)
            )));
        }
        found[link] = Some(one(scene, chain, &robot, link, a)?);
    }
    Ok(found)
}

fn name(a: &Attributes<'_, '_, '_>, joint: &str) -> String {
    a.element.get("name").unwrap_or(joint).to_owned()
}

fn one<'c, 'd, 't>(
    scene: &Scene<'c, 'd, 't>,
    chain: &Chain,
    robot: &Robot,
    link: usize,
    a: Attributes<'c, 'd, 't>,
) -> Result<Found<'c, 'd, 't>, RobotError> {
    let auto = scene.settings.autolimits;
    let gear = first(&a, "gear")?.unwrap_or(1.0);
    let (mut kind, lag) = law(&a)?;
    let mut by_ratio = false;
    if let ActuatorKind::Position { kp, kv } | ActuatorKind::Pd { kp, kv } = &mut kind
        && *kv < 0.0
    {
        // A damping ratio r stands for kv = 2 r √(kp m), m the inertia that the joint meets over the gear's square.
        let mass = apparent::inertias(scene, chain, robot)?[link] / (gear * gear);
        *kv = -2.0 * *kv * (*kp * mass).sqrt();
        by_ratio = true;
    }
    let limits = &robot.joints()[link].limits;
    let mut control = a.range("ctrllimited", "ctrlrange", auto)?;
    if let Some(part) = a.number("inheritrange")?.filter(|part| *part > 0.0)
        && limits.lower.is_finite()
        && limits.upper.is_finite()
    {
        let [middle, half] = [1.0, -1.0].map(|sign| 0.5 * (limits.upper + sign * limits.lower));
        control = Some([middle - part * half, middle + part * half]);
    }
    let positive = |name: &str| Ok::<_, RobotError>(a.number(name)?.filter(|v| *v > 0.0));
    Ok(Found {
        actuator: Actuator {
            name: name(&a, &scene.joints[chain.joints[link]].name),
            kind,
            gear,
            force: a.range("forcelimited", "forcerange", auto)?,
            control,
            lag,
            delay: positive("delay")?,
        },
        attributes: a,
        by_ratio,
    })
}

#[cfg(test)]
mod tests {
    use super::super::Mjcf;
    use super::*;

    /// One joint, `actuator` on it; defaults in front.
    fn read(defaults: &str, actuator: &str) -> Result<Actuator, RobotError> {
        let text = format!(
            r#"<mujoco><compiler angle="radian"/>{defaults}<worldbody><body><joint name="a" axis="0 1 0" armature="0.02"
            range="-1 2"/><inertial mass="2" pos="0.2 0 0" diaginertia="0.008 0.008 0.008"/></body></worldbody>
            <actuator>{actuator}</actuator></mujoco>"#
        );
        let mut all = Mjcf::from_text(&text, &[])?.actuators()?;
        Ok(all.remove(0).expect("an actuator"))
    }

    const CLASS: &str =
        r#"<default><default class="s"><position kp="50" kv="2"/></default></default>"#;

    /// What MuJoCo 4.0.0 compiles of the same texts (`actuator_gainprm`, `actuator_biasprm`).
    #[test]
    fn gains_are_mujocos() {
        let ratio =
            r#"<default><default class="s"><position kp="50" dampratio="2"/></default></default>"#;
        let general = r#"<default><default class="s"><general gainprm="50" biasprm="0 -50 -2" biastype="affine"/></default></default>"#;
        for (defaults, text, kp, kv) in [
            ("", r#"<position joint="a"/>"#, 1.0, 0.0),
            ("", r#"<position joint="a" kp="20" kv="3"/>"#, 20.0, 3.0),
            (
                "",
                r#"<position joint="a" kp="20" dampratio="1"/>"#,
                20.0,
                2.939_387_69,
            ),
            (
                "",
                r#"<position joint="a" kp="20" dampratio="1" gear="2"/>"#,
                20.0,
                1.469_693_85,
            ),
            (
                "",
                r#"<position joint="a" kp="20" dampratio="1" armature="0.1"/>"#,
                20.0,
                4.079_215_61,
            ),
            (CLASS, r#"<position joint="a" class="s"/>"#, 50.0, 2.0),
            (CLASS, r#"<position joint="a" class="s" kp="5"/>"#, 5.0, 2.0),
            (CLASS, r#"<general joint="a" class="s"/>"#, 50.0, 2.0),
            (
                general,
                r#"<position joint="a" class="s" kp="5"/>"#,
                5.0,
                2.0,
            ),
            (
                general,
                r#"<general joint="a" class="s" gainprm="20" biasprm="0 -20"/>"#,
                20.0,
                2.0,
            ),
            (
                ratio,
                r#"<position joint="a" class="s" kv="7"/>"#,
                50.0,
                7.0,
            ),
            (
                "",
                r#"<general joint="a" gainprm="20" biasprm="0 -20 2" biastype="affine"/>"#,
                20.0,
                5.878_775_38,
            ),
        ] {
            let found = read(defaults, text).expect(text);
            let (ActuatorKind::Position { kp: p, kv: v } | ActuatorKind::Pd { kp: p, kv: v }) =
                found.kind
            else {
                panic!("{text}: {found:?}");
            };
            assert_eq!(p, kp, "{text}");
            assert!((v - kv).abs() < 1e-8, "{text}: {v}, MuJoCo has {kv}");
        }
    }

    #[test]
    fn other_laws_are_told_apart() {
        for (defaults, text, kind) in [
            (
                CLASS,
                r#"<motor joint="a" class="s"/>"#,
                ActuatorKind::Motor,
            ),
            ("", r#"<general joint="a"/>"#, ActuatorKind::Motor),
            (
                "",
                r#"<velocity joint="a" kv="3"/>"#,
                ActuatorKind::Velocity { kv: 3.0 },
            ),
            (
                CLASS,
                r#"<velocity joint="a" class="s"/>"#,
                ActuatorKind::Velocity { kv: 1.0 },
            ),
            (
                "",
                r#"<general joint="a" gainprm="3" biasprm="0 0 -3" biastype="affine"/>"#,
                ActuatorKind::Velocity { kv: 3.0 },
            ),
        ] {
            assert_eq!(read(defaults, text).expect(text).kind, kind, "{text}");
        }
        for (text, words) in [
            (
                r#"<general joint="a" gainprm="20" biasprm="0 -20 -2"/>"#,
                "gain 20",
            ),
            (
                r#"<general joint="a" dyntype="integrator"/>"#,
                "dyntype integrator",
            ),
            (r#"<intvelocity joint="a" kp="3"/>"#, "<intvelocity>"),
        ] {
            let kind = read("", text).expect(text).kind;
            assert!(
                matches!(&kind, ActuatorKind::Other(w) if w.contains(words)),
                "{kind:?}"
            );
        }
    }

    #[test]
    fn ranges_and_times_are_read() {
        let servo = r#"<position joint="a" kp="4" forcerange="-3 2" ctrlrange="-1 1" gear="-2" timeconst="0.1"
            delay="0.01" nsample="9"/>"#;
        let servo = read("", servo).expect("an actuator");
        assert_eq!((servo.name.as_str(), servo.gear), ("a", -2.0));
        assert_eq!(
            (servo.force, servo.control),
            (Some([-3.0, 2.0]), Some([-1.0, 1.0]))
        );
        assert_eq!((servo.lag, servo.delay), (Some(0.1), Some(0.01)));
        assert_eq!(
            (servo.gains(), servo.effort()),
            (Some([16.0, 0.0]), Some([-4.0, 6.0]))
        );
        let motor = r#"<motor name="m" joint="a" ctrlrange="-30 30" forcerange="-60 20"/>"#;
        let motor = read("", motor).expect("an actuator");
        assert_eq!((motor.effort(), motor.gains()), (Some([-30.0, 20.0]), None));
        let free = r#"<motor joint="a" ctrlrange="-30 30" ctrllimited="false"/>"#;
        assert_eq!(read("", free).expect("an actuator").effort(), None);
        let inherits =
            read("", r#"<position joint="a" inheritrange="0.5"/>"#).expect("an actuator");
        assert_eq!(inherits.control, Some([-0.25, 1.25]));
    }

    /// What MuJoCo 4.0.0 makes of damping ratios of joints that carry each other (`actuator_biasprm`).
    #[test]
    fn a_damping_ratio_meets_what_the_other_joints_yield() {
        let text = r#"<mujoco><compiler angle="radian"/><worldbody><body>
            <joint name="a" axis="0 1 0"/><inertial mass="2" pos="0.2 0 0" diaginertia="0.008 0.008 0.008"/>
            <body pos="0.4 0 0"><joint name="b" axis="0 1 0" ref="0.5"/>
            <inertial mass="1" pos="0.3 0 0.1" diaginertia="0.004 0.005 0.006"/>
            <body pos="0.5 0 0"><joint name="c" type="slide" axis="0 0 1" ref="0.2"/>
            <inertial mass="0.5" pos="0 0 0" diaginertia="0.001 0.001 0.001"/></body></body></body></worldbody>
            <actuator><position joint="a" kp="25" dampratio="1"/><position joint="b" kp="25" dampratio="1"/>
            <position joint="c" kp="25" dampratio="1"/></actuator></mujoco>"#;
        let all = Mjcf::from_text(text, &[])
            .and_then(|m| m.actuators())
            .expect("three");
        let kv = all.iter().flatten().map(|a| a.gains().expect("a servo")[1]);
        for (kv, theirs) in kv.zip([3.348_894_5, 1.414_689_65, 4.660_342_87]) {
            assert!((kv - theirs).abs() < 1e-8, "{kv}, MuJoCo has {theirs}");
        }
    }

    #[test]
    fn two_actuators_at_one_joint_are_refused() {
        let error = read(
            "",
            r#"<position name="p" joint="a"/><velocity name="v" joint="a"/>"#,
        );
        let error = error.expect_err("two").to_string();
        assert!(
            error.contains("\"p\" and \"v\" both drive joint \"a\""),
            "{error}"
        );
    }
}
