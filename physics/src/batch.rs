//! Rigid-body dynamics over tables of motion, all cores at work. Same results whatever the number of threads.

use crate::dynamics::{Workspace, inverse_dynamics, regressor};
use crate::robot::{PARAMETERS_PER_LINK, Robot};
use ndarray::{Array2, ArrayView2, Axis};
use rayon::prelude::*;
use std::ops::Range;

/// Number of rows that one task works on.
const BLOCK: usize = 512;

/// Rigid-body torque over tables of shape (samples, joints), N·m (N).
///
/// # Panics
/// When a table has another shape.
pub fn rigid_torque(
    robot: &Robot,
    q: &Array2<f64>,
    qd: &Array2<f64>,
    qdd: &Array2<f64>,
) -> Array2<f64> {
    by_row(robot, q, qd, qdd, inverse_dynamics)
}

/// Torque by any algorithm of one state, over tables of shape (samples, joints), N·m (N).
///
/// # Panics
/// When a table has another shape.
pub fn by_row(
    robot: &Robot,
    q: &Array2<f64>,
    qd: &Array2<f64>,
    qdd: &Array2<f64>,
    algorithm: impl Fn(&Robot, &mut Workspace, &[f64], &[f64], &[f64], &mut [f64]) + Sync,
) -> Array2<f64> {
    let n = robot.dof();
    assert_eq!(q.ncols(), n, "a column for each joint");
    let mut out = Array2::zeros(q.dim());
    let torque = out.as_slice_mut().expect("a new table is in one piece");
    let tasks = torque.par_chunks_mut(BLOCK * n).enumerate();
    tasks.for_each(|(b, torque)| {
        let mut workspace = Workspace::new(robot);
        let rows = b * BLOCK..b * BLOCK + torque.len() / n;
        let states = States::new([q, qd, qdd], rows);
        for (i, tau) in torque.chunks_exact_mut(n).enumerate() {
            let [q, qd, qdd] = states.at(i);
            algorithm(robot, &mut workspace, q, qd, qdd, tau);
        }
    });
    out
}

/// Columns of the rigid-body regressor: for each of `entries`, a joint and the place of a standard parameter, the joint's torque
/// per unit of that parameter at every sample. Rows that are not `needed` stay zero.
///
/// # Panics
/// When a table has another shape than (samples, joints).
pub fn regressor_columns(
    robot: &Robot,
    q: &Array2<f64>,
    qd: &Array2<f64>,
    qdd: &Array2<f64>,
    entries: &[(usize, usize)],
    needed: impl Fn(usize) -> bool + Sync,
) -> Vec<Vec<f64>> {
    let (n, samples) = (robot.dof(), q.nrows());
    assert_eq!(q.ncols(), n, "a column for each joint");
    let width = PARAMETERS_PER_LINK * n;
    // Values of one task, entry by entry.
    let task = |b: usize| -> Vec<f64> {
        let rows = b * BLOCK..((b + 1) * BLOCK).min(samples);
        let mut workspace = Workspace::new(robot);
        let mut y = vec![0.0; n * width];
        let mut values = vec![0.0; entries.len() * rows.len()];
        let states = States::new([q, qd, qdd], rows.clone());
        for i in (0..rows.len()).filter(|i| needed(rows.start + i)) {
            let [q, qd, qdd] = states.at(i);
            regressor(robot, &mut workspace, q, qd, qdd, &mut y);
            for (own, (joint, parameter)) in values.chunks_exact_mut(rows.len()).zip(entries) {
                own[i] = y[joint * width + parameter];
            }
        }
        values
    };
    let tasks: Vec<Vec<f64>> = (0..samples.div_ceil(BLOCK))
        .into_par_iter()
        .map(task)
        .collect();
    let column = |entry: usize| {
        let parts = tasks.iter().flat_map(|values| {
            let rows = values.len() / entries.len();
            &values[entry * rows..(entry + 1) * rows]
        });
        parts.copied().collect()
    };
    (0..entries.len()).map(column).collect()
}

/// Position, velocity and acceleration of some samples, each sample in one piece.
struct States {
    joints: usize,
    tables: [Vec<f64>; 3],
}

impl States {
    fn new(tables: [&Array2<f64>; 3], rows: Range<usize>) -> Self {
        let part = |table: &Array2<f64>| {
            let part: ArrayView2<f64> = table.slice_axis(Axis(0), rows.clone().into());
            part.iter().copied().collect()
        };
        Self {
            joints: tables[0].ncols(),
            tables: tables.map(part),
        }
    }

    fn at(&self, row: usize) -> [&[f64]; 3] {
        let own = row * self.joints..(row + 1) * self.joints;
        [0, 1, 2].map(|k| &self.tables[k][own.clone()])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::Builtin;
    use ndarray::Array1;

    #[test]
    fn tables_have_the_rows_of_single_states_and_columns_add_up_to_torque() {
        let robot = Builtin::named("puma560").unwrap().robot();
        let (n, samples) = (robot.dof(), BLOCK + 7);
        let table = |k: f64| {
            Array2::from_shape_fn((samples, n), |(i, j)| {
                (k + 0.01 * i as f64 * (1.0 + j as f64)).sin()
            })
        };
        // Tables in another order of memory are read alike.
        let (q, qd) = (table(0.1), table(0.7).t().to_owned().reversed_axes());
        let qdd = table(1.9);
        let torque = rigid_torque(&robot, &q, &qd, &qdd);
        let mut workspace = Workspace::new(&robot);
        let mut tau = vec![0.0; n];
        let row = |t: &Array2<f64>, i: usize| t.row(i).to_vec();
        for i in [0, BLOCK - 1, BLOCK, samples - 1] {
            let (q, qd, qdd) = (row(&q, i), row(&qd, i), row(&qdd, i));
            inverse_dynamics(&robot, &mut workspace, &q, &qd, &qdd, &mut tau);
            assert_eq!(row(&torque, i), tau);
        }
        let parameters = robot.parameters();
        let entries: Vec<(usize, usize)> = (0..parameters.len()).map(|p| (1, p)).collect();
        let columns = regressor_columns(&robot, &q, &qd, &qdd, &entries, |row| row % 2 == 0);
        let mut sum = Array1::<f64>::zeros(samples);
        for (column, p) in columns.iter().zip(&parameters) {
            sum.scaled_add(*p, &Array1::from(column.clone()));
        }
        for i in 0..samples {
            let whole = if i % 2 == 0 { torque[[i, 1]] } else { 0.0 };
            assert!((sum[i] - whole).abs() < 1e-10 * (1.0 + whole.abs()), "{i}");
        }
    }
}
