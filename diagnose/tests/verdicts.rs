//! What a diagnosis comes to on recordings that say little, or whose held-out part is special.

use datasets::{Recording, Trajectory};
use diagnose::NominalModel;
use diagnose::{Options, diagnose};
use ndarray::Array2;
use physics::dynamics::{Workspace, inverse_dynamics};
use physics::robot::Robot;
use serde_json::{Value, json};

const JOINTS: usize = 3;
const RATE: f64 = 100.0;

/// A shoulder that turns about the vertical and two links that gravity loads.
const ARM: &str = r#"<robot name="arm"><link name="base"/>
<link name="shoulder"><inertial><mass value="4"/><inertia ixx="0.05" ixy="0" ixz="0" iyy="0.05" iyz="0" izz="0.05"/></inertial></link>
<link name="upper"><inertial><origin xyz="0.2 0 0"/><mass value="6"/><inertia ixx="0.02" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
<link name="fore"><inertial><origin xyz="0.2 0 0"/><mass value="3"/><inertia ixx="0.01" ixy="0" ixz="0" iyy="0.05" iyz="0" izz="0.05"/></inertial></link>
<joint name="j1" type="revolute"><parent link="base"/><child link="shoulder"/><axis xyz="0 0 1"/>
<limit lower="-3" upper="3" velocity="3" effort="200"/><dynamics damping="2" friction="3"/></joint>
<joint name="j2" type="revolute"><parent link="shoulder"/><child link="upper"/><origin xyz="0 0 0.2"/><axis xyz="0 1 0"/>
<limit lower="-3" upper="3" velocity="3" effort="200"/><dynamics damping="2" friction="3"/></joint>
<joint name="j3" type="revolute"><parent link="upper"/><child link="fore"/><origin xyz="0.4 0 0"/><axis xyz="0 1 0"/>
<limit lower="-3" upper="3" velocity="3" effort="200"/><dynamics damping="1" friction="1.5"/></joint></robot>"#;

fn arm() -> Robot {
    Robot::from_urdf_str(ARM).unwrap()
}

/// Uniform numbers in ±½.
struct Noise(u32);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(self.0 >> 8) / f64::from(1u32 << 24) - 0.5
    }
}

/// Torque beyond the model's by trajectory, time in it, q̇ of all joints and joint, N·m.
type Extra<'a> = dyn Fn(usize, f64, &[f64], usize) -> f64 + 'a;

/// What a recording shows.
struct Shown<'a> {
    seed: u32,
    trajectories: usize,
    seconds: f64,
    /// How far each joint moves, rad.
    reach: [f64; JOINTS],
    more: &'a Extra<'a>,
}

impl Shown<'_> {
    fn recording(&self) -> Recording {
        let robot = arm();
        let mut workspace = Workspace::new(&robot);
        let mut noise = Noise(self.seed);
        let n = (self.seconds * RATE) as usize;
        let rows = n * self.trajectories;
        let (mut time, mut q_all) = (Vec::new(), Array2::zeros((rows, JOINTS)));
        let mut tau_all = Array2::zeros((rows, JOINTS));
        let mut trajectories = Vec::new();
        for k in 0..self.trajectories {
            trajectories.push(Trajectory {
                label: format!("run{k}"),
                range: k * n..(k + 1) * n,
            });
            let a = f64::from(self.seed) + k as f64;
            for i in 0..n {
                let t = i as f64 / RATE;
                let (mut q, mut qd, mut qdd) = ([0.4; JOINTS], [0.0; JOINTS], [0.0; JOINTS]);
                for j in 0..JOINTS {
                    for (w, part) in [(1.1, 0.7), (2.3, 0.3)] {
                        let w = w + 0.13 * (a % 5.0) + 0.37 * j as f64;
                        let (sin, cos) = (w * t + a * (1.0 + j as f64)).sin_cos();
                        let size = part * self.reach[j];
                        q[j] += size * sin;
                        qd[j] += size * w * cos;
                        qdd[j] -= size * w * w * sin;
                    }
                }
                let mut tau = [0.0; JOINTS];
                inverse_dynamics(&robot, &mut workspace, &q, &qd, &qdd, &mut tau);
                time.push(20.0 * k as f64 + t);
                for j in 0..JOINTS {
                    let joint = &robot.joints()[j];
                    let sign = if self.reach[j] > 0.0 {
                        qd[j].signum()
                    } else {
                        0.2
                    };
                    let own = joint.damping * qd[j] + joint.friction * sign + 0.4 * noise.next();
                    q_all[[k * n + i, j]] = q[j] + 1e-6 * noise.next();
                    tau_all[[k * n + i, j]] = tau[j] + own + (self.more)(k, t, &qd, j);
                }
            }
        }
        let mut recording = Recording::new("shown", time, q_all, Some(tau_all));
        recording.trajectories = trajectories;
        recording
    }
}

