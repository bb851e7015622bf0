//! Foxbot A05, as in "An Iterative Approach for Accurate Dynamic Model Identification of Industrial Robots" (2020).

use super::effects::JointEffects;
use super::recorded::{Protocol, Simulated};
use super::runs::{Machine, Plan, arm};
use crate::SimulateError;
use datasets::Recording;
use physics::robot::Robot;
use plant::measure::Errors;
use plant::mechanism::{Drag, DragKind, Mechanism};
use plant::reference::{Multisine, Pace, Segment, Session};
use plant::run::Clock;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

/// Trajectories of one period: third-order Fourier series up to 0.4 Hz.
const TRAJECTORIES: usize = 10;
const FOR_IDENTIFICATION: usize = 7;
const FUNDAMENTAL: f64 = 0.4 / 3.0;

/// Friction of equation 30: F_c sign q̇ + F_v |q̇|^α sign q̇ + B.
const COULOMB: [f64; 6] = [9.0, 11.0, 6.0, 2.6, 2.4, 1.4];
const VISCOUS: [f64; 6] = [24.0, 28.0, 15.0, 5.5, 5.0, 3.0];
const ALPHA: [f64; 6] = [0.55, 0.62, 0.50, 0.70, 0.58, 0.66];
const OFFSET: [f64; 6] = [0.8, -1.2, 0.5, -0.2, 0.15, 0.1];

pub(super) fn machine() -> Result<Machine, SimulateError> {
    let robot = Robot::builtin("foxbot_a05").ok_or(SimulateError::NoRobot("foxbot_a05"))?;
    let centre = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let reach = [2.0, 1.2, 1.3, 2.4, 1.6, 3.0];
    let friction = COULOMB.map(|c| (0.0, c));
    let mut arm = arm("foxbot_a05", &robot, centre, reach, friction);
    // Equation 30 has a true sign: what its softening takes off Coulomb friction has to stay below what is estimated.
    arm.v_eps.fill(0.001);
    Ok(Machine {
        arm,
        effects: vec![JointEffects::default(); 6],
        warm_up: (1.0, vec![1.0; 6]),
        more: power_of_speed,
        errors: Errors {
            count: vec![TAU / f64::from(1 << 20); 6],
            velocity: vec![0.002; 6],
            torque: vec![0.8, 0.8, 0.5, 0.15, 0.15, 0.08],
        },
        gears: Vec::new(),
        bandwidth: 8.0,
    })
}

fn power_of_speed(axes: &[usize]) -> Vec<Box<dyn Mechanism>> {
    let drag = |j: usize| -> Box<dyn Mechanism> {
        Box::new(Drag {
            joint: axes[j],
            size: VISCOUS[j],
            v_0: 1.0,
            v_top: 1.0,
            kind: DragKind::Power(ALPHA[j]),
        })
    };
    (0..6).map(drag).collect()
}

pub(super) fn simulate(
    machine: &Machine,
    seed: u64,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Simulated, SimulateError> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let length = 1.0 / FUNDAMENTAL;
    let plan = |i: usize| {
        let series = Multisine::draw(
            &machine.arm,
            &Pace::constant(FUNDAMENTAL, 3, 0.9),
            length,
            &mut rng,
        );
        Plan {
            session: Session::new(vec![(Segment::Multisine(series), length)], 2.0, 6),
            offset: i as f64 * (length + 2.0),
            labels: vec![(i + 1).to_string()],
            clock: Clock {
                step: 5e-4,
                control: 2,
                sample: 20,
            },
            part: usize::from(i >= FOR_IDENTIFICATION),
        }
    };
    let plans: Vec<Plan> = (0..TRAJECTORIES).map(plan).collect();
    let recordings = machine.record(&plans, 2, seed, progress)?;
    let mut truth = machine.truth();
    truth["viscous"] = serde_json::json!(VISCOUS);
    truth["alpha"] = serde_json::json!(ALPHA);
    truth["offset"] = serde_json::json!(OFFSET);
    let names = Protocol::FoxbotA05.parts().iter().map(|n| (*n).to_owned());
    Ok(Simulated {
        protocol: Protocol::FoxbotA05,
        parts: names.zip(recordings.into_iter().map(with_offset)).collect(),
        truth,
    })
}

/// The torque sensors' offsets B.
fn with_offset(mut recording: Recording) -> Recording {
    if let Some(tau) = &mut recording.tau {
        for mut row in tau.rows_mut() {
            row.iter_mut().zip(OFFSET).for_each(|(t, b)| *t += b);
        }
    }
    recording
}

#[cfg(test)]
mod tests {
    use super::*;
    use physics::dynamics::{Workspace, inverse_dynamics};

    /// Torque is inverse dynamics, rotor inertia and equation 30 within the noise, away from reversals.
    #[test]
    fn torque_follows_the_stated_parameters() {
        let made = simulate(&machine().unwrap(), 3, &|_| {}).unwrap();
        let machine = machine().unwrap();
        let recording = made.part("validation").unwrap();
        assert_eq!(made.part("identification").unwrap().len(), 5250);
        let robot = machine.arm.robot().unwrap();
        let mut workspace = Workspace::new(&robot);
        let (qd, tau) = (
            recording.qd.as_ref().unwrap(),
            recording.tau.as_ref().unwrap(),
        );
        let (mut sum, mut count) = ([0.0; 6], [0.0; 6]);
        for range in recording.segments() {
            for k in range.start + 3..range.end - 3 {
                // Seven-point slope of the noisy velocity.
                let slope = |j: usize| {
                    (1..=3)
                        .map(|i| i as f64 * (qd[[k + i, j]] - qd[[k - i, j]]))
                        .sum::<f64>()
                        / 0.28
                };
                let qdd: Vec<f64> = (0..6).map(slope).collect();
                let (q, v) = (recording.q.row(k).to_vec(), qd.row(k).to_vec());
                let mut model = vec![0.0; 6];
                inverse_dynamics(&robot, &mut workspace, &q, &v, &qdd, &mut model);
                for j in (0..6).filter(|&j| v[j].abs() > 0.1) {
                    let friction = (COULOMB[j] + VISCOUS[j] * v[j].abs().powf(ALPHA[j]))
                        * v[j].signum()
                        + OFFSET[j];
                    let rotor = robot.joints()[j].rotor_inertia * qdd[j];
                    sum[j] += (tau[[k, j]] - model[j] - friction - rotor).powi(2);
                    count[j] += 1.0;
                }
            }
        }
        for j in 0..6 {
            let left = f64::sqrt(sum[j] / count[j]);
            let noise = machine.errors.torque[j];
            assert!(
                left > 0.8 * noise && left < 1.5 * noise,
                "joint {}: {left} N·m, noise {noise}",
                j + 1
            );
        }
    }
}
