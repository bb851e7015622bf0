//! Exit codes and messages of the command line.

use std::process::{Command, Output};

const URDF: &str = r#"<robot name="arm"><link name="base"/><link name="l1"><inertial><origin xyz="0.1 0 0"/><mass value="1"/>
<inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>
<joint name="j1" type="revolute"><parent link="base"/><child link="l1"/><axis xyz="0 1 0"/>
<limit lower="-2" upper="2" velocity="3" effort="50"/><dynamics damping="0.4" friction="0.3"/></joint></robot>"#;

fn run(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_diagnose"))
        .args(arguments)
        .output()
        .unwrap()
}

/// A pendulum's recording: the model's own torque, `extra`·q̇·|q̇| and a little noise on top.
fn recording(extra: f64, shift: f64) -> String {
    let mut text = String::from("trajectory,time,q1,tau1\n");
    let mut noise = 1u32;
    for trajectory in 0..6 {
        for i in 0..1500 {
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
            let tau = rigid + 0.4 * qd + 0.3 * qd.signum() + extra * qd * qd.abs() + e;
            text.push_str(&format!("{trajectory},{t},{q},{tau}\n"));
        }
    }
    text
}

#[test]
fn refuses_what_it_cannot_use_with_status_2() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    std::fs::write(path("arm.urdf"), URDF).unwrap();
    std::fs::write(path("bad.csv"), "time,q1,tau1\n0,0,1\n0.01,nan,1\n").unwrap();
    let json = path("report.json");
    let out = run(&[
        "--robot",
        &path("arm.urdf"),
        "--data",
        &path("bad.csv"),
        "--heldout",
        &path("bad.csv"),
        "--json",
        &json,
    ]);
    assert_eq!(out.status.code(), Some(2));
    let said = String::from_utf8_lossy(&out.stderr);
    assert!(said.contains("bad.csv") && said.contains("q1"), "{said}");
    assert!(!std::path::Path::new(&json).exists());
    assert_eq!(
        run(&[
            "--robot",
            "no_such_robot",
            "--data",
            "x.csv",
            "--heldout",
            "x.csv"
        ])
        .status
        .code(),
        Some(2)
    );
    assert_eq!(run(&[]).status.code(), Some(2));
}

#[test]
fn names_quadratic_friction_and_writes_every_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    std::fs::write(path("arm.urdf"), URDF).unwrap();
    std::fs::write(path("a.csv"), recording(0.25, 0.0)).unwrap();
    std::fs::write(path("b.csv"), recording(0.25, 0.45)).unwrap();
    let (json, html, patch) = (path("r.json"), path("r.html"), path("p.urdf"));
    let out = run(&[
        "--robot",
        &path("arm.urdf"),
        "--data",
        &path("a.csv"),
        "--heldout",
        &path("b.csv"),
        "--json",
        &json,
        "--html",
        &html,
        "--patch",
        &patch,
    ]);
    assert_eq!(
        out.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&out.stderr)
    );
    let report: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(&json).unwrap()).unwrap();
    assert_eq!(report["schema"], "diagnosis/1");
    assert_eq!(
        report["causes"][0]["effect"], "nonlinear_viscous_friction",
        "{report:#}"
    );
    assert!(report["causes"][0]["gap_closed"].as_f64().unwrap() > 0.9);
    assert!(
        std::fs::read_to_string(&html)
            .unwrap()
            .starts_with("<!doctype html>")
    );
    assert!(physics::robot::Robot::from_urdf_file(&patch).is_ok());
    let said = String::from_utf8_lossy(&out.stdout);
    assert!(said.contains("nonlinear viscous friction on j1"), "{said}");
}
