//! The program from arguments to files.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A folder and runs of the program in it.
struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn run(&self, arguments: &[&str]) -> Output {
        Command::new(env!("CARGO_BIN_EXE_excite"))
            .current_dir(self.0.path())
            .args(arguments)
            .output()
            .unwrap()
    }

    /// Standard output of a run that went well.
    fn good(&self, arguments: &[&str]) -> String {
        let out = self.run(arguments);
        let said = String::from_utf8_lossy(&out.stderr);
        assert_eq!(out.status.code(), Some(0), "{said}");
        String::from_utf8(out.stdout).unwrap()
    }

    /// One line that says what is wrong, exit status 2, nothing written.
    #[track_caller]
    fn refused(&self, arguments: &[&str], fragments: &[&str]) {
        let out = self.run(arguments);
        let said = String::from_utf8_lossy(&out.stderr).into_owned();
        assert_eq!(out.status.code(), Some(2), "{said}");
        let line = said
            .lines()
            .find(|l| l.starts_with("error: "))
            .unwrap_or_default();
        for fragment in fragments {
            assert!(said.contains(fragment), "no `{fragment}` in {said}");
        }
        assert!(!line.is_empty() && !said.contains("panicked"), "{said}");
        assert!(!self.path("excitation.csv").exists());
    }

    fn json(&self, name: &str) -> Value {
        serde_json::from_str(&std::fs::read_to_string(self.path(name)).unwrap()).unwrap()
    }
}

/// Header and rows of a file, the label left out.
fn table(path: &Path) -> (Vec<String>, Vec<Vec<f64>>) {
    let text = std::fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    let header = lines
        .next()
        .unwrap()
        .split(',')
        .map(str::to_owned)
        .collect();
    let row = |l: &str| l.split(',').skip(1).map(|x| x.parse().unwrap()).collect();
    (header, lines.map(row).collect())
}

const FEW: [&str; 4] = ["--evaluations", "60", "--trajectories", "2"];

#[test]
fn a_design_is_written_with_its_summary() {
    let f = Folder::new();
    let files = ["--out", "m.csv", "--json", "m.json", "--html", "m.html"];
    let said = f.good(&[&FEW[..], &files[..]].concat());
    assert!(said.contains("Collisions are not checked"), "{said}");
    for line in said.lines() {
        assert!(line.chars().count() <= 110, "{line}");
    }
    let (header, rows) = table(&f.path("m.csv"));
    assert_eq!(header[..3], ["trajectory", "time", "q_ref1"]);
    assert_eq!(
        (header[8].as_str(), header[14].as_str()),
        ("qd_ref1", "qdd_ref1")
    );
    assert_eq!((header.len(), rows.len()), (2 + 18, 2 * 1251));
    for end in [0, 1250, 1251, 2501] {
        // At rest in velocity and acceleration.
        assert!(
            rows[end][7..19].iter().all(|x| x.abs() < 1e-8),
            "{:?}",
            rows[end]
        );
    }
    assert_eq!((rows[1250][0], rows[1251][0]), (12.5, 0.0));
    let report = f.json("m.json");
    assert_eq!(report["schema"], "excitation/1");
    assert_eq!(report["collisions_checked"], false);
    let number = |v: &Value| v.as_f64().unwrap();
    let runs = report["trajectories"].as_array().unwrap();
    assert!(number(&runs[1]["cost"]) < number(&runs[0]["cost"]));
    for joint in report["joints"].as_array().unwrap() {
        for of in ["velocity", "acceleration"] {
            let [used, limit] = [0, 1].map(|k| number(&joint[of][k]));
            assert!(used <= 0.9 * limit + 1e-9 && used > 0.0, "{joint}");
        }
    }
    assert!(
        std::fs::read_to_string(f.path("m.html"))
            .unwrap()
            .contains("Trajectory 2")
    );
}

