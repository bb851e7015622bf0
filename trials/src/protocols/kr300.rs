//! KR300, as in the benchmark of Weigand, Götz, Ulmen and Ruskowski (2022).

use super::effects::JointEffects;
use super::recorded::{Protocol, Simulated};
use super::runs::{Machine, Plan, arm};
use crate::SimulateError;
use datasets::{Recording, TorqueFilter, Trajectory};
use ndarray::{Array2, Axis};
use physics::robot::Robot;
use plant::measure::Errors;
use plant::mechanism::{GasStrut, Mechanism, Pins};
use plant::reference::{Multisine, Pace, Segment, Session};
use plant::run::Clock;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

/// Sessions of three trajectories, each run twice (A B C A B C); the last session is the test.
const SESSIONS: usize = 12;
const DISTINCT: usize = 3;
const LENGTH: f64 = 60.6;
/// Rate of the raw signals, Hz, and samples of it in one of the benchmark.
const RAW: f64 = 250.0;
const DECIMATION: usize = 25;

pub(super) fn machine() -> Result<Machine, SimulateError> {
    let friction = [
        (1500.0, 620.0),
        (1700.0, 700.0),
        (1300.0, 520.0),
        (210.0, 150.0),
        (230.0, 160.0),
        (90.0, 75.0),
    ];
    let centre = [0.0, 0.35, -1.3, 0.0, 0.6, 0.0];
    let reach = [1.9, 0.75, 1.3, 2.6, 1.5, 3.0];
    let robot = Robot::builtin("kr300").ok_or(SimulateError::NoRobot("kr300"))?;
    let arm = arm("kr300", &robot, centre, reach, friction);
    let effects = arm
        .joints
        .iter()
        .enumerate()
        .map(|(j, joint)| JointEffects {
            stribeck: 0.25 * joint.friction,
            stribeck_speed: 0.06,
            flow: 0.5 * joint.friction,
            loss: 0.04,
            deflection: [0.002, 0.002, 0.0025, 0.004, 0.004, 0.005][j],
            cold: [0.5, 0.3, 0.3, 0.25, 0.25, 0.25][j],
            ..JointEffects::default()
        });
    Ok(Machine {
        effects: effects.collect(),
        warm_up: (1500.0, vec![500.0, 200.0, 300.0, 120.0, 90.0, 80.0]),
        more: counterbalance,
        errors: Errors {
            count: vec![TAU / f64::from(1 << 20); 6],
            velocity: vec![0.0008; 6],
            torque: vec![25.0, 30.0, 20.0, 6.0, 6.0, 3.0],
        },
        gears: Vec::new(),
        bandwidth: 5.0,
        arm,
    })
}

/// The gas strut of joint 2, about as strong as the benchmark's: 45 kN at its middle length, polytropic.
fn counterbalance(axes: &[usize]) -> Vec<Box<dyn Mechanism>> {
    vec![Box::new(GasStrut {
        joint: axes[1],
        pins: Pins {
            lever: 0.2,
            base: 0.8,
            angle: 5f64.to_radians(),
        },
        // Pulls its pins together, harder the longer it is.
        force: -44.6e3,
        volume: -0.42,
    })]
}

