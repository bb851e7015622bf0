//! Prints what the programs make of descriptions in the style of real ones: loaded, chain, what is said, first result.
//!
//! `cargo run --release -p residyn-tests --example descriptions > docs/descriptions.md`, after
//! `cargo build --release --bins`. The files are those of `physics/tests/fixtures/descriptions`. For each that is loaded
//! an arm is recorded that has its geometry, friction that it does not describe, and its masses; where it describes
//! none, links of 3, 2.4, 1.92 … kg, of which each hangs in its middle. `diagnose --fast` compares both.

use nalgebra::{Matrix3, Vector3};
use physics::robot::{Description, Inertia, Masses, Robot};
use serde_json::Value;
use std::path::{Path, PathBuf};
use tests::program::{json, program, run};
use tests::synthetic::{Plan, record_to};

/// Mass of the first link of an arm whose description has none, kg; each next one's is this part of the one before.
const FIRST: f64 = 3.0;
const NEXT: f64 = 0.8;

/// Letters of a message that are printed.
const MOST: usize = 150;

fn main() {
    let folder =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../physics/tests/fixtures/descriptions");
    let expected =
        std::fs::read_to_string(folder.join("expected.tsv")).expect("the list of fixtures");
    let asked: Vec<(String, String)> = expected
        .lines()
        .skip(1)
        .filter_map(|line| {
            let mut cells = line.split('\t');
            Some((cells.next()?.to_owned(), cells.next()?.to_owned()))
        })
        .collect();
    let rows: Vec<[String; 5]> = asked
        .iter()
        .map(|(file, joints)| row(&folder, file, joints))
        .collect();
    println!(
        "# Descriptions in the style of real ones\nWhat the programs make of {} descriptions, each with the `--joints` that \
         it is asked for. The files are in `physics/tests/fixtures/descriptions`.\n\n    cargo build --release --bins\n    \
         cargo run --release -p residyn-tests --example descriptions\n\nThe recording is of an arm with the description's \
         geometry and masses. It has friction that the description lacks, and a ripple \
         of the torque on every joint. Where masses are missing or cannot be relied on, \
         the recorded arm has other ones. The first result is that of `diagnose --fast`: the verdict, mean NRMSE on \
         held-out trajectories as given → with the causes, and the causes, the biggest first.\n",
        rows.len()
    );
    println!(
        "| description, `--joints` | loaded | chain | said | first result |\n|---|---|---|---|---|"
    );
    for row in rows {
        println!(
            "| {} |",
            row.map(|cell| cell.replace('|', "\\|")).join(" | ")
        );
    }
}

fn row(folder: &Path, file: &str, joints: &str) -> [String; 5] {
    let name = match joints {
        "" => format!("`{file}`"),
        joints => format!("`{file}` `{joints}`"),
    };
    let names: Vec<String> = joints
        .split(',')
        .filter(|j| !j.is_empty())
        .map(str::to_owned)
        .collect();
    let path = folder.join(file);
    match Description::load(&path, &names) {
        Err(error) => {
            let text = error
                .to_string()
                .replace(&format!("{}/", folder.display()), "");
            [
                name,
                "refused".to_owned(),
                String::new(),
                shortened(&text),
                "–".to_owned(),
            ]
        }
        Ok((_, robot)) => {
            let findings = robot.findings().iter().map(ToString::to_string);
            let said: Vec<String> = findings.chain(robot.notes().iter().cloned()).collect();
            [
                name,
                "yes".to_owned(),
                robot.joint_names().join(", "),
                said.iter()
                    .map(|s| shortened(s))
                    .collect::<Vec<_>>()
                    .join("; "),
                first_result(&path, joints, &robot),
            ]
        }
    }
}

/// What `diagnose` says first of a recording of the arm that a description is meant to describe.
fn first_result(description: &Path, joints: &str, robot: &Robot) -> String {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let recorded = |name: &str, seed: u64| {
        let plan = Plan {
            seconds: 10.0,
            seed,
            ..Plan::default()
        };
        record_to(folder.path(), name, &real(robot), &plan)
    };
    let report: PathBuf = folder.path().join("report.json");
    let mut diagnose = program("diagnose");
    diagnose.args(["--fast", "--robot"]).arg(description);
    if !joints.is_empty() {
        diagnose.args(["--joints", joints]);
    }
    diagnose.arg("--data").arg(recorded("train.csv", 1));
    diagnose.arg("--heldout").arg(recorded("test.csv", 2));
    let ended = run(diagnose.arg("--json").arg(&report));
    if ended.status != 0 {
        return shortened(ended.err.lines().next().unwrap_or_default());
    }
    let report = json(&report);
    let text = |v: &Value| v.as_str().unwrap_or_default().replace('_', " ");
    let list = |key: &str| report[key].as_array().cloned().unwrap_or_default();
    let mean = |step: Option<&Value>| {
        step.and_then(|s| s["mean_nrmse"].as_f64())
            .unwrap_or(f64::NAN)
    };
    let (ladder, causes) = (list("ladder"), list("causes"));
    let named: Vec<String> = causes.iter().map(|c| text(&c["effect"])).collect();
    format!(
        "{}: {:.3} → {:.3}; {}",
        text(&report["verdict"]),
        mean(ladder.first()),
        mean(ladder.last()),
        named.join(", ")
    )
}

/// The arm that is recorded.
fn real(robot: &Robot) -> Robot {
    if robot.masses() == Masses::Described && robot.doubtful_links().iter().all(|d| !d) {
        return robot.clone();
    }
    let joints = robot.joints();
    let parameters: Vec<f64> = (0..joints.len())
        .flat_map(|k| {
            let mass = FIRST * NEXT.powi(k as i32);
            let end = joints
                .get(k + 1)
                .map_or(Vector3::new(0.08, 0.02, 0.05), |j| j.translation);
            let radius = (0.3 * end.norm()).max(0.04);
            let about = Matrix3::identity() * (0.4 * mass * radius * radius);
            Inertia::from_com(mass, 0.5 * end, about).parameters()
        })
        .collect();
    robot.with_parameters(&parameters).expect("ten a link")
}

fn shortened(text: &str) -> String {
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    match text.char_indices().nth(MOST) {
        Some((at, _)) => format!("{}…", &text[..at]),
        None => text,
    }
}