#[test]
fn the_same_seed_gives_the_same_bytes_whatever_the_threads_and_the_format_reads_back() {
    let f = Folder::new();
    let bytes = |out: &str, seed: &str, threads: &str| {
        let done = Command::new(env!("CARGO_BIN_EXE_excite"))
            .current_dir(f.0.path())
            .env("RAYON_NUM_THREADS", threads)
            .args(FEW)
            .args(["--out", out, "--seed", seed, "--quiet"])
            .output()
            .unwrap();
        assert!(done.status.success() && done.stdout.is_empty());
        std::fs::read(f.path(out)).unwrap()
    };
    assert_eq!(bytes("a.csv", "3", "1"), bytes("b.csv", "3", "2"));
    assert_ne!(bytes("a.csv", "3", "1"), bytes("c.csv", "4", "1"));
    bytes("d.parquet", "3", "1");
    let read = |name: &str| {
        let options = datasets::ReadOptions::for_reference(6);
        datasets::read(&f.path(name), &options).unwrap()
    };
    let (csv, parquet) = (read("a.csv"), read("d.parquet"));
    assert_eq!((&csv.q, &csv.qdd), (&parquet.q, &parquet.qdd));
    assert_eq!(csv.trajectories.len(), 2);
}

#[test]
fn every_method_and_criterion_runs() {
    let f = Folder::new();
    for criterion in [
        "cond",
        "cond-noise",
        "cond-sub",
        "cond-sub-noise",
        "d-optimal",
    ] {
        f.good(&[
            "--evaluations",
            "30",
            "--trajectories",
            "1",
            "--criterion",
            criterion,
        ]);
    }
    let said = f.good(&[
        "--method",
        "sines",
        "--trajectories",
        "1",
        "--evaluations",
        "60",
        "--json",
        "s.json",
    ]);
    assert!(said.contains("sines"), "{said}");
    // Close to the limits of position on every joint.
    for joint in f.json("s.json")["joints"].as_array().unwrap() {
        let [low, high] = [0, 1].map(|k| joint["position"][k].as_f64().unwrap());
        let [lower, upper] = [0, 1].map(|k| joint["position_limits"][k].as_f64().unwrap());
        assert!((high - low) / (upper - lower) > 0.85, "{joint}");
    }
    let free = [
        "--method",
        "model-free",
        "--robot",
        "kr300",
        "--trajectories",
        "3",
        "--html",
        "f.html",
    ];
    f.good(&free);
    let (_, rows) = table(&f.path("excitation.csv"));
    assert_eq!(rows.len(), 3 * 6061);
    // All start and end at one pose, which is the same for all.
    for end in [6060, 6061, 12_121, 12_122, 18_182] {
        let apart = rows[end][1..7].iter().zip(&rows[0][1..7]);
        assert!(apart.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) < 1e-9);
    }
    let heavier = f.path("heavier.urdf");
    let robot = physics::robot::Robot::builtin("ur5").unwrap();
    let mut p = robot.parameters();
    p[50] += 2.0;
    let other = robot.with_parameters(&p).unwrap();
    std::fs::write(&heavier, physics::robot::to_urdf(&other)).unwrap();
    f.good(&[
        "--criterion",
        "separation",
        "--against",
        "heavier.urdf",
        "--evaluations",
        "60",
        "--trajectories",
        "1",
    ]);
}