pub(super) fn simulate(
    machine: &Machine,
    seed: u64,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Simulated, SimulateError> {
    sessions(machine, SESSIONS, seed, progress)
}

/// The first sessions; the last of them is the test.
fn sessions(
    machine: &Machine,
    count: usize,
    seed: u64,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Simulated, SimulateError> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let pace = Pace {
        ease: 4.0,
        ..Pace::constant(1.0 / 60.0, 16, 0.85)
    };
    let mut clock = 0.0;
    let plans: Vec<Plan> = (0..count)
        .map(|s| {
            let draw =
                |_| Segment::Multisine(Multisine::draw(&machine.arm, &pace, LENGTH, &mut rng));
            let distinct: Vec<Segment> = (0..DISTINCT).map(draw).collect();
            let twice = distinct
                .iter()
                .chain(&distinct)
                .cloned()
                .map(|m| (m, LENGTH))
                .collect();
            let session = Session::new(twice, 0.4, 6);
            let offset = clock;
            clock += session.span().1 + 60.0;
            let label = |i: usize| format!("{}{}", s + 1, ["a1", "b1", "c1", "a2", "b2", "c2"][i]);
            Plan {
                session,
                offset,
                labels: (0..2 * DISTINCT).map(label).collect(),
                clock: Clock {
                    step: 1e-3,
                    control: 1,
                    sample: 4,
                },
                part: usize::from(s + 1 == count),
            }
        })
        .collect();
    let raw = machine.record(&plans, 2, seed, progress)?;
    let names = Protocol::Kr300.parts().iter().map(|n| (*n).to_owned());
    let mut truth = machine.truth();
    truth["counterbalance"] = serde_json::json!({"joint": "joint_2", "lever": 0.2, "base": 0.8, "angle": 5f64.to_radians(),
        "force_at_middle": 44.6e3, "stroke": 0.42, "exponent": 1.2});
    Ok(Simulated {
        protocol: Protocol::Kr300,
        parts: names.zip(raw.iter().map(benchmark)).collect(),
        truth,
    })
}

/// Recorded motion over the true one, where it is slow: an even Chebyshev low-pass is at the bottom of its ripple at frequency
/// zero, and both passes of [`benchmark`] are.
pub(super) fn motion_gain() -> f64 {
    let filter = TorqueFilter::KR300;
    signal::sos::chebyshev1(filter.order, filter.ripple_db, filter.cutoff_hz, RAW).map_or(
        1.0,
        |sections| {
            let once: f64 = sections.iter().map(|s| s.dc_gain()).product();
            once * once
        },
    )
}

/// Recording as the benchmark of Weigand et al. (2022) has it, after their listing 1: zero-phase Chebyshev low-pass of
/// motion and torque, then every 25th sample.
fn benchmark(raw: &Recording) -> Recording {
    let filter = TorqueFilter::KR300;
    let Ok(sections) =
        signal::sos::chebyshev1(filter.order, filter.ripple_db, filter.cutoff_hz, RAW)
    else {
        return raw.clone();
    };
    let kept: Vec<usize> = raw
        .segments()
        .into_iter()
        .flat_map(|s| s.step_by(DECIMATION))
        .collect();
    let smooth = |table: &Array2<f64>| {
        let mut out = table.clone();
        for range in raw.segments() {
            for j in 0..table.ncols() {
                let column: Vec<f64> = range.clone().map(|k| table[[k, j]]).collect();
                let filtered = signal::filter::filtfilt(&sections, &column);
                range
                    .clone()
                    .zip(filtered)
                    .for_each(|(k, x)| out[[k, j]] = x);
            }
        }
        out.select(Axis(0), &kept)
    };
    let mut out = Recording::new(
        "simulation",
        kept.iter().map(|&k| raw.time[k]).collect(),
        smooth(&raw.q),
        raw.tau.as_ref().map(smooth),
    );
    out.qd = raw.qd.as_ref().map(smooth);
    let mut start = 0;
    out.trajectories = raw
        .trajectories
        .iter()
        .map(|t| {
            let end = start + t.range.len().div_ceil(DECIMATION);
            let range = std::mem::replace(&mut start, end)..end;
            Trajectory {
                label: t.label.clone(),
                range,
            }
        })
        .collect();
    out.torque_filter = Some(filter);
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn has_the_shape_of_the_benchmark() {
        let made = sessions(&machine().unwrap(), 2, 1, &|_| {}).unwrap();
        let (train, test) = (made.part("train").unwrap(), made.part("test").unwrap());
        // Three trajectories of 606 samples, each twice; of all twelve sessions, 39996 and 3636 (published: 39988 and 3636).
        assert_eq!((train.len(), test.len()), (6 * 606, 6 * 606));
        train.validate().unwrap();
        test.validate().unwrap();
        assert!((train.median_step() - 0.1).abs() < 1e-9);
        // It rests at −1.3 rad, but for what the controller lets gravity have, and is recorded through a low-pass below gain 1.
        let rest = test.q[[0, 2]] / -1.3;
        assert!(
            (rest / motion_gain() - 1.0).abs() < 2e-3 && rest < 0.96,
            "{rest}"
        );
        // Trajectories repeat: the two executions differ far less than the motion itself.
        let rows = |t: usize| {
            test.q
                .column(0)
                .slice_axis(Axis(0), (t * 606..(t + 1) * 606).into())
                .to_owned()
        };
        let difference = (&rows(0) - &rows(3))
            .mapv(f64::abs)
            .iter()
            .fold(0.0, |a: f64, b| a.max(*b));
        assert!(difference < 0.01 && rows(0).std(0.0) > 0.1, "{difference}");
    }
}
