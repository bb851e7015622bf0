//! A pendulum, its recordings, and runs of the program.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A pendulum.
pub const URDF: &str = r#"<robot name="arm"><link name="base"/><link name="l1"><inertial><origin xyz="0.1 0 0"/><mass value="1"/>
<inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>
<joint name="j1" type="revolute"><parent link="base"/><child link="l1"/><axis xyz="0 1 0"/>
<limit lower="-2" upper="2" velocity="3" effort="50"/><dynamics damping="0.4" friction="0.3"/></joint></robot>"#;

/// Runs the program.
pub fn run(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_diagnose"))
        .args(arguments)
        .output()
        .unwrap()
}

/// A pendulum's recording: the model's own torque, `extra`·q̇·|q̇| and a little noise on top.
pub fn recording(extra: f64, shift: f64) -> String {
    cut(extra, shift, 6, 1500)
}

/// The same with another number of trajectories and of samples in each.
pub fn cut(extra: f64, shift: f64, trajectories: u32, samples: u32) -> String {
    let friction = |qd: f64| 0.4 * qd + 0.3 * qd.signum() + extra * qd * qd.abs();
    rubbing(friction, shift, trajectories, samples)
}

/// The same with friction by another law of velocity, N·m.
pub fn rubbing(
    friction: impl Fn(f64) -> f64,
    shift: f64,
    trajectories: u32,
    samples: u32,
) -> String {
    let mut text = String::from("trajectory,time,q1,tau1\n");
    let mut noise = 1u32;
    for trajectory in 0..trajectories {
        for i in 0..samples {
            let t = f64::from(i) * 0.008;
            let a = f64::from(trajectory) + shift;
            let (w1, w2) = (1.7 + 0.1 * a, 3.9 - 0.13 * a);
            let q = 0.6 * (w1 * t + a).sin() + 0.3 * (w2 * t).sin();
            let qd = 0.6 * w1 * (w1 * t + a).cos() + 0.3 * w2 * (w2 * t).cos();
            let qdd = -0.6 * w1 * w1 * (w1 * t + a).sin() - 0.3 * w2 * w2 * (w2 * t).sin();
            // Rotation about y: gravity pulls the mass at +x towards positive q.
            let rigid = 0.02 * qdd - 0.1 * 9.81 * q.cos();
            noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let e = 0.004 * (f64::from(noise >> 8) / f64::from(1u32 << 24) - 0.5);
            let tau = rigid + friction(qd) + e;
            text.push_str(&format!("{trajectory},{t},{q},{tau}\n"));
        }
    }
    text
}

/// A folder with the pendulum `arm.urdf` and recordings `a.csv` and `b.csv`.
pub struct Case(tempfile::TempDir);

impl Case {
    /// Recordings as given.
    pub fn new(a: &str, b: &str) -> Self {
        let case = Self(tempfile::tempdir().unwrap());
        case.write("arm.urdf", URDF);
        case.write("a.csv", a);
        case.write("b.csv", b);
        case
    }

    /// Path of a file.
    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Writes a file.
    pub fn write(&self, name: &str, text: &str) {
        std::fs::write(self.path(name), text).unwrap();
    }

    /// Diagnoses `a.csv` and `b.csv`; names of files in `more` that begin with `@` are in the folder.
    pub fn diagnose(&self, given: &[&str], more: &[&str]) -> Output {
        let here = |x: &&str| {
            x.strip_prefix('@')
                .map_or_else(|| (*x).to_owned(), |x| self.path(x).display().to_string())
        };
        let files = ["--data", "@a.csv", "--heldout", "@b.csv"];
        let all: Vec<String> = given.iter().chain(&files).chain(more).map(here).collect();
        run(&all.iter().map(String::as_str).collect::<Vec<_>>())
    }

    /// The same with the pendulum; its report.
    pub fn report(&self, more: &[&str]) -> serde_json::Value {
        let out = self.diagnose(
            &["--robot", "@arm.urdf"],
            &[&["--json", "@r.json"], more].concat(),
        );
        let said = String::from_utf8_lossy(&out.stderr);
        assert_eq!(out.status.code(), Some(0), "{said}");
        json(&self.path("r.json"))
    }
}

/// A JSON file.
pub fn json(path: &Path) -> serde_json::Value {
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

/// Names of the causes of a report.
pub fn causes(report: &serde_json::Value) -> Vec<&str> {
    let list = report["causes"].as_array().unwrap();
    list.iter().map(|c| c["effect"].as_str().unwrap()).collect()
}
