//! What is read, and what is said of the rest.

use super::models::{model, pendulum, read};
use physics::robot::{Description, JointKind, Passive, Robot};

#[test]
fn joints_limits_and_drives_are_read() {
    let (_, robot) = model("scara.xml", &[]);
    let kinds: Vec<JointKind> = robot.joints().iter().map(|j| j.kind).collect();
    use JointKind::{Continuous, Prismatic, Revolute};
    assert_eq!(kinds, [Revolute, Revolute, Prismatic, Continuous]);
    let joints = robot.joints();
    assert!((joints[0].limits.upper - 150_f64.to_radians()).abs() < 1e-15);
    assert_eq!(joints[2].limits.upper, 0.2);
    assert_eq!((joints[0].damping, joints[2].rotor_inertia), (0.5, 3.0));
    let (_, robot) = model("seven_axis.xml", &[]);
    let effort: Vec<f64> = robot.joints().iter().map(|j| j.limits.effort).collect();
    assert_eq!(effort, [87.0, 87.0, 87.0, 87.0, 12.0, 12.0, 12.0]);
    let (_, robot) = model("springs.xml", &[]);
    let springs: Vec<usize> = robot.passive().iter().map(Passive::joint).collect();
    assert_eq!(springs, [1, 2, 3]);
    assert_eq!(robot.gravity_compensation()[0], 1.0);
}

/// Nothing is left out without a word.
#[test]
fn what_is_not_chosen_is_said() {
    let notes = |file: &str, chosen: &[&str]| {
        let chosen: Vec<String> = chosen.iter().map(|s| (*s).to_owned()).collect();
        model(file, &chosen).1.notes().join("\n")
    };
    assert_eq!(notes("six_axis.xml", &[]), "");
    let hand = notes("seven_axis.xml", &[]);
    assert!(
        hand.contains("fixed at their reference position: finger_joint1, finger_joint2"),
        "{hand}"
    );
    let free = notes("free_base.xml", &[]);
    assert!(free.contains("reference position: float"), "{free}");
    assert!(
        free.contains("no part of the chosen chain: wheel"),
        "{free}"
    );
    let two = notes("two_arms.xml", &["left_1", "left_2"]);
    assert!(two.contains("reference position: left_3"), "{two}");
    assert!(two.contains("right_1"), "{two}");
    let medium = read(&pendulum("<option density=\"1.2\"/>", "", "")).unwrap();
    assert!(medium.notes()[0].contains("medium"), "{:?}", medium.notes());
    let held = pendulum(
        "",
        "<body name=\"lid\" gravcomp=\"1\"><geom size=\"0.1\"/></body>",
        "",
    );
    let held = read(&held).unwrap();
    assert!(
        held.notes()[0].contains("gravcomp (body"),
        "{:?}",
        held.notes()
    );
}

#[test]
fn flags_switch_forces_off() {
    let flags = |flag: &str| {
        let joint = "<default><joint stiffness=\"3\" damping=\"2\" frictionloss=\"1\"/></default>";
        let option = format!("<option><flag {flag}=\"disable\"/></option>");
        read(&pendulum(&format!("{joint}{option}"), "", "")).unwrap()
    };
    let joint = |r: &Robot| {
        (
            r.joints()[0].damping,
            r.joints()[0].friction,
            r.passive().len(),
        )
    };
    assert_eq!(joint(&flags("contact")), (2.0, 1.0, 1));
    assert_eq!(joint(&flags("damper")), (0.0, 1.0, 1));
    assert_eq!(joint(&flags("spring")), (2.0, 1.0, 0));
    assert_eq!(joint(&flags("frictionloss")), (2.0, 0.0, 1));
    assert_eq!(flags("gravity").gravity().norm(), 0.0);
}

/// Included files are looked for beside the main one; missing and repeated ones are named.
#[test]
fn includes_are_followed() {
    let place = tempfile::tempdir().unwrap();
    let path = |name: &str| place.path().join(name);
    let load = || Description::load(&path("scene.xml"), &[]).map(|(_, robot)| robot);
    std::fs::write(
        path("scene.xml"),
        "<mujoco><include file=\"arm.xml\"/></mujoco>",
    )
    .unwrap();
    let missing = load().expect_err("a file is missing").to_string();
    assert!(
        missing.contains("arm.xml") && missing.contains("scene.xml"),
        "{missing}"
    );
    std::fs::write(path("arm.xml"), pendulum("", "", "")).unwrap();
    assert_eq!(load().expect("a robot").joint_names(), ["hinge"]);
    std::fs::write(
        path("arm.xml"),
        "<mujoco><include file=\"arm.xml\"/></mujoco>",
    )
    .unwrap();
    let twice = load().expect_err("it includes itself").to_string();
    assert!(twice.contains("included twice"), "{twice}");
}
