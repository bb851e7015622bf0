//! Robots and options that are refused.

use super::refused::{folder, recording, train_refuses};

const LINK: &str = r#"<inertial><mass value="2"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>"#;

fn urdf(links: &[(&str, &str)], joints: &[(&str, &str, &str)]) -> String {
    let mut text = String::from("<robot name=\"test\">\n");
    for (name, inside) in links {
        text += &format!("<link name=\"{name}\">{inside}</link>\n");
    }
    for (name, parent, child) in joints {
        text += &format!(
            "<joint name=\"{name}\" type=\"continuous\"><parent link=\"{parent}\"/><child link=\"{child}\"/><axis xyz=\"0 1 0\"/></joint>\n"
        );
    }
    text + "</robot>\n"
}

#[test]
fn robots() {
    let place = folder();
    let data = place.path().join("r.csv");
    recording().write(&data);
    train_refuses(&data, &["--robot", "r2d2"], &["r2d2"]);
    let file = place.path().join("robot.urdf");
    let robot = ["--robot", file.to_str().expect("a name in UTF-8")];
    train_refuses(&data, &robot, &["robot.urdf"]);
    let tree = urdf(
        &[
            ("base", ""),
            ("upper", LINK),
            ("left", LINK),
            ("right", LINK),
        ],
        &[
            ("lift", "base", "upper"),
            ("a", "upper", "left"),
            ("b", "upper", "right"),
        ],
    );
    std::fs::write(&file, tree).expect("writable");
    train_refuses(&data, &robot, &["begin at a, b", "--joints"]);
    let massless = urdf(
        &[("base", ""), ("upper", LINK), ("hollow", "")],
        &[("lift", "base", "upper"), ("turn", "upper", "hollow")],
    );
    std::fs::write(&file, massless).expect("writable");
    train_refuses(&data, &robot, &["hollow"]);
}

#[test]
fn a_broken_urdf_is_named() {
    let place = folder();
    let data = place.path().join("r.csv");
    recording().write(&data);
    let file = place.path().join("robot.urdf");
    std::fs::write(&file, "<robot name=\"broken\"><link").expect("writable");
    let robot = ["--robot", file.to_str().expect("a name in UTF-8")];
    train_refuses(&data, &robot, &["robot.urdf", "cannot be parsed"]);
}

#[test]
fn arguments() {
    let place = folder();
    let data = place.path().join("r.csv");
    recording().write(&data);
    train_refuses(&data, &["--threads", "0"], &["--threads", "from 1 on"]);
    train_refuses(&data, &["--members", "none"], &["--members"]);
    train_refuses(&data, &["--cutoff-hz", "400"], &["r.csv", "400"]);
    train_refuses(&data, &["--cutoff-hz", "nan"], &["cut"]);
    train_refuses(&data, &["--gravity", "nan,0,0"], &["gravity"]);
    train_refuses(
        &data,
        &["--drive", "/nowhere/drive.toml"],
        &["/nowhere/drive.toml"],
    );
}
