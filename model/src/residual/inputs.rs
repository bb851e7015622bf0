//! Inputs of the units.

use crate::session::Session;
use feedforward::clock::Memory;
use feedforward::inputs::{Input, Signal};
use ndarray::Array2;
use physics::effects::{BankState, Dahl, Harmonic, LaggedSign, Phase, Sliding, Stop, Term};
use serde::{Deserialize, Serialize};

/// Preset of the compensator.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Preset {
    /// Preset with the best evidence: the joint's own motion, load and friction memory.
    #[default]
    Default,
    /// Preset of Wang et al.: q, q̇, q̈ of the joint and those further from the base.
    Ucm,
}

/// Input columns of all units, and for each joint the indices of its unit's inputs.
///
/// The default preset gives each joint its own motion, the size of its load, and friction states. On KR300 the
/// motion of the other joints lets a network recognise the 33 trajectories, while memory generalises.
/// `moving_only` uses a finer set of states. Two joints whose gears are `nested` in each other get each other's
/// velocity. `waves` are the orders of each joint's torque periodic in its position ([`super::waves::orders`];
/// empty: none), `companions` the other joints' positions and velocities that its unit also sees. The warm-up clock is left to the physics: a network extrapolates it without bound.
pub fn inputs(
    preset: Preset,
    joints: usize,
    moving_only: bool,
    nested: Option<[usize; 2]>,
    waves: &[Vec<f64>],
    companions: &[Vec<Input>],
) -> (Vec<Input>, Vec<Vec<usize>>) {
    let mut list: Vec<Input> = Vec::new();
    let mut seen = vec![Vec::new(); joints];
    match preset {
        Preset::Ucm => {
            for signal in [Signal::Position, Signal::Velocity, Signal::Acceleration] {
                list.extend((0..joints).map(|joint| Input {
                    joint,
                    signal: signal.clone(),
                }));
            }
            for (joint, columns) in seen.iter_mut().enumerate() {
                *columns = compensator::inputs::InputSet::Icm.columns(joint, joints);
            }
        }
        Preset::Default => {
            for (joint, columns) in seen.iter_mut().enumerate() {
                let own = [
                    Signal::Position,
                    Signal::Velocity,
                    Signal::Acceleration,
                    Signal::Load,
                ];
                let orders = waves.get(joint).into_iter().flatten();
                let periodic = orders.flat_map(|&order| {
                    [Phase::Sin, Phase::Cos].map(|phase| Term::Harmonic(Harmonic { order, phase }))
                });
                let terms = states(moving_only).into_iter().chain(periodic);
                for signal in own.into_iter().chain(terms.map(Signal::Term)) {
                    columns.push(list.len());
                    list.push(Input { joint, signal });
                }
                let other = nested.and_then(|[a, b]| match joint {
                    j if j == a => Some(b),
                    j if j == b => Some(a),
                    _ => None,
                });
                if let Some(joint) = other.filter(|_| moving_only) {
                    columns.push(list.len());
                    list.push(Input {
                        joint,
                        signal: Signal::Velocity,
                    });
                }
            }
        }
    }
    for (columns, companions) in seen.iter_mut().zip(companions) {
        columns.extend(
            companions
                .iter()
                .filter_map(|c| list.iter().position(|i| i == c)),
        );
    }
    (list, seen)
}

