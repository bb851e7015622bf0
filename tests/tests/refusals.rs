//! Bad input to `train` and `eval`: exit status 2, one line that names the place, nothing written.

use physics::robot::Robot;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use tempfile::TempDir;
use tests::csv::Csv;
use tests::program::{program, run};
use tests::synthetic::{Plan, record, record_to};

fn ur5() -> Robot {
    Robot::builtin("ur5").expect("built in")
}

/// Two short trajectories of the UR5.
fn recording() -> Csv {
    let plan = Plan {
        trajectories: 2,
        seconds: 3.0,
        ..Plan::default()
    };
    Csv::of(&record(&ur5(), &plan))
}

fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

/// A trained model directory with a compensator, made once.
fn model() -> &'static Path {
    static MODEL: OnceLock<TempDir> = OnceLock::new();
    MODEL
        .get_or_init(|| {
            let folder = folder();
            let data = record_to(folder.path(), "r.csv", &ur5(), &Plan::default());
            let mut train = program("train");
            train.args(["--robot", "ur5", "--basic", "--quiet", "--epochs", "2"]);
            train.args(["--members", "1", "--data"]).arg(&data);
            run(train.arg("--out").arg(folder.path().join("model"))).succeeded();
            folder
        })
        .path()
}

/// A copy of the model directory, to be spoilt.
fn copy_of_model(folder: &Path) -> PathBuf {
    let to = folder.join("model");
    std::fs::create_dir(&to).expect("a folder");
    for (name, bytes) in tests::program::files(&model().join("model")) {
        std::fs::write(to.join(name), bytes).expect("writable");
    }
    to
}

/// `train` refuses `data`, into a folder that is not there and into one that is.
#[track_caller]
fn train_refuses(data: &Path, extra: &[&str], fragments: &[&str]) {
    let place = folder();
    let (absent, present) = (place.path().join("absent"), place.path().join("present"));
    std::fs::create_dir(&present).expect("a folder");
    std::fs::write(present.join("kept"), "as it was").expect("writable");
    for out in [&absent, &present] {
        let mut train = program("train");
        if !extra.contains(&"--robot") {
            train.args(["--robot", "ur5"]);
        }
        train.arg("--data").arg(data).arg("--out").arg(out);
        run(train.args(extra)).refused(fragments);
    }
    assert!(!absent.exists(), "something was written");
    let left = tests::program::files(&present);
    assert_eq!(left, [("kept".to_owned(), b"as it was".to_vec())]);
    let entries = std::fs::read_dir(&present).expect("it is there").count();
    assert_eq!(entries, 1, "something was written");
}

/// `eval` refuses `data` and writes none of its files.
#[track_caller]
fn eval_refuses(model: &Path, data: &Path, fragments: &[&str]) {
    let place = folder();
    let out = |name: &str| place.path().join(name);
    let mut eval = program("eval");
    eval.arg("--model").arg(model).arg("--data").arg(data);
    eval.arg("--json").arg(out("scores.json"));
    eval.arg("--html").arg(out("page.html"));
    run(&mut eval).refused(fragments);
    run(eval.arg("--predict").arg(out("torque.csv"))).refused(fragments);
    assert_eq!(tests::program::files(place.path()), []);
}

/// Both programs refuse `content` in a file of that name, naming the file.
#[track_caller]
fn both_refuse(name: &str, content: impl AsRef<[u8]>, fragments: &[&str]) {
    let place = folder();
    let data = place.path().join(name);
    std::fs::write(&data, content).expect("writable");
    let all = [&[name], fragments].concat();
    train_refuses(&data, &["--physics-only"], &all);
    train_refuses(&data, &[], &all);
    eval_refuses(&model().join("model"), &data, &all);
}

#[test]
fn cells() {
    let good = recording();
    let cases = [
        (17, "tau4", "NaN", "NaN"),
        (5, "q1", "inf", "inf"),
        (601, "time", "-inf", "inf"),
        (9, "tau6", "a lot", "a lot"),
        (12, "q2", "", "missing"),
    ];
    for (row, column, value, reason) in cases {
        let place = [
            &format!("row {row}"),
            &format!("column `{column}`"),
            reason,
            &format!("line {}", row + 1),
        ];
        both_refuse(
            "spoilt.csv",
            good.clone().with(row, column, value).text(),
            &place.map(|s| s as &str),
        );
    }
}