fn nothing(_: usize, _: f64, _: &[f64], _: usize) -> f64 {
    0.0
}

/// The robot in motion, six runs of 12 s.
fn moving(seed: u32, more: &Extra<'_>) -> Recording {
    Shown {
        seed,
        trajectories: 6,
        seconds: 12.0,
        reach: [0.8, 0.5, 0.6],
        more,
    }
    .recording()
}

/// The robot at rest for three minutes.
fn standing(seed: u32, more: &Extra<'_>) -> Recording {
    Shown {
        seed,
        trajectories: 4,
        seconds: 15.0,
        reach: [0.0; JOINTS],
        more,
    }
    .recording()
}

fn report(data: &Recording, heldout: &Recording) -> Value {
    reported(data, heldout, &Options::default())
}

fn reported(data: &Recording, heldout: &Recording, options: &Options) -> Value {
    let outcome = diagnose(&NominalModel::new(arm()), data, heldout, options).unwrap();
    serde_json::to_value(&outcome.diagnosis).unwrap()
}

/// Drag on the first joint.
fn drag(_: usize, _: f64, qd: &[f64], j: usize) -> f64 {
    [2.5, 0.0, 0.0][j] * qd[j] * qd[j].abs()
}

/// Somebody leans on the arm for 1.2 s in every run, on the second joint and the first.
fn push(size: f64) -> impl Fn(usize, f64, &[f64], usize) -> f64 {
    move |run, t, _, j| {
        let since = t - 4.0 - run as f64;
        let shape = if (0.0..1.2).contains(&since) {
            (std::f64::consts::PI * since / 1.2).sin()
        } else {
            0.0
        };
        [0.6, 1.0, 0.0][j] * size * shape
    }
}

fn effects(report: &Value) -> Vec<&str> {
    let causes = report["causes"].as_array().unwrap();
    causes
        .iter()
        .map(|c| c["effect"].as_str().unwrap())
        .collect()
}

fn contact(report: &Value) -> Option<&Value> {
    let causes = report["causes"].as_array().unwrap();
    causes.iter().find(|c| c["effect"] == "external_contact")
}

#[test]
fn a_robot_of_which_nothing_is_missing_has_no_gap() {
    let found = report(&moving(1, &nothing), &moving(7, &nothing));
    assert_eq!(found["verdict"], "no_gap", "{:#}", found["unexplained"]);
    assert_eq!(effects(&found), Vec::<&str>::new());
}

/// Nothing is missing is the last thing to say of a robot at rest that is pushed by 60 N·m.
#[test]
fn pushes_against_a_standing_robot_are_contact() {
    let found = report(&standing(1, &push(60.0)), &standing(7, &push(40.0)));
    assert_eq!(found["verdict"], "explained", "{:#}", found["unexplained"]);
    assert_eq!(effects(&found), ["external_contact"]);
    let pushes = contact(&found).unwrap()["pushes"].as_array().unwrap();
    let of = |name: &str| pushes.iter().filter(|p| p["recording"] == name).count();
    assert_eq!((of("data"), of("heldout")), (4, 4), "{pushes:#?}");
    let first = &pushes[0];
    assert_eq!(
        (&first["trajectory"], &first["link"]),
        (&json!("run0"), &json!("upper"))
    );
    let (start, end) = (
        first["start"].as_f64().unwrap(),
        first["end"].as_f64().unwrap(),
    );
    assert!(
        (start - 4.0).abs() < 0.3 && (end - 5.2).abs() < 0.3,
        "{first}"
    );
    let ladder = found["ladder"].as_array().unwrap();
    assert!(ladder.len() >= 3);
    assert!(ladder[2]["samples"].as_u64() < ladder[1]["samples"].as_u64());
    assert!(ladder[2]["rmse"][1].as_f64() < ladder[1]["rmse"][1].as_f64());
    assert!(
        ladder[0]["nrmse"][0].is_null(),
        "a joint that never moves has no NRMSE"
    );
}

