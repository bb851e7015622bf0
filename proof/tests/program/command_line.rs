//! Exit codes and messages of the command line.

use crate::case::{Case, URDF, causes, cut, recording, rubbing, run};

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
        "--gravity",
        "0,0,-9.81",
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
    for moved in report["moved_parameters"].as_array().unwrap() {
        let number = |key: &str| moved[key].as_f64().unwrap();
        let deviations = (number("value") - number("given")).abs() / number("std");
        assert!(
            (deviations - number("deviations")).abs() < 1e-6 * deviations,
            "{moved}"
        );
    }
    assert!(
        std::fs::read_to_string(&html)
            .unwrap()
            .starts_with("<!doctype html>")
    );
    assert!(physics::robot::Robot::from_urdf_file(&patch).is_ok());
    let said = String::from_utf8_lossy(&out.stdout);
    assert!(said.contains("nonlinear viscous friction on j1"), "{said}");
}

/// How friction comes to rest is nobody's law: neither of two others than the model's is a structure of its own.
#[test]
fn friction_that_builds_up_slowly_is_no_structure() {
    let laws: [fn(f64) -> f64; 2] = [
        |v| v / v.hypot(0.012),
        |v| (v / 0.005).atan() * std::f64::consts::FRAC_2_PI,
    ];
    for law in laws {
        let friction = |v: f64| 0.4 * v + 0.3 * law(v);
        let case = Case::new(
            &rubbing(friction, 0.0, 6, 1500),
            &rubbing(friction, 0.45, 6, 1500),
        );
        let report = case.report(&[]);
        let named = causes(&report);
        assert!(
            named.iter().all(|&c| c == "friction_parameters"),
            "{named:?}"
        );
    }
}

/// Torque that is not the torque of the joint: said first, with the scale.
#[test]
fn torque_in_amperes_is_said() {
    let amperes = |text: String| -> String {
        let lines = text.lines().enumerate().map(|(i, line)| {
            let (rest, tau) = line.rsplit_once(',').unwrap();
            match tau.parse::<f64>() {
                Ok(tau) if i > 0 => format!("{rest},{}\n", 0.08 * tau),
                _ => format!("{line}\n"),
            }
        });
        lines.collect()
    };
    let case = Case::new(
        &amperes(recording(0.0, 0.0)),
        &amperes(recording(0.0, 0.45)),
    );
    let report = case.report(&[]);
    let finding = &report["recordings"][0]["findings"][0];
    assert_eq!(finding["kind"], "torque_scale", "{report:#}");
    assert!(
        (finding["value"].as_f64().unwrap() - 0.08).abs() < 0.004,
        "{finding}"
    );
    let out = case.diagnose(&["--robot", "@arm.urdf"], &[]);
    let said = String::from_utf8_lossy(&out.stdout);
    let second = said.lines().nth(1).unwrap();
    assert!(
        second.contains("0.08") && second.contains("--drive"),
        "{said}"
    );
}

#[test]
fn ten_seconds_hide_some_effects() {
    let case = Case::new(&cut(0.25, 0.0, 1, 1250), &recording(0.25, 0.45));
    let report = case.report(&[]);
    let hidden = report["not_identifiable"].as_array().unwrap();
    assert!(
        hidden.iter().any(|n| n["effect"] == "friction_drift"),
        "{hidden:?}"
    );
    assert!(
        hidden
            .iter()
            .all(|n| n["reason"].as_str().unwrap().contains("record"))
    );
}

/// Half the rate: allowed, said, and scored at its own samples.
#[test]
fn a_heldout_recording_of_another_rate_is_resampled() {
    let every_second = |text: String| -> String {
        let lines = text.lines().enumerate();
        let kept = lines.filter(|(i, _)| *i == 0 || i % 2 == 1);
        kept.map(|(_, line)| format!("{line}\n")).collect()
    };
    let case = Case::new(&recording(0.25, 0.0), &every_second(recording(0.25, 0.45)));
    let report = case.report(&[]);
    assert_eq!(causes(&report)[0], "nonlinear_viscous_friction");
    assert!(report["causes"][0]["gap_closed"].as_f64().unwrap() > 0.9);
    let notes = report["notes"].as_array().unwrap();
    let said = |n: &serde_json::Value| n.as_str().unwrap().contains("different rates");
    assert!(notes.iter().any(said), "{notes:?}");
    assert_eq!(report["recordings"][1]["samples"], 6 * 750);
}

