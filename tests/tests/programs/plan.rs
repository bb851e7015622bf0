//! `feedforward` on planned motions of an arm with limits.

use datasets::{ReadOptions, Recording, read};
use feedforward::Feedforward;
use ndarray::Array2;
use physics::robot::{Limits, Robot, to_urdf};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use tempfile::TempDir;
use tests::program::{Ended, program, run};
use tests::synthetic::{Plan, record_to};

/// Trained once: a UR5 whose fourth joint gives at most 10 N·m, and turns at most 2 rad/s.
fn made() -> &'static TempDir {
    static MADE: OnceLock<TempDir> = OnceLock::new();
    MADE.get_or_init(|| {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let robot = Robot::builtin("ur5").expect("built in");
        let mut joints = robot.joints().to_vec();
        joints[3].limits = Limits {
            lower: -2.0,
            upper: 2.0,
            velocity: 2.0,
            effort: 10.0,
        };
        let robot = Robot::new("limited", joints).expect("the same arm");
        let urdf = folder.path().join("robot.urdf");
        std::fs::write(&urdf, to_urdf(&robot)).expect("a description");
        let data = record_to(folder.path(), "train.csv", &robot, &Plan::default());
        let mut train = program("train");
        train.arg("--robot").arg(&urdf).arg("--data").arg(&data);
        train.args(["--physics-only", "--basic", "--quiet", "--out"]);
        run(train.arg(folder.path().join("model"))).succeeded();
        folder
    })
}

fn path(name: &str) -> PathBuf {
    made().path().join(name)
}

/// Every joint swings with half its span `swing` (rad) at `w` rad/s for 4 s, 200 samples a second; with derivatives.
fn planned(swing: f64, w: f64) -> Recording {
    let time: Vec<f64> = (0..800).map(|k| k as f64 * 0.005).collect();
    let table = |f: &dyn Fn(f64) -> f64| {
        Array2::from_shape_fn((time.len(), 6), |(k, j)| {
            swing * f(w * time[k] + 0.3 * j as f64)
        })
    };
    let (q, qd, qdd) = (
        table(&f64::sin),
        table(&f64::cos) * w,
        table(&|x| -x.sin()) * w * w,
    );
    Recording {
        qd: Some(qd),
        qdd: Some(qdd),
        ..Recording::new("plan", time.clone(), q, None)
    }
}

fn feedforward(plan: &Path, out: &Path, extra: &[&str]) -> Ended {
    let mut command = program("feedforward");
    command
        .arg("--model")
        .arg(path("model"))
        .arg("--trajectory")
        .arg(plan);
    run(command.arg("--out").arg(out).args(extra))
}

fn written(plan: &Recording, name: &str) -> PathBuf {
    let place = made().path().join(name);
    datasets::write(plan, &place).expect("a plan");
    place
}