#[test]
fn pushes_in_one_recording_alone_are_contact() {
    let quiet = moving(1, &nothing);
    let here = report(&quiet, &moving(7, &push(40.0)));
    let cause = contact(&here).unwrap_or_else(|| panic!("{:#}", here["causes"]));
    assert!(cause["gap_closed"].as_f64().unwrap() > 0.5, "{cause:#}");
    assert_eq!(cause["confirmed"], true);
    let there = report(&moving(1, &push(40.0)), &moving(7, &nothing));
    let cause = contact(&there).unwrap_or_else(|| panic!("{:#}", there["causes"]));
    assert_eq!(
        (&cause["gap_closed"], &cause["confirmed"]),
        (&json!(0.0), &json!(false))
    );
    let stands = report(&quiet, &standing(7, &push(40.0)));
    assert!(contact(&stands).is_some(), "{:#}", stands["causes"]);
}

#[test]
fn a_robot_at_rest_tells_nothing() {
    let found = report(&standing(1, &nothing), &standing(7, &nothing));
    assert_eq!(found["verdict"], "cannot_tell");
    assert!(
        found["reason"].as_str().unwrap().contains("motion"),
        "{}",
        found["reason"]
    );
    assert_eq!(effects(&found), Vec::<&str>::new());
    assert_eq!(found["ladder"][1]["step"], "reidentified");
}

/// The rest is judged where one channel is dead; without any there is nothing to judge.
#[test]
fn a_dead_channel_hides_its_joint_alone() {
    let dead = |joints: std::ops::Range<usize>, seed| {
        let mut r = moving(seed, &nothing);
        let tau = r.tau.as_mut().unwrap();
        joints.for_each(|j| tau.column_mut(j).fill(0.0));
        r
    };
    let found = report(&dead(1..2, 1), &dead(1..2, 7));
    assert_eq!(found["verdict"], "no_gap", "{:#}", found["unexplained"]);
    assert!(found["ladder"][0]["rmse"][1].is_null() && found["ladder"][0]["nrmse"][1].is_null());
    assert!(found["ladder"][0]["nrmse"][0].as_f64().unwrap() < 0.05);
    let hidden = found["not_identifiable"].as_array().unwrap();
    let of_joint = hidden.iter().filter(|h| h["effect"].is_null());
    assert_eq!(
        of_joint.map(|h| &h["joints"]).collect::<Vec<_>>(),
        [&json!(["j2"])]
    );
    let none = report(&dead(0..3, 1), &dead(0..3, 7));
    assert_eq!(none["verdict"], "cannot_tell");
    assert!(none["ladder"][1]["mean_nrmse"].is_null());
}

/// What is left without a cause and without a pattern is no reason to say that nothing is missing.
#[test]
fn a_rest_without_a_pattern_is_not_nothing() {
    // Slow, different in every run, and little beside the joint's torque: nothing foretells it.
    let slow = |seed: u32| {
        move |run: usize, t: f64, _: &[f64], j: usize| {
            let mut draw = Noise(seed * 977 + run as u32 * 131);
            for _ in 0..5 {
                draw.next();
            }
            let (w, phase) = (4.0 + 2.0 * draw.next(), 6.0 * draw.next());
            [0.0, 0.28, 0.0][j] * (w * t + phase).sin()
        }
    };
    let found = report(&moving(1, &slow(1)), &moving(7, &slow(7)));
    assert!(effects(&found).is_empty(), "{:#}", found["causes"]);
    // Whether so slow a rest counts as structure or as none, something is left and no cause is named.
    let verdict = found["verdict"].as_str();
    assert!(
        matches!(verdict, Some("cannot_tell" | "unknown_effect")),
        "{verdict:?}: {:#}",
        found["unexplained"]
    );
}

/// Nothing is chosen with the torque of the held-out recording.
#[test]
fn scrambled_heldout_torque_changes_no_cause_and_no_verdict() {
    let drag = |_: usize, _: f64, qd: &[f64], j: usize| {
        [2.5, 0.0, 0.0][j] * qd[j] * qd[j].abs() + [0.0, 0.0, 4.0][j]
    };
    let data = moving(1, &drag);
    let heldout = moving(7, &drag);
    let mut scrambled = heldout.clone();
    let mut order: Vec<usize> = (0..heldout.len()).collect();
    let mut noise = Noise(5);
    for i in (1..order.len()).rev() {
        order.swap(i, ((noise.next() + 0.5) * (i + 1) as f64) as usize);
    }
    scrambled.tau = heldout
        .tau
        .as_ref()
        .map(|t| t.select(ndarray::Axis(0), &order));
    let said = |r: &Recording| {
        let found = report(&data, r);
        let causes = found["causes"].as_array().unwrap();
        let mut causes: Vec<String> = causes
            .iter()
            .filter(|c| c["effect"] != "external_contact")
            .map(|c| format!("{} {} {}", c["effect"], c["joints"], c["parameters"]))
            .collect();
        causes.sort();
        (
            causes,
            found["verdict"].clone(),
            found["unexplained"].clone(),
        )
    };
    let (plain, scrambled) = (said(&heldout), said(&scrambled));
    assert!(
        plain
            .0
            .iter()
            .any(|c| c.contains("nonlinear_viscous_friction")),
        "{:?}",
        plain.0
    );
    assert_eq!(plain, scrambled);
}

