//! How fast a closed loop is fitted to recorded motion, iterate by iterate.
//!
//! `cargo run --release --workspace --example replay_fit -- --robot so101.xml --joints a,b --data multisine.parquet --out ours.json`
//! fits gain, viscous and Coulomb friction and rotor inertia of every joint, from the model as given, to blocks of 5 s that start at
//! recorded states. It writes every iterate with the seconds and processor seconds until it. `peers/mujoco_sysid.py` does the same
//! with MuJoCo's own system identification and weighs both.

use clap::Parser;
use datasets::Part;
use replay::arm::Arm;
use replay::fit::{Effort, Free, Noise, descend, sums};
use replay::input::Subject;
use replay::parameter::{Kind, Parameter};
use replay::simulate::Unstable;
use serde_json::json;
use std::error::Error;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// How fast a closed loop is fitted.
#[derive(Parser)]
struct Arguments {
    /// The robot's MJCF with its position servos.
    #[arg(long)]
    robot: String,
    /// Joints, base first.
    #[arg(long, value_delimiter = ',')]
    joints: Vec<String>,
    /// Recording of commands and positions.
    #[arg(long)]
    data: PathBuf,
    /// Threads.
    #[arg(long, default_value_t = 2)]
    threads: usize,
    /// Longest step of integration, s.
    #[arg(long, default_value_t = 1e-3)]
    step: f64,
    /// Iterations.
    #[arg(long, default_value_t = 20)]
    iterations: usize,
    /// Blocks that are fitted, the first ones of the recording; all of them without it.
    #[arg(long)]
    blocks: Option<usize>,
    /// Where the iterates are written.
    #[arg(long)]
    out: PathBuf,
}

const FITTED: [(Kind, &str); 4] = [
    (Kind::Gain, "kp"),
    (Kind::Damping, "damping"),
    (Kind::Coulomb, "frictionloss"),
    (Kind::Armature, "armature"),
];

fn main() -> Result<(), Box<dyn Error>> {
    let a = Arguments::parse();
    rayon::ThreadPoolBuilder::new()
        .num_threads(a.threads)
        .build_global()?;
    let subject = Subject::read(&a.robot, &a.joints, None, None)?;
    let recording = subject.recording(&a.data, Part::Train)?;
    let prepared = subject.prepared(std::slice::from_ref(&recording))?;
    let mut data = prepared.ok_or("no recording")?;
    data.blocks.truncate(a.blocks.unwrap_or(usize::MAX));
    // The drive's damping and viscous friction are one number where no velocity is commanded.
    let start = subject.given.without_rates().arm;
    let n = start.dof();
    let free: Vec<Free> = (0..n)
        .flat_map(|j| FITTED.map(|(kind, _)| Parameter::new(kind, j)))
        .map(|parameter| Free {
            parameter,
            prior: None,
        })
        .collect();
    // Noise far above every error: what is minimised is then the sum of squared errors in units of the tracking error, as the peer
    // has it.
    let noise: Vec<Noise> = data
        .tracking
        .iter()
        .map(|t| Noise {
            floor: 1e4 * t * t,
            correlation: 1.0,
        })
        .collect();
    // Sum over samples and joints of squared errors in units of the tracking error, in this simulator.
    let cost = |arm: &Arm| -> Result<f64, Unstable> {
        let mut arm = arm.clone();
        arm.step = a.step;
        let blocks = sums(&arm, &data.blocks, &[])?;
        let each = blocks
            .iter()
            .flat_map(|b| b.squared.iter().zip(&data.tracking));
        Ok(each.map(|(s, t)| s / (t * t)).sum())
    };
    let mut iterates = vec![values(&start, 0.0, 0.0, cost(&start)?)];
    // The same path every time, cut one iteration later.
    for iterations in 1..=a.iterations {
        let effort = Effort {
            iterations,
            gain: 0.0,
            step: a.step,
        };
        let (begun, used) = (Instant::now(), processor()?);
        let arm = descend(&start, &free, &data.blocks, &noise, effort, None)?.arm;
        let (seconds, used) = (begun.elapsed().as_secs_f64(), processor()? - used);
        println!("{iterations} iterations: {seconds:.2} s, {used:.2} s of processor time");
        iterates.push(values(&arm, seconds, used, cost(&arm)?));
    }
    let blocks = data
        .blocks
        .iter()
        .map(|b| json!([b.time[0], b.time[b.time.len() - 1]]));
    let out = json!({
        "joints": start.robot.joint_names(), "step": a.step, "threads": a.threads,
        "blocks": blocks.collect::<Vec<_>>(), "iterates": iterates,
    });
    std::fs::write(&a.out, serde_json::to_string_pretty(&out)?)?;
    Ok(())
}

/// An iterate: the fitted values of an arm, the seconds until it, and its cost.
fn values(arm: &Arm, seconds: f64, processor: f64, cost: f64) -> serde_json::Value {
    let mut out = json!({ "seconds": seconds, "processor": processor, "cost": cost });
    for (kind, name) in FITTED {
        let of = |j: usize| arm.get(Parameter::new(kind, j));
        let all: Vec<f64> = (0..arm.dof()).map(of).collect();
        out[name] = json!(all);
    }
    out
}

/// Processor time of this process, s: of all threads, in ticks of a hundredth of a second.
fn processor() -> Result<f64, Box<dyn Error>> {
    let text = std::fs::read_to_string(Path::new("/proc/self/stat"))?;
    let after = text.rsplit(')').next().unwrap_or_default();
    let ticks: Vec<f64> = after
        .split_whitespace()
        .skip(11)
        .take(2)
        .map(str::parse)
        .collect::<Result<_, _>>()?;
    Ok(ticks.iter().sum::<f64>() / 100.0)
}
