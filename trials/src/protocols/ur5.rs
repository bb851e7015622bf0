//! UR5, as in "Deep Learning Aided Dynamic Parameter Identification of 6-DOF Robot Manipulators" (2020).

use super::effects::JointEffects;
use super::recorded::{Protocol, Simulated};
use super::runs::{Machine, Plan, arm};
use crate::SimulateError;
use physics::robot::Robot;
use plant::arm::Arm;
use plant::measure::Errors;
use plant::reference::{
    Move, Moves, Multisine, Pace, STEP_ACCELERATION, STEP_SPEED, Segment, Session,
};
use plant::run::Clock;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

/// RMSE of the rigid model with viscous and Coulomb friction on the moves of each joint, N·m: Table 6 of the UR5 paper.
/// The effects below are sized so that the same model has about the same error.
pub const TABLE_6: [f64; 6] = [3.112, 2.958, 2.633, 0.417, 0.457, 0.444];

/// Moves: runs, moves in each, samples of each move at 60 Hz (20 · 50 · 154.44 = 154,440).
const RUNS: usize = 20;
const MOVES: usize = 50;
const SAMPLES: usize = 7722;
const RATE: f64 = 60.0;
/// Number of runs of each excitation.
const EXECUTIONS: usize = 8;

pub(super) fn machine() -> Result<Machine, SimulateError> {
    let friction = [
        (9.0, 4.7),
        (10.0, 4.9),
        (7.5, 4.0),
        (1.25, 0.64),
        (1.2, 0.67),
        (1.1, 0.72),
    ];
    let centre = [0.0, -1.4, 0.8, -0.7, 0.2, 0.0];
    let reach = [2.4, 0.95, 1.3, 1.5, 1.9, 2.6];
    let robot = Robot::builtin("ur5").ok_or(SimulateError::NoRobot("ur5"))?;
    let mut arm = arm("ur5", &robot, centre, reach, friction);
    // Motors and gears count as parts of the links that they move, so that the paper's 36 base parameters and 12 of
    // friction are all that a rigid model has.
    for (j, inertia) in [0.3, 0.3, 0.2, 0.06, 0.06, 0.05].into_iter().enumerate() {
        arm.add_disc(j, inertia);
    }
    let effect = |scale: f64, loss: f64, friction: f64, order: f64| JointEffects {
        ripple: 0.55 * scale,
        order,
        stribeck: 1.3 * scale,
        stribeck_speed: 0.18,
        flow: 2.2 * scale,
        loss,
        deflection: 0.015,
        cold: friction,
    };
    Ok(Machine {
        effects: vec![
            effect(SCALE[0], 0.10, 0.30, 12.3),
            effect(SCALE[1], 0.07, 0.25, 11.1),
            effect(SCALE[2], 0.09, 0.30, 12.9),
            effect(SCALE[3], 0.08, 0.25, 9.7),
            effect(SCALE[4], 0.10, 0.25, 10.4),
            effect(SCALE[5], 0.10, 0.25, 8.3),
        ],
        warm_up: (700.0, vec![12.0, 10.0, 9.0, 1.6, 2.0, 2.2]),
        more: |_| Vec::new(),
        errors: Errors {
            count: vec![TAU / f64::from(1 << 18); 6],
            velocity: vec![0.002; 6],
            torque: TABLE_6.iter().map(|t| 0.2 * t).collect(),
        },
        gears: Vec::new(),
        bandwidth: 8.0,
        arm,
    })
}

/// Torque scale of each joint's effects, N·m.
const SCALE: [f64; 6] = [1.5, 1.0, 1.15, 0.18, 0.2, 0.24];

