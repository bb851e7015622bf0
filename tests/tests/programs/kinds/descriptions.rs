//! Descriptions: side branches, masses, macros, comments.

use super::{Made, UNIT, Urdf, recorded, robot, says};
use physics::robot::Description;
use tests::program::{json, program, run};
use tests::synthetic::friction;

fn side(name: &str, kind: &str, parent: &str, mimic: &str) -> String {
    format!(
        r#"<link name="{name}"><inertial><mass value="0.08"/><inertia ixx="1e-4" ixy="0" ixz="0" iyy="1e-4" iyz="0" izz="1e-4"/></inertial></link>
<joint name="{name}_joint" type="{kind}"><parent link="{parent}"/><child link="{name}"/><origin xyz="0.05 0 0.1"/><axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="5" velocity="1"/>{mimic}</joint>
"#
    )
}

#[test]
fn grippers_and_linkages() {
    let follows = |joint: &str, by: f64| format!(r#"<mimic joint="{joint}" multiplier="{by}"/>"#);
    let jaws = side("jaw_a", "prismatic", "l3", "")
        + &side("jaw_b", "prismatic", "l3", &follows("jaw_a_joint", -1.0));
    let knuckles = side("knuckle", "revolute", "l4", "")
        + &side("tip", "revolute", "knuckle", &follows("knuckle_joint", 0.7))
        + &side("thumb", "revolute", "l4", &follows("knuckle_joint", -1.0));
    let suckers = side("cup_a", "prismatic", "l3", "") + &side("cup_b", "prismatic", "l3", "");
    let rod = side("rod", "revolute", "l1", &follows("lift", -1.0));
    let spring = side("spring", "prismatic", "l1", &follows("shoulder_lift", 0.05));
    let rods = side("crank", "revolute", "l1", &follows("bend", 1.0))
        + &side("strut", "revolute", "crank", &follows("bend", -1.0));
    for (arm, extra, said) in [
        (
            0,
            jaws,
            [
                "the chain turn, lift, reach",
                "jaw_b_joint (which follows jaw_a_joint)",
            ],
        ),
        (
            1,
            knuckles,
            [
                "the chain shoulder_pan, shoulder_lift, elbow_flex, wrist_flex",
                "thumb_joint (which follows knuckle_joint)",
            ],
        ),
        (
            2,
            suckers,
            ["the chain swing, bend, roll", "cup_a_joint, cup_b_joint"],
        ),
        (
            0,
            rod,
            [
                "the chain turn, lift, reach",
                "rod_joint (which follows lift)",
            ],
        ),
        (
            1,
            spring,
            [
                "the chain shoulder_pan, shoulder_lift, elbow_flex, wrist_flex",
                "spring_joint (which follows shoulder_lift)",
            ],
        ),
        (
            2,
            rods,
            [
                "the chain swing, bend, roll",
                "crank_joint (which follows bend)",
            ],
        ),
    ] {
        let text = Urdf {
            arm,
            extra: &extra,
            ..Urdf::default()
        }
        .text();
        let made = Made::new("arm.urdf", &text);
        says(&made.to_plain(&recorded(&robot(arm), 1)), &said, &["error"]);
    }
}

#[test]
fn masses_that_are_none_or_placeholders() {
    let inertial = |mass: f64, inertia: f64| {
        format!(
            r#"<inertial><mass value="{mass}"/><inertia ixx="{inertia}" ixy="0" ixz="0" iyy="{inertia}" iyz="0" izz="{inertia}"/></inertial>"#
        )
    };
    let (none, placeholders) = (
        "the description has no masses",
        "the description's masses are placeholders",
    );
    for (arm, fixed, said) in [
        (0, String::new(), none),
        (1, inertial(0.0, 0.0), none),
        (2, "<visual/>".to_owned(), none),
        (0, inertial(0.01, 1e-3), placeholders),
        (1, inertial(1.0, 1.0), placeholders),
        (2, inertial(0.1, 1e-3), placeholders),
    ] {
        let text = Urdf {
            arm,
            fixed: Some(&fixed),
            ..Urdf::default()
        }
        .text();
        let made = Made::new("arm.urdf", &text);
        says(
            &made.to_plain(&recorded(&robot(arm), 2)),
            &[said, "2001 samples"],
            &UNIT,
        );
    }
}

/// A last link that weighs nearly nothing on paper: what it weighs is said of the link, and not of a payload, which has the
/// same columns. As much is explained as of the description in order.
#[test]
fn a_last_link_that_cannot_be() {
    for (arm, scale) in [
        (0, &[1.0, 1.0, 0.002][..]),
        (1, &[1.0, 1.0, 1.0, 0.005]),
        (2, &[1.0, 1.0, 0.004]),
    ] {
        let diagnosed = |scale: &[f64]| {
            let text = Urdf {
                arm,
                scale,
                ..Urdf::default()
            }
            .text();
            let made = Made::new("arm.urdf", &text);
            let path = |name: &str| made.folder.path().join(name);
            for (name, seed) in [("data.csv", 1), ("heldout.csv", 2)] {
                datasets::write(&recorded(&robot(arm), seed), &path(name)).expect("writable");
            }
            let mut diagnose = program("diagnose");
            diagnose.args(["--fast", "--robot"]).arg(&made.robot);
            diagnose.arg("--data").arg(path("data.csv"));
            diagnose.arg("--heldout").arg(path("heldout.csv"));
            let ended = run(diagnose.arg("--json").arg(path("report.json")));
            let report = json(&path("report.json"));
            let last = report["ladder"].as_array().and_then(|steps| steps.last());
            let left = last.and_then(|step| step["mean_nrmse"].as_f64());
            (ended.out, report, left.expect("a ladder"))
        };
        let (said, report, left) = diagnosed(scale);
        says(&said, &["less than a hundredth of the link before it"], &[]);
        let causes = report["causes"].as_array().into_iter().flatten();
        let named: Vec<&str> = causes.filter_map(|c| c["effect"].as_str()).collect();
        assert!(named.contains(&"link_parameters"), "{named:?}");
        assert!(!named.contains(&"payload"), "{named:?}");
        let (.., in_order) = diagnosed(&[]);
        assert!(left < 1.1 * in_order, "{left} {in_order}");
    }
}

#[test]
fn descriptions_that_are_too_heavy() {
    for (arm, scale) in [
        (0, &[1.3, 1.6, 2.0][..]),
        (1, &[1.8; 4]),
        (2, &[1.6, 1.5, 1.7]),
    ] {
        let recording = recorded(&robot(arm), 3);
        let text = Urdf {
            arm,
            scale,
            friction: &friction(&recording),
            ..Urdf::default()
        }
        .text();
        let answer = Made::new("arm.urdf", &text).to_plain(&recording);
        says(&answer, &["a description whose masses are wrong"], &UNIT);
    }
}

#[test]
fn macros_and_comments() {
    let xmlns = r#"xmlns:xacro="http://www.ros.org/wiki/xacro""#;
    for (name, text, file) in [
        (
            "cell.urdf.xacro",
            format!(
                r#"<robot {xmlns} name="${{name}}"><xacro:include filename="a.xacro"/></robot>"#
            ),
            "cell.urdf",
        ),
        (
            "arm.xacro",
            format!(
                r#"<robot {xmlns} name="a"><xacro:macro name="m" params="p"><link name="${{p}}l"/></xacro:macro></robot>"#
            ),
            "arm.urdf",
        ),
        (
            "two.urdf.xacro",
            format!(
                r#"<robot {xmlns} name="$(arg n)"><link name="base"/><xacro:if value="1"><link name="a"/></xacro:if></robot>"#
            ),
            "two.urdf",
        ),
    ] {
        let said = format!("expand it first: `xacro {name} > {file}`");
        says(
            &Made::new(name, &text).to_plain(&recorded(&robot(0), 12)),
            &[&said],
            &[],
        );
    }
    for (k, comment) in [
        "<!-- -- -->",
        "<!-- axes -- see sheet 4 -- in mm -->",
        "<!--- links --- --->",
    ]
    .into_iter()
    .enumerate()
    {
        let body = |inside: &str| {
            format!(
                r#"<body pos="0 0 0.3"><inertial pos="0.1 0 0.1" mass="{}" diaginertia="0.03 0.03 0.02"/><joint name="j{}" axis="0 1 0"/>{inside}</body>"#,
                2 + k,
                inside.len().min(1)
            )
        };
        let text = format!(
            "<mujoco>{comment}<worldbody>{}</worldbody></mujoco>",
            body(&body(""))
        );
        let made = Made::new("arm.xml", &text);
        let (_, robot) = Description::load(&made.robot, &[]).expect("MuJoCo takes it");
        says(
            &made.to_plain(&recorded(&robot, 13)),
            &["2001 samples"],
            &["error"],
        );
    }
}