#[test]
fn home_tool_and_repeats_are_kept() {
    let f = Folder::new();
    let home = "0,-1.2,1.2,-1,0.5,0";
    f.good(
        &[
            &FEW[..],
            &[
                "--home", home, "--repeat", "3", "--rate", "40", "--tool", "0,0,0.1",
            ],
            &["--tool-box", "-0.9:0.9,-0.9:0.9,-0.2:1.2", "--rest", "jerk"],
        ]
        .concat(),
    );
    let (_, rows) = table(&f.path("excitation.csv"));
    assert_eq!(rows.len(), 2 * (3 * 500 + 1));
    let pose: Vec<f64> = home.split(',').map(|x| x.parse().unwrap()).collect();
    for run in [0, 500, 1000, 1500, 1501, 3001] {
        let apart = rows[run][1..7]
            .iter()
            .zip(&pose)
            .map(|(a, b)| (a - b).abs());
        assert!(apart.fold(0.0, f64::max) < 1e-9);
    }
    let robot = physics::robot::Robot::builtin("ur5").unwrap();
    let region = identify::excitation::Region::Box {
        lower: [-0.9, -0.9, -0.2],
        upper: [0.9, 0.9, 1.2],
    };
    let limits = identify::excitation::MotionLimits::of_robot(&robot);
    let tool = identify::excitation::ToolRoom::new(&robot, &limits, [0.0, 0.0, 0.1], vec![region]);
    assert!(rows.iter().all(|r| tool.clearance(&r[1..7]) > 0.0));
}

#[test]
fn a_plan_tells_what_shows_and_from_which_size() {
    let f = Folder::new();
    std::fs::write(f.path("arm.urdf"), ARM).unwrap();
    let few = [
        "--robot",
        "arm.urdf",
        "--evaluations",
        "60",
        "--trajectories",
        "2",
        "--out",
        "m.csv",
    ];
    let said = f.good(
        &[
            &few[..],
            &[
                "--plan", "--json", "p.json", "--html", "p.html", "--noise", "0.05",
            ],
        ]
        .concat(),
    );
    assert!(
        said.contains("stribeck_friction") && said.contains("shows from"),
        "{said}"
    );
    let planned = f.json("p.json");
    let from = |report: &Value, effect: &str, joint: &str| {
        let all = report["plan"]["effects"].as_array().unwrap().clone();
        let one = all
            .iter()
            .find(|e| e["effect"] == effect && e["joints"][0] == joint);
        one.unwrap_or_else(|| panic!("{effect}"))["from"].as_f64()
    };
    // The same motion from its file says the same.
    f.good(&[
        "--robot", "arm.urdf", "--motion", "m.csv", "--plan", "--noise", "0.05", "--json", "q.json",
    ]);
    let read = f.json("q.json");
    assert_eq!(read["plan"], planned["plan"]);
    // A slow short motion shows less of everything that grows with speed, and its parameters less well.
    f.good(&[
        "--robot",
        "arm.urdf",
        "--evaluations",
        "60",
        "--trajectories",
        "1",
        "--out",
        "slow.csv",
        "--velocity",
        "0.3",
        "--acceleration",
        "0.5",
        "--plan",
        "--noise",
        "0.05",
        "--json",
        "slow.json",
    ]);
    let slow = f.json("slow.json");
    let (fast, other) = (
        from(&planned, "rotor_inertia", "j1"),
        from(&slow, "rotor_inertia", "j1"),
    );
    assert!(
        other.is_none_or(|slow| slow > 2.0 * fast.unwrap()),
        "{fast:?} {other:?}"
    );
    let std = |report: &Value| report["plan"]["parameters"][0]["std"].as_f64().unwrap();
    assert!(std(&slow) > 2.0 * std(&planned));
    assert!(
        planned["plan"]["not_judged"]
            .as_array()
            .unwrap()
            .iter()
            .any(|n| n["effect"] == "external_contact")
    );
}

/// Two links that move in one plane.
const ARM: &str = r#"<robot name="arm"><link name="base"/>
<link name="l1"><inertial><origin xyz="0.2 0 0"/><mass value="2"/><inertia ixx="0.02" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.03"/></inertial></link>
<link name="l2"><inertial><origin xyz="0.15 0 0"/><mass value="1"/><inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>
<joint name="j1" type="revolute"><parent link="base"/><child link="l1"/><axis xyz="0 1 0"/>
<limit lower="-2" upper="2" velocity="3" effort="50"/><dynamics damping="0.4" friction="0.3"/></joint>
<joint name="j2" type="revolute"><origin xyz="0.4 0 0"/><parent link="l1"/><child link="l2"/><axis xyz="0 1 0"/>
<limit lower="-2" upper="2" velocity="3" effort="50"/><dynamics damping="0.3" friction="0.2"/></joint></robot>"#;

