//! An arm, what it is recorded doing, and what is said of that.

use datasets::{Recording, Trajectory};
use diagnose::NominalModel;
use diagnose::{Options, diagnose};
use ndarray::Array2;
use physics::dynamics::{Workspace, inverse_dynamics};
use physics::robot::Robot;
use serde_json::Value;

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
pub struct Noise(pub u32);

impl Noise {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(self.0 >> 8) / f64::from(1u32 << 24) - 0.5
    }
}

/// Torque beyond the model's by trajectory, time in it, q̇ of all joints and joint, N·m.
pub type Extra<'a> = dyn Fn(usize, f64, &[f64], usize) -> f64 + 'a;

/// What a recording shows.
pub struct Shown<'a> {
    pub seed: u32,
    pub trajectories: usize,
    pub seconds: f64,
    /// How far each joint moves, rad.
    pub reach: [f64; JOINTS],
    pub more: &'a Extra<'a>,
}

impl Shown<'_> {
    pub fn recording(&self) -> Recording {
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

pub fn nothing(_: usize, _: f64, _: &[f64], _: usize) -> f64 {
    0.0
}

/// The robot in motion, six runs of 12 s.
pub fn moving(seed: u32, more: &Extra<'_>) -> Recording {
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
pub fn standing(seed: u32, more: &Extra<'_>) -> Recording {
    Shown {
        seed,
        trajectories: 4,
        seconds: 15.0,
        reach: [0.0; JOINTS],
        more,
    }
    .recording()
}

/// Drag on the first joint.
pub fn drag(_: usize, _: f64, qd: &[f64], j: usize) -> f64 {
    [2.5, 0.0, 0.0][j] * qd[j] * qd[j].abs()
}

/// Somebody leans on the arm for 1.2 s in every run, on the second joint and the first.
pub fn push(size: f64) -> impl Fn(usize, f64, &[f64], usize) -> f64 {
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

pub fn report(data: &Recording, heldout: &Recording) -> Value {
    reported(data, heldout, &Options::default())
}

pub fn reported(data: &Recording, heldout: &Recording, options: &Options) -> Value {
    let outcome = diagnose(&NominalModel::new(arm()), data, heldout, options).unwrap();
    serde_json::to_value(&outcome.diagnosis).unwrap()
}

pub fn effects(report: &Value) -> Vec<&str> {
    let causes = report["causes"].as_array().unwrap();
    causes
        .iter()
        .map(|c| c["effect"].as_str().unwrap())
        .collect()
}

pub fn contact(report: &Value) -> Option<&Value> {
    let causes = report["causes"].as_array().unwrap();
    causes.iter().find(|c| c["effect"] == "external_contact")
}