#[test]
fn the_torque_of_the_loop_in_every_format_and_unit() {
    let plan = planned(0.3, 1.0);
    let mut model = Feedforward::load(&path("model"), Some(0.005)).expect("a model");
    let mut expected = Array2::zeros((plan.len(), 6));
    let mut tau = [0.0; 6];
    model.reset(None);
    for row in 0..plan.len() {
        let part = |t: &Array2<f64>| t.row(row).to_vec();
        let (q, qd, qdd) = (
            part(&plan.q),
            part(plan.qd.as_ref().unwrap()),
            part(plan.qdd.as_ref().unwrap()),
        );
        model.torque(&q, &qd, &qdd, &mut tau);
        expected
            .row_mut(row)
            .iter_mut()
            .zip(tau)
            .for_each(|(cell, t)| *cell = t);
    }
    let options = ReadOptions::for_robot(6);
    for name in ["plan.csv", "plan.parquet"] {
        let out = path(&format!("out-{name}"));
        feedforward(&written(&plan, name), &out, &["--quiet"]).succeeded();
        let filled = read(&out, &options).expect("a table with torque");
        assert_eq!(
            (&filled.q, &filled.qd, &filled.qdd),
            (&plan.q, &plan.qd, &plan.qdd)
        );
        let found = filled.tau.expect("torque");
        assert!((found - &expected).iter().all(|d| d.abs() < 1e-9));
    }
    // The same motion as a reference.
    let motion = signal::Motion {
        time: plan.time.clone(),
        segments: plan.segments(),
        q: plan.q.clone(),
        qd: plan.qd.clone().unwrap(),
        qdd: plan.qdd.clone().unwrap(),
    };
    let reference = path("reference.csv");
    datasets::write_reference(&motion, &["a".to_owned()], &reference).expect("a plan");
    let out = path("out-reference.csv");
    feedforward(&reference, &out, &[]).succeeded();
    let found = read(&out, &options).expect("a table").tau.expect("torque");
    assert!((found - &expected).iter().all(|d| d.abs() < 1e-9));
    // Without derivatives: nearly the same torque.
    let bare = Recording {
        qd: None,
        qdd: None,
        ..plan.clone()
    };
    let out = path("out-bare.csv");
    feedforward(&written(&bare, "bare.csv"), &out, &["--quiet"]).succeeded();
    let found = read(&out, &options).expect("a table").tau.expect("torque");
    let size = expected.iter().fold(0.0_f64, |m, t| m.max(t.abs()));
    // Coulomb friction turns round a sample earlier or later; away from reversals a hundredth is left.
    let near = (&found - &expected)
        .iter()
        .filter(|d| d.abs() < 0.01 * size)
        .count();
    assert!(
        near as f64 > 0.98 * found.len() as f64,
        "{near} of {}",
        found.len()
    );
    // 10 N·m per ampere at the joint.
    let drive = path("drive.toml");
    std::fs::write(
        &drive,
        "gear_ratio = [100,100,100,100,100,100]\ntorque_constant = [0.1,0.1,0.1,0.1,0.1,0.1]",
    )
    .expect("a drive file");
    let out = path("out-ampere.csv");
    let drive = drive.to_str().expect("a path");
    feedforward(
        &path("plan.csv"),
        &out,
        &["--unit", "ampere", "--drive", drive],
    )
    .succeeded();
    let found = read(&out, &options)
        .expect("a table")
        .tau
        .expect("currents");
    assert!((found * 10.0 - &expected).iter().all(|d| d.abs() < 1e-9));
    feedforward(
        &path("plan.csv"),
        &out,
        &["--unit", "per_mille", "--drive", drive],
    )
    .refused(&["rated_current"]);
    feedforward(&path("plan.csv"), &out, &["--unit", "ampere"]).refused(&["gear_ratio"]);
}

#[test]
fn a_plan_that_breaks_a_limit_is_refused_with_the_speed_that_holds() {
    // At most 4 rad/s, twice what joint 4 may: half the speed, less what the torque asks for.
    let fast = planned(1.0, 4.0);
    let out = path("never.csv");
    let refused = feedforward(&written(&fast, "fast.csv"), &out, &[]);
    let names = Robot::builtin("ur5").expect("built in").joint_names();
    refused.refused(&[&names[3], " at "]);
    assert!(!out.exists());
    let factor: f64 = refused
        .err
        .split_whitespace()
        .find_map(|w| {
            w.parse()
                .ok()
                .filter(|f| (0.0..1.0).contains(f) && w.len() == 4)
        })
        .unwrap_or_else(|| panic!("no factor: {}", refused.err));
    assert!((0.05..=0.5).contains(&factor), "{factor}");
    // It holds, and a twentieth more does not.
    feedforward(&written(&planned(1.0, 4.0 * factor), "slow.csv"), &out, &[]).succeeded();
    feedforward(
        &written(&planned(1.0, 4.0 * (factor + 0.05)), "again.csv"),
        &path("no.csv"),
        &[],
    )
    .refused(&[&names[3]]);
    // A position is mended by no speed.
    let far = planned(2.5, 0.2);
    let refused = feedforward(&written(&far, "far.csv"), &path("no.csv"), &[]);
    refused.refused(&[&names[3], "stands at"]);
    assert!(refused.err.contains("No speed"), "{}", refused.err);
}