/// A torque that is cut in the held-out recording alone is not fitted there.
#[test]
fn a_limit_that_only_the_heldout_recording_reaches_is_no_cause() {
    let mut cut = moving(7, &nothing);
    let tau = cut.tau.as_mut().unwrap();
    tau.column_mut(1).mapv_inplace(|t| t.clamp(-22.0, 22.0));
    let found = report(&moving(1, &nothing), &cut);
    assert!(
        !effects(&found).contains(&"saturation"),
        "{:#}",
        found["causes"]
    );
    assert_eq!(found["verdict"], "no_gap", "of the fitted recording");
}

/// A joint that never moves has no figure, in either scope, and is in no mean.
#[test]
fn a_parked_joint_is_in_no_mean() {
    let parked = |seed| {
        Shown {
            seed,
            trajectories: 6,
            seconds: 12.0,
            reach: [0.8, 0.5, 0.0],
            more: &nothing,
        }
        .recording()
    };
    let found = report(&parked(1), &parked(7));
    for step in &found["ladder"].as_array().unwrap()[..2] {
        for scope in [step, &step["moving"]] {
            assert!(
                scope["nrmse"][2].is_null() && scope["r2"][2].is_null(),
                "{scope}"
            );
            let known: Vec<f64> = (0..2)
                .map(|j| scope["nrmse"][j].as_f64().unwrap())
                .collect();
            let mean = scope["mean_nrmse"].as_f64().unwrap();
            assert!((mean - 0.5 * (known[0] + known[1])).abs() < 1e-12);
        }
    }
}

/// What nobody has measured is null.
#[test]
fn probabilities_that_were_not_estimated_are_null() {
    let found = report(&moving(1, &drag), &moving(7, &drag));
    let cause = &found["causes"][0];
    assert_eq!(cause["effect"], "nonlinear_viscous_friction");
    assert!(cause["p_value"].is_null() && cause["confidence"].is_null());
    assert_eq!(cause["confirmed"], true);
    let candidates = found["candidates"].as_array().unwrap();
    assert!(!candidates.is_empty());
    assert!(candidates.iter().all(|c| c["p_value"].is_null()));
    let shape = cause["parameters"].as_array().unwrap().iter();
    assert!(
        shape.filter(|p| p["std"] == json!(0.0)).count() == 0,
        "{cause:#}"
    );
}

/// Simulations speak for the name of a plain effect, and weights make a confidence of that; two short runs have too few stretches.
#[test]
fn a_name_is_supported_where_surrogates_say_something() {
    let mut options = Options {
        surrogates: 19,
        ..Options::default()
    };
    let found = reported(&moving(1, &drag), &moving(7, &drag), &options);
    let cause = &found["causes"][0];
    assert_eq!(cause["effect"], "nonlinear_viscous_friction");
    let support = |key: &str| cause["support"][key].as_f64().unwrap();
    assert!(support("lead") > 0.0 && support("likeness") > 0.0);
    assert!(support("over_chance") > 1.0 && support("left") >= 0.0);
    assert!(cause["confidence"].is_null(), "no weights were given");
    options.settings.measure.confidence.weights = Some([-0.5, 0.0, 0.0, 0.0, 0.0]);
    let short = |seed, trajectories| {
        let (reach, more) = ([0.8, 0.5, 0.6], &drag);
        let shown = Shown {
            seed,
            trajectories,
            seconds: 10.0,
            reach,
            more,
        };
        shown.recording()
    };
    let enough = reported(&short(1, 4), &short(7, 4), &options);
    let confidence = enough["causes"][0]["confidence"].as_f64().unwrap();
    assert!((confidence - 1.0 / (1.0 + 0.5f64.exp())).abs() < 1e-12);
    let found = reported(&short(1, 2), &short(7, 2), &options);
    let cause = &found["causes"][0];
    assert_eq!(cause["effect"], "nonlinear_viscous_friction");
    assert!(cause["p_value"].is_number());
    assert!(cause["support"].is_null() && cause["confidence"].is_null());
}