#[test]
fn what_cannot_hold_is_refused_with_the_reason() {
    let f = Folder::new();
    f.refused(
        &["--velocity", "0.01"],
        &["velocity limit", "12.5 s", "--period"],
    );
    f.refused(&["--jerk", "0.0001"], &["jerk limit"]);
    f.refused(&["--velocity", "1,2"], &["2 values", "6 joints"]);
    f.refused(&["--position", "1:1"], &["LO:HI"]);
    f.refused(&["--home", "7"], &["shoulder_pan_joint", "home"]);
    f.refused(&["--tool-sphere", "9,0,0,1"], &["region"]);
    f.refused(
        &["--tool-sphere", "9,0,0,1", "--home", "0"],
        &["outside its region at home"],
    );
    f.refused(&["--method", "sines", "--period", "20"], &["too short"]);
    f.refused(&["--method", "sines", "--repeat", "2"], &["repeated"]);
    f.refused(&["--harmonics", "1"], &["harmonics"]);
    f.refused(&["--max-hz", "0.2"], &["above --max-hz", "--harmonics 2"]);
    f.refused(&["--period", "12.503"], &["whole number", "--period 12.5"]);
    f.refused(&["--criterion", "best"], &["cond-sub-noise"]);
    f.refused(&["--criterion", "separation"], &["--against"]);
    f.refused(&["--against", "ur5"], &["separation"]);
    f.refused(
        &["--criterion", "separation", "--against", "nobody"],
        &["nobody"],
    );
    f.refused(&["--robot", "nobody"], &["nobody"]);
    f.refused(&["--limits", "nowhere.toml"], &["nowhere.toml"]);
    f.refused(&["--motion", "m.csv"], &["--plan"]);
    f.refused(&["--trajectories", "0"], &["--trajectories"]);
    f.refused(
        &[&FEW[..], &["--out", "m.txt"]].concat(),
        &["m.txt", ".csv"],
    );
    std::fs::write(f.path("bad.csv"), "time,tau1\n0,1\n").unwrap();
    f.refused(&["--plan", "--motion", "bad.csv"], &["bad.csv", "q1"]);
    let turning = ARM.replace(r#"velocity="3""#, r#"velocity="0""#);
    std::fs::write(f.path("still.urdf"), turning).unwrap();
    f.refused(&["--robot", "still.urdf"], &["j1", "--velocity"]);
}

#[test]
fn commands_for_a_replay_say_what_they_show() {
    let folder = Folder::new();
    let said = folder.good(&[
        "--robot",
        "ur5",
        "--replay",
        "--rate",
        "50",
        "--out",
        "commands.csv",
    ]);
    for fragment in [
        "ramp shoulder_pan_joint: ",
        "steps wrist_3_joint: ",
        "holds: ",
        "sweep: ",
        "Collisions are not checked",
    ] {
        assert!(said.contains(fragment), "no `{fragment}` in {said}");
    }
    let (header, rows) = table(&folder.path("commands.csv"));
    assert!(header.iter().any(|h| h == "q_ref6") && header.iter().any(|h| h == "qd_ref6"));
    // A ramp and steps of each joint, holds and a sweep: some minutes, all numbers.
    assert!(
        (120 * 50..900 * 50).contains(&rows.len()),
        "{} rows",
        rows.len()
    );
    assert!(rows.iter().flatten().all(|v| v.is_finite()));
    folder.refused(
        &["--replay", "--tool-box=-1:1,-1:1,0:1"],
        &["regions of the tool", "--position"],
    );
    folder.refused(&["--replay", "--plan"], &["cannot be used with"]);
    folder.refused(
        &["--replay", "--position=-1:1", "--home=1,0,0,0,0,0"],
        &["shoulder_pan_joint cannot move", "--home"],
    );
}