#[test]
fn time_that_goes_back() {
    let good = recording();
    let before = good.rows[9][1].clone();
    let fragments = ["row 12", "column `time`", "trajectory `t1`", "time goes"];
    both_refuse(
        "back.csv",
        good.clone().with(12, "time", &before).text(),
        &fragments,
    );
    // Standing still is not increasing either.
    let same = good.rows[10][1].clone();
    both_refuse("still.csv", good.with(12, "time", &same).text(), &fragments);
}

#[test]
fn columns() {
    let good = recording();
    both_refuse(
        "a.csv",
        good.clone().without(&["time"]).text(),
        &["`time`", "missing"],
    );
    both_refuse(
        "b.csv",
        good.clone().without(&["q3"]).text(),
        &["`q3`", "missing"],
    );
    let joints = "5 joints, the robot has 6";
    both_refuse(
        "d.csv",
        good.clone().without(&["q6", "tau6"]).text(),
        &[joints],
    );
    let mut seven = good.clone();
    for name in ["q7", "tau7"] {
        seven.header.push(name.into());
        seven.rows.iter_mut().for_each(|row| row.push("0.5".into()));
    }
    both_refuse("e.csv", seven.text(), &["7 joints, the robot has 6"]);
    let mut twice = good;
    twice.header[3] = "q1".into();
    both_refuse("f.csv", twice.text(), &["column `q1`", "2 times"]);
}

#[test]
fn missing_torque() {
    let place = folder();
    let one = place.path().join("one.csv");
    recording().without(&["tau2"]).write(&one);
    train_refuses(&one, &[], &["one.csv", "`tau2`", "missing"]);
    let all = place.path().join("all.csv");
    let names = ["tau1", "tau2", "tau3", "tau4", "tau5", "tau6"];
    recording().without(&names).write(&all);
    train_refuses(&all, &[], &["all.csv", "`tau1`", "missing"]);
    // Without --predict there is nothing that eval could do with it.
    let mut eval = program("eval");
    eval.arg("--model").arg(model().join("model"));
    run(eval.arg("--data").arg(&all)).refused(&["all.csv", "`tau1`", "missing"]);
}

#[test]
fn damaged_files() {
    let good = recording();
    both_refuse("empty.csv", "", &["no samples"]);
    both_refuse("header.csv", good.header.join(",") + "\n", &["no samples"]);
    let body = good.text();
    let bare = good.without(&["trajectory"]).text();
    let (_, rows) = bare.split_once('\n').expect("lines");
    both_refuse("headless.csv", rows, &["no header"]);
    let (_, rows) = body.split_once('\n').expect("lines");
    both_refuse("labels.csv", rows, &["`time`", "missing"]);
    let noise: Vec<u8> = (0..4000_u32).map(|i| (i * i % 251) as u8).collect();
    both_refuse("noise.csv", &noise, &[]);
    for ending in ["parquet", "npz"] {
        both_refuse(&format!("noise.{ending}"), &noise, &["not a readable"]);
        both_refuse(&format!("empty.{ending}"), "", &[]);
    }
    both_refuse(
        "ragged.csv",
        body.replacen('\n', "\n1,2,3\n", 2),
        &["row 1", "cells"],
    );
    both_refuse(
        "short.csv",
        body.lines().take(4).collect::<Vec<_>>().join("\n"),
        &["trajectory `t1`", "3 samples"],
    );
    both_refuse("recording.txt", &body, &["`txt`", "not a known kind"]);
    both_refuse("benchmark.mat", &noise, &["KR300"]);
    let absent = Path::new("/nowhere/absent.csv");
    train_refuses(absent, &[], &["/nowhere/absent.csv", "cannot be read"]);
    eval_refuses(
        &model().join("model"),
        absent,
        &["/nowhere/absent.csv", "cannot be read"],
    );
}