pub(super) fn simulate(
    machine: &Machine,
    seed: u64,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Simulated, SimulateError> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut plans = Vec::new();
    let mut clock = 0.0;
    // Two excitations, for the heavy and for the light links, averaged over eight executions in the paper.
    for (step, rate) in [(1, 2.0 / 65.0), (2, 1.0 / 30.0)] {
        let length: f64 = 1.0 / rate;
        let pace = Pace::constant(rate, 12, 0.9);
        let series = Multisine::draw(&machine.arm, &pace, length, &mut rng);
        for execution in 0..EXECUTIONS {
            plans.push(Plan {
                session: Session::new(vec![(Segment::Multisine(series.clone()), length)], 2.0, 6),
                offset: clock,
                labels: vec![format!("step{step}-{}", execution + 1)],
                clock: at_100_hz(),
                part: 0,
            });
            clock += length + 2.0;
        }
    }
    for run in 0..RUNS {
        let length = SAMPLES as f64 / RATE;
        let moves = Segment::Moves(moves(&machine.arm, length / MOVES as f64, &mut rng));
        plans.push(Plan {
            session: Session::new(vec![(moves, length)], 2.0, 6),
            offset: clock,
            labels: vec![format!("moves-{}", run + 1)],
            clock: Clock {
                step: 1.0 / (RATE * 33.0),
                control: 2,
                sample: 33,
            },
            part: 1,
        });
        clock += length + 2.0;
    }
    // A new trajectory at high speed.
    let series = Multisine::draw(
        &machine.arm,
        &Pace::constant(1.0 / 42.5, 36, 1.0),
        42.5,
        &mut rng,
    );
    plans.push(Plan {
        session: Session::new(vec![(Segment::Multisine(series), 42.5)], 2.0, 6),
        offset: clock,
        labels: vec!["verification".to_owned()],
        clock: at_100_hz(),
        part: 2,
    });
    let recordings = machine.record(&plans, 3, seed, progress)?;
    let names = Protocol::Ur5.parts().iter().map(|n| (*n).to_owned());
    Ok(Simulated {
        protocol: Protocol::Ur5,
        parts: names.zip(recordings).collect(),
        truth: machine.truth(),
    })
}

fn at_100_hz() -> Clock {
    Clock {
        step: 5e-4,
        control: 2,
        sample: 20,
    }
}

/// Moves every `beat` seconds: all joints at once, peak speed 2–3 rad/s and peak acceleration 2.2–3 rad/s²
/// where the distance is long enough.
fn moves(arm: &Arm, beat: f64, rng: &mut ChaCha8Rng) -> Moves {
    let mut here = arm.centre.clone();
    let moves = (0..MOVES).map(|i| {
        let (speed, acceleration) = (rng.random_range(2.0..3.0), rng.random_range(2.2..3.0));
        let mut to: Vec<f64> = arm
            .centre
            .iter()
            .zip(&arm.reach)
            .map(|(c, r)| c + r * rng.random_range(-0.95..0.95))
            .collect();
        let way = here
            .iter()
            .zip(&to)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max);
        let duration = |way: f64| {
            (STEP_SPEED * way / speed).max((STEP_ACCELERATION * way / acceleration).sqrt())
        };
        let mut time = duration(way);
        if time > 0.95 * beat {
            // Only as far as the beat allows.
            let share = (0.95 * beat / time).powi(2);
            to.iter_mut()
                .zip(&here)
                .for_each(|(t, h)| *t = h + (*t - h) * share);
            time = duration(way * share);
        }
        let start = i as f64 * beat;
        let from = std::mem::replace(&mut here, to.clone());
        Move {
            start,
            duration: time.max(0.4),
            from,
            to,
        }
    });
    Moves::new(moves.collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cases::left_by_parameters;

    /// A fifth of the moves is enough to see what the paper's model leaves.
    #[test]
    fn the_usual_model_leaves_what_table_6_says() {
        let machine = machine().unwrap();
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        let length = SAMPLES as f64 / RATE;
        let plans: Vec<Plan> = (0..4)
            .map(|i| Plan {
                session: Session::new(
                    vec![(
                        Segment::Moves(moves(&machine.arm, length / MOVES as f64, &mut rng)),
                        length,
                    )],
                    2.0,
                    6,
                ),
                offset: 400.0 + 600.0 * f64::from(i),
                labels: vec![i.to_string()],
                clock: Clock {
                    step: 1.0 / (RATE * 33.0),
                    control: 2,
                    sample: 33,
                },
                part: 0,
            })
            .collect();
        let recording = machine.record(&plans, 1, 4, &|_| {}).unwrap().remove(0);
        let left = left_by_parameters(&machine.arm, &recording, RATE, 10.0).unwrap();
        for (j, (rmse, table)) in left.iter().zip(TABLE_6).enumerate() {
            assert!(
                (rmse / table - 1.0).abs() < 0.15,
                "joint {}: {left:.3?} N·m, Table 6 {table}",
                j + 1
            );
        }
    }
}
