//! B and D by least squares of the simulated outputs.
//!
//! With A and C fixed and the state zero at the start of each trajectory, the simulated output is linear
//! in the entries of B and D: y(k) = Σ_sj B_sj · C x_sj(k) + D u(k), where x_sj answers to input j acting on
//! state s alone. The residual is the simulation error itself, not the error one step ahead.

use super::state_space::StateSpace;
use super::subspace::Dynamics;
use crate::baseline::BaselineError;
use ::identify::least_squares::{Accumulator, SolveOptions, solve};
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatRef, Par};
use ndarray::Array2;
use std::ops::Range;

pub(super) fn fit(
    dynamics: &Dynamics,
    u: &Array2<f64>,
    y: &Array2<f64>,
    trajectories: &[Range<usize>],
    feedthrough: bool,
) -> Result<StateSpace, BaselineError> {
    let (a, c) = (dynamics.a.as_ref(), dynamics.c.as_ref());
    let (n, inputs, outputs) = (a.nrows(), u.ncols(), c.nrows());
    let answers = n * inputs;
    let direct = if feedthrough { outputs * inputs } else { 0 };
    let mut rows = Accumulator::new(answers + direct);
    let mut row = vec![0.0; answers + direct];
    // Column s + n·j of the states is x_sj.
    let mut states = Mat::<f64>::zeros(n, answers);
    let mut next = Mat::<f64>::zeros(n, answers);
    let mut seen = Mat::<f64>::zeros(outputs, answers);
    for trajectory in trajectories {
        states.fill(0.0);
        for k in trajectory.clone() {
            matmul(&mut seen, Accum::Replace, c, &states, 1.0, Par::Seq);
            for o in 0..outputs {
                for (value, column) in row.iter_mut().zip(0..answers) {
                    *value = seen[(o, column)];
                }
                if feedthrough {
                    row[answers..].fill(0.0);
                    for j in 0..inputs {
                        row[answers + o * inputs + j] = u[(k, j)];
                    }
                }
                rows.push(&row, y[(k, o)], 1.0)?;
            }
            matmul(&mut next, Accum::Replace, a, &states, 1.0, Par::Seq);
            for j in 0..inputs {
                for s in 0..n {
                    next[(s, s + n * j)] += u[(k, j)];
                }
            }
            std::mem::swap(&mut states, &mut next);
        }
    }
    let found = solve(&rows.finish()?, &SolveOptions::default())?.parameters;
    let entry = |i: usize| found.get(i).copied().unwrap_or(0.0);
    Ok(StateSpace {
        a: to_rows(a),
        b: table(n, inputs, |s, j| entry(s + n * j)),
        c: to_rows(c),
        d: table(outputs, inputs, |o, j| entry(answers + o * inputs + j)),
    })
}

fn table(rows: usize, columns: usize, entry: impl Fn(usize, usize) -> f64) -> Vec<Vec<f64>> {
    (0..rows)
        .map(|i| (0..columns).map(|j| entry(i, j)).collect())
        .collect()
}

fn to_rows(matrix: MatRef<'_, f64>) -> Vec<Vec<f64>> {
    table(matrix.nrows(), matrix.ncols(), |i, j| matrix[(i, j)])
}
