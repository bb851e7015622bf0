//! Descriptions as people have them, with a recording: which chain is taken, and what the masses are worth.

use crate::case::{Case, URDF, causes, json, recording};
use serde_json::Value;

/// Diagnoses the pendulum's recordings with another description; what is said, and the report.
fn diagnosed(case: &Case, urdf: &str, more: &[&str]) -> (String, Value) {
    case.write("other.urdf", urdf);
    let arguments = [&["--json", "@r.json", "--fast"], more].concat();
    let out = case.diagnose(&["--robot", "@other.urdf"], &arguments);
    let said = String::from_utf8_lossy(&out.stderr);
    assert_eq!(out.status.code(), Some(0), "{said}\n{urdf}");
    let said = String::from_utf8_lossy(&out.stdout).into_owned();
    (said, json(&case.path("r.json")))
}

fn with(more: &str) -> String {
    URDF.replace("</robot>", &format!("{more}</robot>"))
}

const FINGER: &str = r#"<link name="f1"><inertial><mass value="0.02"/><inertia ixx="1e-6" iyy="1e-6" izz="1e-6"/></inertial></link>
<joint name="finger1" type="prismatic"><parent link="l1"/><child link="f1"/><axis xyz="0 1 0"/><limit lower="0" upper="0.04" effort="5" velocity="1"/></joint>"#;

/// Fingers, rods and heads beside the recorded joint change nothing but what they weigh, and are said.
#[test]
fn what_is_beside_the_recorded_chain_stands_still() {
    let case = Case::new(&recording(0.0, 0.0), &recording(0.0, 0.45));
    let named = |text: String| text.replace("q1,tau1", "j1.pos,j1.effort");
    let by_name = Case::new(&named(recording(0.0, 0.0)), &named(recording(0.0, 0.45)));
    let follower = FINGER.replace("f1", "f2").replace("finger1", "finger2");
    let follower = follower.replace("<limit", "<mimic joint=\"finger1\"/><limit");
    let rod = FINGER.replace("f1", "rod").replace("finger1", "rod_joint");
    let rod = rod.replace("<limit", "<mimic joint=\"j1\" multiplier=\"-0.25\"/><limit");
    let head = FINGER
        .replace("l1", "base")
        .replace("f1", "head")
        .replace("finger1", "pan");
    for (beside, joint, case, more) in [
        (
            format!("{FINGER}{follower}"),
            "finger1, finger2",
            &case,
            &[][..],
        ),
        (rod, "rod_joint", &case, &[]),
        (head.clone(), "pan", &case, &["--joints", "j1"]),
        (head, "pan", &by_name, &[]),
    ] {
        let (said, report) = diagnosed(case, &with(&beside), more);
        assert!(said.contains(joint), "{said}");
        assert_eq!(report["joints"], serde_json::json!(["j1"]), "{joint}");
    }
    // Two joints may be meant, and nothing says which.
    case.write("other.urdf", &with(&FINGER.replace("l1", "base")));
    let out = case.diagnose(&["--robot", "@other.urdf"], &[]);
    let said = String::from_utf8_lossy(&out.stderr);
    assert_eq!(out.status.code(), Some(2), "{said}");
    assert!(
        said.contains("they begin at j1, finger1") && said.contains("--joints"),
        "{said}"
    );
}

/// Without masses there is no gap to judge, and placeholders are no payload and no other unit.
#[test]
fn no_masses_and_placeholders_are_said_and_blamed_on_nothing_else() {
    let case = Case::new(&recording(0.0, 0.0), &recording(0.0, 0.45));
    let body = "<inertial><origin xyz=\"0.1 0 0\"/><mass value=\"1\"/>\n<inertia ixx=\"0.01\" ixy=\"0\" ixz=\"0\" iyy=\"0.01\" iyz=\"0\" izz=\"0.01\"/></inertial>";
    assert!(URDF.contains(body));
    let light = body.replace("\"1\"", "\"0.001\"");
    let zero = body.replace("\"1\"", "\"0\"").replace("0.01", "0");
    for (body, why) in [
        ("", "the description has no masses"),
        (zero.as_str(), "the description has no masses"),
        (light.as_str(), "the description's masses are placeholders"),
    ] {
        let urdf = URDF.replace("<inertial><origin xyz=\"0.1 0 0\"/><mass value=\"1\"/>\n<inertia ixx=\"0.01\" ixy=\"0\" ixz=\"0\" iyy=\"0.01\" iyz=\"0\" izz=\"0.01\"/></inertial>", body);
        let (said, report) = diagnosed(&case, &urdf, &["--patch", "@p.urdf"]);
        assert!(
            said.contains("so that there is no gap as given to judge"),
            "{said}"
        );
        assert_eq!(report["no_gap_as_given"], why, "{said}");
        let named = causes(&report);
        assert!(
            named
                .iter()
                .all(|c| !["payload", "torque_gain"].contains(c)),
            "{named:?}"
        );
        let last = report["ladder"].as_array().unwrap().last().unwrap();
        assert!(last["mean_nrmse"].as_f64().unwrap() < 0.05, "{said}");
        // The weight that the recording shows is in the file, whatever stands in for the rest.
        let robot = physics::robot::Robot::from_urdf_file(case.path("p.urdf")).unwrap();
        let moment = robot.joints()[0].link.inertia.first_moment.x;
        assert!((moment - 0.1).abs() < 0.01, "{moment}\n{said}");
        assert!(
            said.contains("Written: ") && said.contains("link l1: "),
            "{said}"
        );
    }
}

/// A payload is a body of its own in the file, and what is said is what is written.
#[test]
fn what_is_said_is_what_is_written() {
    let heavier = |shift: f64| -> String {
        // 0.4 kg at 0.25 m: 0.1 kg·m more, 0.025 kg·m² more.
        let line = |line: &str| {
            let cells: Vec<f64> = line.split(',').filter_map(|c| c.parse().ok()).collect();
            let [trajectory, t, q, tau] = cells[..] else {
                return line.to_owned();
            };
            let a = trajectory + shift;
            let (w1, w2) = (1.7 + 0.1 * a, 3.9 - 0.13 * a);
            let qdd = -0.6 * w1 * w1 * (w1 * t + a).sin() - 0.3 * w2 * w2 * (w2 * t).sin();
            let more = 0.025 * qdd - 0.1 * 9.81 * q.cos();
            format!("{trajectory},{t},{q},{}", tau + more)
        };
        let text = recording(0.0, shift);
        text.lines().map(|l| line(l) + "\n").collect()
    };
    let case = Case::new(&heavier(0.0), &heavier(0.45));
    let (said, report) = diagnosed(&case, URDF, &["--patch", "@p.urdf"]);
    let given = physics::robot::Robot::from_urdf_str(URDF).unwrap();
    let written = physics::robot::Robot::from_urdf_file(case.path("p.urdf")).unwrap();
    let moment = |r: &physics::robot::Robot| r.joints()[0].link.inertia.first_moment.x;
    assert!(
        (moment(&written) - moment(&given) - 0.1).abs() < 0.01,
        "{said}"
    );
    let text = std::fs::read_to_string(case.path("p.urdf")).unwrap();
    let load = causes(&report).contains(&"payload");
    assert_eq!(text.contains("<link name=\"payload\">"), load, "{said}");
    assert_eq!(
        said.contains("payload, a body of its own on l1"),
        load,
        "{said}"
    );
    if load {
        // The link itself stays what it was.
        assert!(
            text.contains("<mass value=\"1\"/>") || said.contains("link l1: "),
            "{text}"
        );
    }
    assert!(!said.contains("in the URDF: nothing"), "{said}");
}