#[test]
fn benchmark_files_without_their_keys() {
    let place = folder();
    let kr300 = ["--robot", "kr300"];
    let data = place.path().join("other.mat");
    // A MATLAB 5 file that holds nothing but a 1 × 1 matrix called `x`.
    let mut bytes = vec![b' '; 124];
    bytes[..19].copy_from_slice(b"MATLAB 5.0 MAT-file");
    bytes.extend([0x00, 0x01, b'I', b'M']);
    let mut body: Vec<u8> = Vec::new();
    for (kind, content) in [
        (6_u32, vec![6, 0, 0, 0, 0, 0, 0, 0]),
        (5, [1_u32.to_le_bytes(), 1_u32.to_le_bytes()].concat()),
        (1, b"x".to_vec()),
        (9, 1.0_f64.to_le_bytes().to_vec()),
    ] {
        body.extend(kind.to_le_bytes());
        body.extend((content.len() as u32).to_le_bytes());
        body.extend(content);
        body.resize(body.len().next_multiple_of(8), 0);
    }
    bytes.extend(14_u32.to_le_bytes());
    bytes.extend((body.len() as u32).to_le_bytes());
    bytes.extend(body);
    std::fs::write(&data, bytes).expect("writable");
    train_refuses(
        &data,
        &kr300,
        &["other.mat", "`u_train`", "the file has: x"],
    );
    std::fs::write(&data, "nothing of MATLAB").expect("writable");
    train_refuses(&data, &kr300, &["other.mat", "not a readable MATLAB file"]);
}

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
    train_refuses(&data, &robot, &["upper"]);
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
    train_refuses(&data, &["--threads", "0"], &["--threads 0"]);
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

/// Refused only once identification has begun; nothing is left of it either.
#[test]
fn nothing_moves() {
    let place = folder();
    let still = place.path().join("still.csv");
    let plan = Plan {
        still: (0..6).collect(),
        ..Plan::default()
    };
    Csv::of(&record(&ur5(), &plan)).write(&still);
    for extra in [
        &["--moving-only", "--physics-only"][..],
        &["--moving-only"],
        &[],
    ] {
        train_refuses(&still, extra, &["no joint moves"]);
    }
}

#[test]
fn altered_models() {
    let place = folder();
    let data = place.path().join("r.csv");
    recording().write(&data);
    let weights = "compensator.safetensors";

    let nothing = place.path().join("nothing");
    eval_refuses(&nothing, &data, &["model.json"]);

    let altered = |change: &dyn Fn(&Path), fragments: &[&str]| {
        let place = folder();
        let model = copy_of_model(place.path());
        change(&model);
        eval_refuses(&model, &data, fragments);
    };
    let model_json = |edit: &dyn Fn(String) -> String, fragments: &[&str]| {
        altered(
            &|model| {
                let path = model.join("model.json");
                let text = std::fs::read_to_string(&path).expect("readable");
                let new = edit(text.clone());
                assert_ne!(new, text, "the edit changes nothing");
                std::fs::write(&path, new).expect("writable");
            },
            fragments,
        );
    };
    let size = std::fs::metadata(model().join("model").join(weights))
        .expect("it is there")
        .len() as usize;
    for at in [0, 9, size / 2, size - 1] {
        let flip = |model: &Path| {
            let mut bytes = std::fs::read(model.join(weights)).expect("readable");
            bytes[at] ^= 1;
            std::fs::write(model.join(weights), bytes).expect("writable");
        };
        altered(&flip, &[weights, "checksum"]);
    }
    let cut = |model: &Path| {
        let bytes = std::fs::read(model.join(weights)).expect("readable");
        std::fs::write(model.join(weights), &bytes[..size / 2]).expect("writable");
    };
    altered(&cut, &[weights, "checksum"]);
    let lost = |model: &Path| std::fs::remove_file(model.join(weights)).expect("removable");
    altered(&lost, &[weights]);
    let covariance = "covariance.json";
    let lost = |model: &Path| std::fs::remove_file(model.join(covariance)).expect("removable");
    altered(&lost, &[covariance]);
    let other = |model: &Path| {
        let text = std::fs::read_to_string(model.join(covariance)).expect("readable");
        let new = text.replacen("[[", "[[1", 1);
        std::fs::write(model.join(covariance), new).expect("writable");
    };
    altered(&other, &[covariance, "checksum"]);

    model_json(
        &|t| t[..t.len() / 2].to_owned(),
        &["model.json", "not a model"],
    );
    model_json(&|_| "[]".into(), &["model.json", "schema"]);
    model_json(
        &|t| t.replacen("model/1", "model/9", 1),
        &["model.json", "model/9", "model/1"],
    );
    model_json(
        &|t| t.replace("\"residual_std\"", "\"residual_sd\""),
        &["model.json", "residual_std"],
    );
    model_json(
        &|t| t.replace("shoulder_pan_joint", "another_joint"),
        &["joint"],
    );
}

#[test]
fn recording_of_another_robot() {
    let place = folder();
    let data = place.path().join("five.csv");
    recording().without(&["q6", "tau6"]).write(&data);
    eval_refuses(
        &model().join("model"),
        &data,
        &["five.csv", "5 joints", "6"],
    );
}