#[test]
fn a_joint_that_never_moves_hides_its_effects() {
    let two = URDF.replace(
        "</robot>",
        r#"<link name="l2"><inertial><origin xyz="0.1 0 0"/><mass value="0.5"/>
<inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>
<joint name="j2" type="revolute"><parent link="l1"/><child link="l2"/><origin xyz="0.3 0 0"/><axis xyz="0 1 0"/>
<limit lower="-2" upper="2" velocity="3" effort="50"/></joint></robot>"#,
    );
    let stiff = |text: String| -> String {
        let rows = text.lines().enumerate().map(|(i, line)| {
            let more = if i == 0 { "q2,tau2" } else { "0.2,0" };
            format!("{line},{more}\n")
        });
        rows.collect()
    };
    let case = Case::new(&stiff(recording(0.25, 0.0)), &stiff(recording(0.25, 0.45)));
    case.write("arm.urdf", &two);
    let report = case.report(&[]);
    let hidden = report["not_identifiable"].as_array().unwrap();
    let of_second = hidden
        .iter()
        .filter(|n| n["joints"][0] == "j2" && n["joints"][1].is_null() && !n["effect"].is_null());
    assert_eq!(
        of_second.count(),
        diagnose::Effect::ALL.len(),
        "every effect of the still joint"
    );
    let named = report["causes"].as_array().unwrap();
    assert!(
        named
            .iter()
            .all(|c| c["joints"] != serde_json::json!(["j2"])),
        "{named:?}"
    );
    assert!(report["ladder"][0]["nrmse"][1].is_null());
}

/// Another robot's recording, a missing one, a cut one, a folder that is not there: refused, nothing written.
#[test]
fn what_cannot_be_used_leaves_nothing_behind() {
    let good = cut(0.0, 0.0, 1, 1250);
    let bad: [(&str, &str); 2] = [
        ("time,q1,q2,tau1,tau2\n0,0,0,1,1\n0.1,0,0,1,1\n", "b.csv"),
        ("time,q1,tau1\n0,0,1\n0.01,0,", "b.csv"),
    ];
    for (text, name) in bad {
        let case = Case::new(&good, text);
        let out = case.diagnose(
            &["--robot", "@arm.urdf"],
            &["--json", "@r.json", "--html", "@r.html"],
        );
        let said = String::from_utf8_lossy(&out.stderr);
        assert_eq!(out.status.code(), Some(2), "{said}");
        assert!(said.starts_with("error: ") && said.contains(name), "{said}");
        assert!(!case.path("r.json").exists() && !case.path("r.html").exists());
    }
    let case = Case::new(&good, &good);
    std::fs::remove_file(case.path("b.csv")).unwrap();
    let out = case.diagnose(&["--robot", "@arm.urdf"], &[]);
    assert_eq!(out.status.code(), Some(2));
    let out = case.diagnose(&["--model", "@nowhere"], &[]);
    assert_eq!(out.status.code(), Some(2));
    let case = Case::new(&good, &cut(0.0, 0.45, 1, 1250));
    let out = case.diagnose(&["--robot", "@arm.urdf"], &["--json", "@no/folder/r.json"]);
    assert_eq!(out.status.code(), Some(2));
    assert!(out.stdout.is_empty());
}

/// The same bytes on one thread and on two.
#[test]
fn threads_change_nothing() {
    let case = Case::new(&cut(0.25, 0.0, 4, 1000), &cut(0.25, 0.45, 2, 1000));
    let reports = ["1", "2"].map(|threads| {
        let path = |name: &str| case.path(name).display().to_string();
        let json = path(&format!("r{threads}.json"));
        let status = std::process::Command::new(env!("CARGO_BIN_EXE_diagnose"))
            .env("RAYON_NUM_THREADS", threads)
            .args(["--robot", &path("arm.urdf"), "--data", &path("a.csv")])
            .args(["--heldout", &path("b.csv"), "--learn", "--json", &json])
            .output()
            .unwrap()
            .status;
        assert!(status.success());
        std::fs::read_to_string(json).unwrap()
    });
    assert_eq!(reports[0], reports[1]);
}
