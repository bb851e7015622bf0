//! Descriptions in the style of real ones (`fixtures/descriptions`): which chain each makes, and what is said of it.
//!
//! `cargo test --release -p residyn-physics --test robot descriptions -- --nocapture` prints the table.

use physics::dynamics::{Workspace, inverse_dynamics};
use physics::robot::{Description, Masses, Robot};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// A line of `expected.tsv`.
struct Expected {
    file: String,
    joints: Vec<String>,
    /// The chain's joints, or `refused`.
    chain: String,
    /// What must be said, and what must not.
    said: Vec<String>,
    not_said: String,
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/descriptions")
}

fn expected() -> Vec<Expected> {
    let text = std::fs::read_to_string(folder().join("expected.tsv")).unwrap();
    let list = |text: &str, by: char| -> Vec<String> {
        let words = text.split(by).filter(|w| !w.is_empty());
        words.map(str::to_owned).collect()
    };
    let line = |line: &str| {
        let cells: Vec<&str> = line.split('\t').collect();
        Expected {
            file: cells[0].to_owned(),
            joints: list(cells[1], ','),
            chain: cells[2].to_owned(),
            said: list(cells[3], '|'),
            not_said: cells[4].to_owned(),
        }
    };
    text.lines().skip(1).map(line).collect()
}

/// The chain, and all that is said: warnings and notes, or the refusal.
fn told(file: &str, joints: &[String]) -> (String, Vec<String>) {
    match Description::load(&folder().join(file), joints) {
        Ok((_, robot)) => {
            let warnings = robot.findings().iter().map(|f| format!("warning: {f}"));
            let notes = robot.notes().iter().map(|n| format!("note: {n}"));
            (
                robot.joint_names().join(","),
                warnings.chain(notes).collect(),
            )
        }
        Err(error) => {
            // The path to the file is this machine's.
            let text = error
                .to_string()
                .replace(&format!("{}/", folder().display()), "");
            ("refused".to_owned(), vec![text])
        }
    }
}

#[test]
fn every_description_makes_its_chain_and_is_judged() {
    let mut table = String::new();
    let mut wrong = Vec::new();
    for e in expected() {
        let (chain, said) = told(&e.file, &e.joints);
        let _ = writeln!(table, "{} {}\n  {chain}", e.file, e.joints.join(","));
        said.iter().for_each(|line| {
            let _ = writeln!(table, "    {line}");
        });
        let all = said.join("\n");
        let missing = e.said.iter().filter(|w| !all.contains(*w));
        let mut faults: Vec<String> = missing.map(|w| format!("does not say {w:?}")).collect();
        if chain != e.chain {
            faults.push(format!("{chain} instead of {}", e.chain));
        }
        if !e.not_said.is_empty() && all.contains(&e.not_said) {
            faults.push(format!("says {:?}", e.not_said));
        }
        if !faults.is_empty() {
            wrong.push(format!("{}: {}\n{all}", e.file, faults.join("; ")));
        }
    }
    println!("{table}");
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

#[test]
fn there_are_enough_of_them() {
    let mut files: Vec<String> = expected().into_iter().map(|e| e.file).collect();
    files.dedup();
    assert!(files.len() >= 25);
}

fn load(file: &str) -> Robot {
    Description::load(&folder().join(file), &[]).unwrap().1
}

#[test]
fn masses_are_described_placeholders_or_missing() {
    for (file, masses) in [
        ("in_order.urdf", Masses::Described),
        ("light_last_link.urdf", Masses::Described),
        ("no_masses.urdf", Masses::Missing),
        ("no_masses_zero.urdf", Masses::Missing),
        ("placeholders_hundredth.urdf", Masses::Placeholders),
        ("placeholders_unit.urdf", Masses::Placeholders),
        ("placeholders_most.urdf", Masses::Described),
    ] {
        assert_eq!(load(file).masses(), masses, "{file}");
    }
    assert_eq!(
        load("placeholders_most.urdf").doubtful_links(),
        [true, true, true, true, true, false]
    );
}

/// Back-EMF is damping: K² / R times the square of the gear, and stall torque over the speed without load.
#[test]
fn a_dc_motor_damps_its_joint() {
    let damping: Vec<f64> = load("dcmotor.xml")
        .joints()
        .iter()
        .map(|j| j.damping)
        .collect();
    let own = [0.8, 0.5, 0.24];
    let motors = [9.0 * 0.8 * 0.8 / 0.5, 0.5 * 0.6 / 0.4, 3.0 / 20.0];
    for ((found, own), motor) in damping.iter().zip(own).zip(motors) {
        assert!((found - own - motor).abs() < 1e-12, "{found} {own} {motor}");
    }
}

/// Copies carry mass; attached bodies stand where their frame does.
#[test]
fn copies_and_attached_models_are_read() {
    let bolts = load("replicate_bolts.xml");
    let mass = |j: usize| bolts.joints()[j].link.inertia.mass;
    // The first link's <inertial> stands for all of its own geoms.
    assert!((mass(0) - 4.0).abs() < 1e-12 && (mass(2) - 1.26).abs() < 1e-12);
    let arm = load("attach_arm.xml");
    assert!((arm.joints()[0].translation.z - 0.8).abs() < 1e-12);
    let rounded = load("rounded_right_angle.urdf");
    assert!(rounded.joints()[2].rotation[(2, 2)].abs() < 1e-15);
}

/// Torque of MuJoCo 4.0 (M q̈ + bias) for models with frames, copies and attached models, fingers at rest.
#[test]
fn what_mujoco_composes_weighs_the_same() {
    let arm = ["j1", "j2", "j3"].map(str::to_owned);
    for (file, expected) in [
        (
            "attach_arm.xml",
            [0.12512917443708982, 4.223850354073527, 0.23337706513232204],
        ),
        (
            "attach_world.xml",
            [0.12512917443708985, 4.223850354073527, 0.2333770651323218],
        ),
        (
            "attach_gripper.xml",
            [0.14813657608267286, 5.247322618201343, 0.4422780432849538],
        ),
        (
            "frames.xml",
            [
                -0.26364755421137465,
                2.236085243283416,
                -0.17002612957287888,
            ],
        ),
        (
            "replicate_bolts.xml",
            [-1.5597755045891177, 2.627966675025217, -0.1026154820481879],
        ),
    ] {
        let joints = if file == "attach_gripper.xml" {
            &arm[..]
        } else {
            &[]
        };
        let robot = Description::load(&folder().join(file), joints).unwrap().1;
        let (q, qd, qdd) = ([0.3, -0.7, 0.5], [0.4, -0.2, 0.6], [1.0, -1.0, 0.5]);
        let mut tau = [0.0; 3];
        inverse_dynamics(&robot, &mut Workspace::new(&robot), &q, &qd, &qdd, &mut tau);
        for (a, b) in tau.iter().zip(expected) {
            assert!((a - b).abs() < 1e-9, "{file}: {tau:?}");
        }
    }
}
