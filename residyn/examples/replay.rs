//! What a simulator's drives get wrong, from commands and positions alone: recordings in memory, no torque.
//!
//! `cargo run --release -p residyn --example replay`

use ndarray::Array2;
use residyn::physics::robot::drive::Drive;
use residyn::replay::{Options, Subject};
use residyn::{Recording, Robot, Workspace, forward_dynamics, replay};
use std::error::Error;
use std::f64::consts::TAU;

/// An arm of two joints with bodies of 2 kg and 1 kg.
const ARM: &str = r#"<robot name="arm"><link name="base"/>
  <link name="upper"><inertial><origin xyz="0.2 0 0"/><mass value="2"/>
    <inertia ixx="0.02" iyy="0.03" izz="0.03" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="lower"><inertial><origin xyz="0.15 0 0"/><mass value="1"/>
    <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/>
    <limit lower="-3" upper="3" effort="100" velocity="6"/><dynamics damping="0.5"/></joint>
  <joint name="elbow" type="revolute"><parent link="upper"/><child link="lower"/><origin xyz="0.4 0 0"/><axis xyz="0 1 0"/>
    <limit lower="-3" upper="3" effort="50" velocity="6"/><dynamics damping="0.3"/></joint></robot>"#;
/// The simulator's drives, which are the robot's but for the delay.
const DRIVES: &str = "[controller]\nkind = \"pd\"\nkp = [150.0, 60.0]\nkd = [8.0, 3.0]\ngravity_compensation = false\n";
const GAINS: [[f64; 2]; 2] = [[150.0, 60.0], [8.0, 3.0]];
const DAMPING: [f64; 2] = [0.5, 0.3];
/// Commands and samples per second, and steps of the simulation between two of them.
const RATE: f64 = 100.0;
const STEPS: usize = 20;
/// Samples by which commands reach the robot's drives late: 40 ms.
const LATE: usize = 4;

/// Motion of the real robot under commands that begin at `phase`, rad, for `seconds`.
fn record(robot: &Robot, phase: f64, seconds: f64) -> Recording {
    let rows = (seconds * RATE) as usize;
    let command = |row: usize, j: usize| {
        let t = row as f64 / RATE;
        let wave = |hz: f64| (TAU * hz * t + phase + j as f64).sin();
        0.5 * wave(0.23 + 0.1 * j as f64) + 0.2 * wave(0.61).signum()
    };
    let q_ref = Array2::from_shape_fn((rows, 2), |(row, j)| command(row, j));
    let mut seen = Array2::zeros((rows, 2));
    let mut workspace = Workspace::new(robot);
    let (mut q, mut qd, mut qdd) = ([command(0, 0), command(0, 1)], [0.0; 2], [0.0; 2]);
    for row in 0..rows {
        // An encoder of 4096 steps per turn.
        let step = TAU / 4096.0;
        (0..2).for_each(|j| seen[(row, j)] = (q[j] / step).round() * step);
        for _ in 0..STEPS {
            let torque = [0, 1].map(|j| {
                let [kp, kd] = GAINS.map(|gain| gain[j]);
                kp * (q_ref[(row.saturating_sub(LATE), j)] - q[j]) - (kd + DAMPING[j]) * qd[j]
            });
            forward_dynamics(robot, &mut workspace, &q, &qd, &torque, &[], &mut qdd);
            for j in 0..2 {
                qd[j] += qdd[j] / (RATE * STEPS as f64);
                q[j] += qd[j] / (RATE * STEPS as f64);
            }
        }
    }
    let time = (0..rows).map(|row| row as f64 / RATE).collect();
    Recording {
        q_ref: Some(q_ref),
        ..Recording::new("simulated", time, seen, None)
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let robot = Robot::from_urdf_str(ARM)?;
    let drive = Drive::from_toml(DRIVES, &robot)?;
    let [monday, friday] = [(0.0, 30.0), (2.0, 15.0)].map(|(phase, s)| record(&robot, phase, s));

    let subject = Subject::of(robot, drive)?;
    let options = Options::default().fast(true);
    let done = replay(subject, &[monday], &friday, options, |stage| {
        eprintln!("{stage} …");
    })?;
    for line in done.lines() {
        println!("{line}");
    }
    let report = &done.outcome.report;
    assert_eq!(report.causes[0].effect, "command_delay");
    let (delay, truth) = (report.controller.delay[0], LATE as f64 / RATE);
    assert!((delay - truth).abs() < 0.05 * truth, "{delay}");
    Ok(())
}