fn states(moving_only: bool) -> Vec<Term> {
    let degree = std::f64::consts::PI / 180.0;
    let stribeck = |v: f64| {
        Term::Sliding(Sliding::Stribeck {
            velocity: v * degree,
        })
    };
    let degressive = |v: f64| {
        Term::Sliding(Sliding::Degressive {
            velocity: v * degree,
        })
    };
    let stop = |w: f64| Term::Stop(Stop { width: w * degree });
    let dahl = |stiffness: f64| Term::Dahl(Dahl { stiffness });
    let lag = |time_constant: f64| {
        Term::LaggedSign(LaggedSign {
            time_constant,
            standstill: 3e-4,
        })
    };
    let mut terms = vec![Term::Sliding(Sliding::Coulomb)];
    if moving_only {
        terms.extend([0.5, 1.0, 2.0, 4.0].map(stribeck));
        terms.extend([4.0, 8.0, 30.0].map(degressive));
        terms.extend([0.0005, 0.002, 0.01, 0.05, 0.2, 1.0].map(stop));
        terms.extend([30.0, 100.0, 300.0, 1e3, 3e3, 1e4, 3e4].map(dahl));
        terms.extend([0.1, 0.3, 1.0].map(lag));
    } else {
        terms.extend([0.5, 2.0].map(stribeck));
        terms.extend([100.0, 1e3, 1e4].map(dahl));
        terms.extend([0.0005, 0.002, 0.05].map(stop));
        terms.push(lag(0.3));
    }
    terms
}

/// Input table of every recording at its samples, shape (samples, inputs).
///
/// Terms and load pass the recording's torque filter where it has one, as the torque did. `memory` is the
/// memory of the terms at the end of the trajectories that the session knows.
pub fn input_table(
    session: &Session,
    inputs: &[Input],
    load: &[Array2<f64>],
    memory: &[Memory],
) -> Vec<Array2<f32>> {
    let mut tables: Vec<Array2<f32>> = session
        .parts
        .iter()
        .map(|p| Array2::zeros((p.at_samples.len(), inputs.len())))
        .collect();
    let joints = load.first().map_or(0, Array2::ncols);
    for joint in 0..joints {
        let own: Vec<(usize, &Signal)> = inputs
            .iter()
            .enumerate()
            .filter(|(_, i)| i.joint == joint)
            .map(|(k, i)| (k, &i.signal))
            .collect();
        let terms: Vec<(usize, Term)> = own
            .iter()
            .filter_map(|(k, s)| {
                if let Signal::Term(term) = s {
                    Some((*k, term.clone()))
                } else {
                    None
                }
            })
            .collect();
        let list: Vec<Term> = terms.iter().map(|(_, term)| term.clone()).collect();
        let known: Vec<&BankState> = memory.iter().filter_map(|m| m.inputs.get(joint)).collect();
        let columns = session.columns(joint, &list, load, &known);
        for (part, (table, columns)) in tables.iter_mut().zip(&columns).enumerate() {
            let motion = &session.parts[part].at_samples;
            for ((k, _), values) in terms.iter().zip(columns.columns()) {
                table.column_mut(*k).assign(&values.mapv(|v| v as f32));
            }
            for (k, signal) in &own {
                let values = match signal {
                    Signal::Position => motion.q.column(joint).to_vec(),
                    Signal::Velocity => motion.qd.column(joint).to_vec(),
                    Signal::Acceleration => motion.qdd.column(joint).to_vec(),
                    Signal::Load => {
                        let fine: Vec<f64> =
                            load[part].column(joint).iter().map(|l| l.abs()).collect();
                        session.parts[part].to_samples(&fine)
                    }
                    Signal::Term(_) => continue,
                };
                for (target, value) in table.column_mut(*k).iter_mut().zip(values) {
                    *target = value as f32;
                }
            }
        }
    }
    tables
}

/// Stores the memory of the input terms at the end of each training trajectory on the clock.
pub fn remember(
    memory: &mut [Memory],
    session: &Session,
    inputs: &[Input],
    load: &[Array2<f64>],
    recordings: usize,
) {
    for joint in 0..load.first().map_or(0, Array2::ncols) {
        let terms: Vec<Term> = inputs
            .iter()
            .filter(|i| i.joint == joint)
            .filter_map(|i| match &i.signal {
                Signal::Term(term) => Some(term.clone()),
                _ => None,
            })
            .collect();
        let states = session.end_states(joint, &terms, load, recordings);
        for (memory, state) in memory.iter_mut().zip(states) {
            memory.inputs.push(state);
        }
    }
}
