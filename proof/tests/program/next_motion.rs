//! A motion that resolves an ambiguity.

use crate::case::{Case, causes, json};
use serde_json::Value;

/// A pendulum with a spring of 0.8 N·m/rad that its model lacks: over a tenth of a radian a spring is a tilt.
fn torque(q: f64, qd: f64, qdd: f64) -> f64 {
    0.02 * qdd - 0.1 * 9.81 * q.cos() + 0.4 * qd + 0.3 * (qd / 1e-3).tanh() + 0.8 * q
}

struct Noise(u32);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        0.02 * (f64::from(self.0 >> 8) / f64::from(1u32 << 24) - 0.5)
    }
}

fn narrow(shift: f64) -> String {
    let (mut text, mut noise) = (String::from("trajectory,time,q1,tau1\n"), Noise(7));
    for trajectory in 0..6 {
        let a = f64::from(trajectory) + shift;
        for i in 0..1000 {
            let t = f64::from(i) * 0.008;
            let (w, x) = (1.7 + 0.1 * a, 0.1);
            let (s, c) = (w * t + a).sin_cos();
            let tau = torque(x * s, x * w * c, -x * w * w * s) + noise.next();
            text.push_str(&format!("{trajectory},{t},{},{tau}\n", x * s));
        }
    }
    text
}

/// The designed motion as the pendulum would record it.
fn run_motion(csv: &str) -> String {
    let (mut text, mut noise) = (String::from("trajectory,time,q1,tau1\n"), Noise(9));
    for line in csv.lines().skip(1) {
        let x: Vec<&str> = line.split(',').collect();
        let number = |i: usize| x[i].parse::<f64>().unwrap();
        let tau = torque(number(2), number(3), number(4)) + noise.next();
        text.push_str(&format!("next,{},{},{tau}\n", x[1], x[2]));
    }
    text
}

fn rivals(report: &Value) -> &Vec<Value> {
    report["causes"][0]["ambiguous_with"].as_array().unwrap()
}

#[test]
fn the_designed_motion_tells_a_spring_from_a_tilt() {
    let case = Case::new(&narrow(0.0), &narrow(0.5));
    let before = case.report(&["--next", "@next.csv"]);
    assert!(!rivals(&before).is_empty(), "{:#}", before["causes"]);
    let design = &before["next_experiment"];
    let evidence = |key: &str| design[key].as_f64().unwrap();
    assert!(
        evidence("evidence_expected") > 10.0 * evidence("evidence_recorded"),
        "{design}"
    );
    let motion = std::fs::read_to_string(case.path("next.csv")).unwrap();
    for line in motion.lines().skip(1) {
        let q: f64 = line.split(',').nth(2).unwrap().parse().unwrap();
        assert!(q.abs() <= 2.0, "within the limits of the URDF");
    }
    case.write("run.csv", &run_motion(&motion));
    let here = |name: &str| case.path(name).display().to_string();
    let out = crate::case::run(&[
        "--robot",
        &here("arm.urdf"),
        "--data",
        &here("a.csv"),
        &here("run.csv"),
        "--heldout",
        &here("b.csv"),
        "--json",
        &here("after.json"),
    ]);
    assert_eq!(
        out.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&out.stderr)
    );
    let after = json(&case.path("after.json"));
    assert_eq!(causes(&after)[0], "counterbalance", "{:#}", after["causes"]);
    assert!(rivals(&after).is_empty(), "{:#}", after["causes"]);
}
