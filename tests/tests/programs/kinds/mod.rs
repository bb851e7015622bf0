//! The kinds of small inputs of `repro.rs`, three more of each, made here: other arms, other names, other numbers.

mod descriptions;
mod recordings;

use datasets::Recording;
use physics::robot::Robot;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use tests::csv::Csv;
use tests::program::{program, run};
use tests::synthetic::{Plan, record};

/// What would make a user multiply a right torque.
const UNIT: [&str; 2] = ["torque_scale = [", "motor current in A."];

/// Joints (name, axis, length of the link before, m) and links (mass, kg, and centre of mass, m) of three arms.
type Arm = &'static [(&'static str, &'static str, f64, f64, [f64; 3])];
const ARMS: [Arm; 3] = [
    &[
        ("turn", "0 0 1", 0.2, 9.0, [0.02, 0.0, 0.1]),
        ("lift", "0 1 0", 0.15, 6.0, [0.03, 0.01, 0.17]),
        ("reach", "0 1 0", 0.35, 2.2, [0.01, -0.02, 0.14]),
    ],
    &[
        ("shoulder_pan", "0 0 1", 0.1, 5.0, [0.01, 0.03, 0.05]),
        ("shoulder_lift", "0 1 0", 0.12, 4.0, [0.0, 0.02, 0.16]),
        ("elbow_flex", "0 1 0", 0.3, 2.5, [0.02, 0.0, 0.12]),
        ("wrist_flex", "1 0 0", 0.25, 1.1, [0.03, 0.01, 0.08]),
    ],
    &[
        ("swing", "0 1 0", 0.4, 12.0, [0.05, 0.0, 0.2]),
        ("bend", "0 1 0", 0.45, 7.0, [0.0, 0.04, 0.2]),
        ("roll", "1 0 0", 0.4, 3.0, [0.05, 0.02, 0.15]),
    ],
];

/// A description. `scale` multiplies masses and inertias by link, `fixed` replaces them, `extra` stands behind the arm; `friction` by joint.
#[derive(Default)]
pub(super) struct Urdf<'a> {
    pub arm: usize,
    pub scale: &'a [f64],
    pub fixed: Option<&'a str>,
    pub extra: &'a str,
    pub friction: &'a [[f64; 2]],
}

impl Urdf<'_> {
    pub fn text(&self) -> String {
        let mut text = String::from("<robot name=\"made\">\n<link name=\"base\"/>\n");
        let mut parent = "base".to_owned();
        for (k, (name, axis, before, mass, [x, y, z])) in ARMS[self.arm].iter().enumerate() {
            let mass = mass * self.scale.get(k).unwrap_or(&1.0);
            let (i, l) = (0.012 * mass, format!("l{}", k + 1));
            let own = format!(
                r#"<inertial><origin xyz="{x} {y} {z}"/><mass value="{mass}"/><inertia ixx="{i}" ixy="0" ixz="0" iyy="{}" iyz="0" izz="{}"/></inertial>"#,
                1.1 * i,
                0.7 * i
            );
            let inertial = self.fixed.unwrap_or(&own);
            let lost = self.friction.get(k).map_or_else(String::new, |[v, c]| {
                format!(r#"<dynamics damping="{v}" friction="{c}"/>"#)
            });
            write!(
                text,
                r#"<link name="{l}">{inertial}</link>
<joint name="{name}" type="revolute"><parent link="{parent}"/><child link="{l}"/><origin xyz="0 0 {before}"/><axis xyz="{axis}"/><limit lower="-3" upper="3" effort="300" velocity="4"/>{lost}</joint>
"#
            )
            .expect("a String takes text");
            parent = l;
        }
        text + self.extra + "</robot>\n"
    }
}

pub(super) fn robot(arm: usize) -> Robot {
    let text = Urdf {
        arm,
        ..Urdf::default()
    }
    .text();
    Robot::from_urdf_str(&text).expect("a description in order")
}

fn recorded(robot: &Robot, seed: u64) -> Recording {
    let plan = Plan {
        trajectories: 1,
        seconds: 20.0,
        seed,
        ..Plan::default()
    };
    record(robot, &plan)
}

/// A folder with a description and a recording; what the program answers on one line.
struct Made {
    folder: tempfile::TempDir,
    robot: PathBuf,
}

impl Made {
    fn new(name: &str, description: &str) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let robot = folder.path().join(name);
        std::fs::write(&robot, description).expect("writable");
        Self { folder, robot }
    }

    fn arm(arm: usize) -> Self {
        Self::new(
            "arm.urdf",
            &Urdf {
                arm,
                ..Urdf::default()
            }
            .text(),
        )
    }

    fn answer(&self, data: &Path) -> String {
        let mut train = program("train");
        train.args(["--check-only", "--robot"]).arg(&self.robot);
        let ended = run(train.arg("--data").arg(data));
        let said = format!("{}\n{}", ended.out, ended.err);
        said.split_whitespace().collect::<Vec<_>>().join(" ")
    }

    fn to(&self, csv: &Csv, separator: &str) -> String {
        let path = self.folder.path().join("data.csv");
        let lines = std::iter::once(&csv.header).chain(&csv.rows);
        let lines: Vec<String> = lines.map(|cells| cells.join(separator)).collect();
        std::fs::write(&path, lines.join("\n") + "\n").expect("writable");
        self.answer(&path)
    }

    /// To a recording as this workspace writes it.
    fn to_plain(&self, recording: &Recording) -> String {
        let path = self.folder.path().join("data.parquet");
        datasets::write(recording, &path).expect("writable");
        self.answer(&path)
    }
}

#[track_caller]
fn says(answer: &str, said: &[&str], unsaid: &[&str]) {
    for part in said {
        assert!(answer.contains(part), "no `{part}` in {answer}");
    }
    for part in unsaid {
        assert!(!answer.contains(part), "`{part}` in {answer}");
    }
}
