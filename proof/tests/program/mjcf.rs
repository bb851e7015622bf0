//! A robot in MuJoCo's format: the same diagnosis as of a URDF, and a corrected model that is the user's own file.

use crate::case::{Case, causes, json, recording, rubbing};

/// The pendulum of `case.rs`, in a scene.
const MJCF: &str = r#"<mujoco model="arm">
  <compiler angle="radian"/>
  <!-- Numbers of the data sheet. -->
  <default>
    <default class="drive"><joint damping="0.4" frictionloss="0.3"/></default>
  </default>
  <worldbody>
    <geom type="plane" size="1 1 0.1"/>
    <body name="l1">
      <inertial pos="0.1 0 0" mass="1" diaginertia="0.01 0.01 0.01"/>
      <joint name="j1" class="drive" axis="0 1 0" range="-2 2"/>
    </body>
    <body name="cup" pos="1 0 0"><freejoint name="loose"/><geom size="0.05" mass="0.1"/></body>
  </worldbody>
</mujoco>
"#;

/// Friction other than the model's: 0.9 N·m·s/rad and 0.6 N·m.
fn case() -> Case {
    let friction = |qd: f64| 0.9 * qd + 0.6 * qd.signum();
    let case = Case::new(
        &rubbing(friction, 0.0, 6, 1500),
        &rubbing(friction, 0.45, 6, 1500),
    );
    case.write("arm.xml", MJCF);
    case
}

#[test]
fn a_diagnosis_is_that_of_the_same_robot_as_a_urdf() {
    let case = Case::new(&recording(0.25, 0.0), &recording(0.25, 0.45));
    case.write("arm.xml", MJCF);
    let report = |robot: &str, name: &str| {
        let file = format!("@{name}");
        let out = case.diagnose(&["--robot", robot], &["--fast", "--json", &file]);
        let said = String::from_utf8_lossy(&out.stderr);
        assert_eq!(out.status.code(), Some(0), "{said}");
        json(&case.path(name))
    };
    let (mut urdf, mut mjcf) = (report("@arm.urdf", "u.json"), report("@arm.xml", "m.json"));
    let notes = mjcf["notes"].to_string();
    assert!(
        notes.contains("no part of the chosen chain: loose"),
        "{notes}"
    );
    assert_eq!(causes(&mjcf), ["nonlinear_viscous_friction"]);
    for report in [&mut urdf, &mut mjcf] {
        report["notes"].take();
    }
    assert_eq!(urdf, mjcf);
}

#[test]
fn a_patch_is_the_whole_file_with_the_changed_attributes() {
    let case = case();
    let out = case.diagnose(
        &["--robot", "@arm.xml"],
        &[
            "--fast",
            "--json",
            "@r.json",
            "--patch",
            "@fixed.xml",
            "--out",
            "@model",
        ],
    );
    let said = String::from_utf8_lossy(&out.stdout);
    assert_eq!(out.status.code(), Some(0), "{said}");
    assert!(said.contains("in the MJCF: friction_parameters"), "{said}");
    assert_eq!(causes(&json(&case.path("r.json"))), ["friction_parameters"]);
    let fixed = std::fs::read_to_string(case.path("fixed.xml")).unwrap();
    let differ: Vec<(&str, &str)> = MJCF
        .lines()
        .zip(fixed.lines())
        .filter(|(a, b)| a != b)
        .collect();
    assert_eq!(MJCF.lines().count(), fixed.lines().count());
    assert!(
        differ
            .iter()
            .all(|(old, _)| old.contains("<joint name=") || old.contains("<inertial")),
        "{differ:?}"
    );
    assert!(fixed.contains("<!-- Numbers of the data sheet. -->"));
    assert!(case.path("fixed.values.tsv").exists() && !case.path("fixed.mjcf.xml").exists());
    assert!(case.path("model/identified.urdf").exists());
    let again = case.diagnose(&["--robot", "@fixed.xml"], &["--fast", "--json", "@s.json"]);
    assert_eq!(again.status.code(), Some(0));
    let again = json(&case.path("s.json"));
    assert_eq!(again["verdict"], "no_gap", "{}", again["ladder"]);
}

#[test]
fn what_cannot_be_used_is_refused_with_a_hint() {
    let case = case();
    let refused = |name: &str, text: &str, more: &[&str], expected: &str| {
        case.write(name, text);
        let file = format!("@{name}");
        let out = case.diagnose(&["--robot", &file], more);
        let said = String::from_utf8_lossy(&out.stderr).into_owned();
        assert_eq!(out.status.code(), Some(2), "{said}");
        assert!(said.contains(name) && said.contains(expected), "{said}");
        assert_eq!(said.trim().lines().count(), 1, "{said}");
    };
    refused("bad.xml", "<mujoco>", &[], "cannot be parsed");
    refused(
        "part.xml",
        "<mujoco><include file=\"no.xml\"/></mujoco>",
        &[],
        "no.xml: cannot be read",
    );
    refused(
        "one.xml",
        MJCF,
        &["--joints", "j7"],
        "the joints that turn or slide are j1",
    );
    let tied = MJCF.replace(
        "</worldbody>",
        "</worldbody><equality><joint name=\"tie\" joint1=\"j1\"/></equality>",
    );
    refused(
        "tied.xml",
        &tied,
        &[],
        "equality constraint \"tie\" acts on joint \"j1\"",
    );
    refused(
        "other.urdf",
        crate::case::URDF,
        &["--joints", "j7"],
        "there is no joint \"j7\"",
    );
}