/// Waypoints as MoveIt gives them, every 0.1 s and the last one sooner, as JointTrajectory messages and as YAML.
#[test]
fn waypoints_of_a_joint_trajectory_get_their_effort() {
    let dense = planned(0.3, 1.0);
    let rows: Vec<usize> = (0..790).step_by(20).chain([797]).collect();
    let pick = |t: &Array2<f64>| t.select(ndarray::Axis(0), &rows);
    let sparse = Recording {
        qd: dense.qd.as_ref().map(pick),
        qdd: dense.qdd.as_ref().map(pick),
        ..Recording::new(
            "waypoints",
            rows.iter().map(|&r| dense.time[r]).collect(),
            pick(&dense.q),
            None,
        )
    };
    let names = Robot::builtin("ur5").expect("built in").joint_names();
    // Messages may have the joints in any order.
    let order = [2, 0, 1, 5, 4, 3];
    let turned = |t: &Array2<f64>| t.select(ndarray::Axis(1), &order);
    let message = Recording {
        qd: sparse.qd.as_ref().map(turned),
        qdd: sparse.qdd.as_ref().map(turned),
        q: turned(&sparse.q),
        ..sparse.clone()
    };
    let turned: Vec<String> = order.iter().map(|&j| names[j].clone()).collect();
    let bag = path("waypoints.mcap");
    datasets::write::write_trajectories(&message, &turned, &bag).expect("a bag");
    let out = path("out-waypoints.csv");
    feedforward(&bag, &out, &["--quiet"]).succeeded();
    let filled = read(&out, &ReadOptions::for_robot(6)).expect("a table with torque");
    // Messages hold whole nanoseconds.
    let on_time = |times: &[f64]| {
        times
            .iter()
            .zip(&sparse.time)
            .all(|(a, b)| (a - b).abs() < 1e-9)
    };
    assert!(filled.q == sparse.q && on_time(&filled.time));
    let whole = path("out-whole.csv");
    feedforward(&written(&dense, "whole.csv"), &whole, &["--quiet"]).succeeded();
    let whole = read(&whole, &ReadOptions::for_robot(6))
        .expect("a table")
        .tau
        .expect("torque");
    let found = filled.tau.expect("torque");
    let worst = (&found - &pick(&whole))
        .iter()
        .fold(0.0_f64, |m, d| m.max(d.abs()));
    let size = whole.iter().fold(0.0_f64, |m, t| m.max(t.abs()));
    assert!(worst < 0.01 * size, "{worst} of {size}");
    // As messages again: the same effort, and names in the robot's order.
    let again = path("filled.mcap");
    feedforward(&bag, &again, &["--quiet"]).succeeded();
    let plan = datasets::read::planned_trajectories(&again, &names)
        .expect("a bag")
        .expect("a plan");
    assert!(plan.q == sparse.q && on_time(&plan.time));
    let yaml = path("filled.yaml");
    feedforward(&bag, &yaml, &["--quiet"]).succeeded();
    let text = std::fs::read_to_string(&yaml).expect("a text");
    let efforts = text
        .lines()
        .filter(|l| l.trim_start().starts_with("effort: ["));
    assert_eq!(efforts.clone().count(), rows.len());
    let first = efforts
        .map(|l| l.trim_start().trim_start_matches("effort: [").to_owned())
        .next();
    let first = first
        .expect("a point")
        .split(',')
        .next()
        .and_then(|v| v.parse::<f64>().ok());
    assert!(
        first.is_some_and(|v| (v - found[[0, 0]]).abs() < 1e-9),
        "{first:?}"
    );
    // A bag of another robot's plan.
    let other: Vec<String> = (0..6).map(|j| format!("axis{j}")).collect();
    let bag = path("other.mcap");
    datasets::write::write_trajectories(&sparse, &other, &bag).expect("a bag");
    feedforward(&bag, &path("no.csv"), &[]).refused(&["joint `", "axis0"]);
}

#[test]
fn what_is_no_plan() {
    let plan = planned(0.3, 1.0);
    feedforward(&path("plan-none.csv"), &path("no.csv"), &[]).refused(&["plan-none.csv"]);
    let good = written(&plan, "good.csv");
    feedforward(&good, &path("no.xlsx"), &[]).refused(&["no.xlsx"]);
    let mut other = program("feedforward");
    other
        .arg("--model")
        .arg(made().path())
        .arg("--trajectory")
        .arg(&good);
    run(other.arg("--out").arg(path("no.csv"))).refused(&["model.json"]);
    // A recording with other joints than the model's.
    let two = Recording::new(
        "two",
        plan.time.clone(),
        Array2::zeros((plan.len(), 2)),
        None,
    );
    feedforward(&written(&two, "two.csv"), &path("no.csv"), &[]).refused(&["two.csv"]);
}
