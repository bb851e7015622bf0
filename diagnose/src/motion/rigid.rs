//! Torque of the rigid body over tables, both cores at work.

use ndarray::{Array2, Axis};
use physics::dynamics::{Workspace, inverse_dynamics};
use physics::robot::Robot;
use rayon::prelude::*;

/// Torque of the rigid body over tables of shape (samples, joints).
pub fn rigid_torque(
    robot: &Robot,
    q: &Array2<f64>,
    qd: &Array2<f64>,
    qdd: &Array2<f64>,
) -> Array2<f64> {
    rows(robot, q, qd, qdd, inverse_dynamics)
}

/// Applies an algorithm row by row, both cores at work.
pub(super) fn rows(
    robot: &Robot,
    q: &Array2<f64>,
    qd: &Array2<f64>,
    qdd: &Array2<f64>,
    algorithm: impl Fn(&Robot, &mut Workspace, &[f64], &[f64], &[f64], &mut [f64]) + Sync,
) -> Array2<f64> {
    const BLOCK: usize = 512;
    let n = robot.dof();
    let mut out = Array2::zeros(q.dim());
    let chunk = |table: &Array2<f64>, b: usize| {
        let end = ((b + 1) * BLOCK).min(table.nrows());
        table
            .slice_axis(Axis(0), (b * BLOCK..end).into())
            .as_standard_layout()
            .into_owned()
    };
    out.as_slice_mut()
        .expect("a new table is in standard layout")
        .par_chunks_mut(BLOCK * n)
        .enumerate()
        .for_each(|(b, tau)| {
            let mut workspace = Workspace::new(robot);
            let (q, qd, qdd) = (chunk(q, b), chunk(qd, b), chunk(qdd, b));
            let (q, qd, qdd) = (q.as_slice(), qd.as_slice(), qdd.as_slice());
            let (Some(q), Some(qd), Some(qdd)) = (q, qd, qdd) else {
                unreachable!("standard layout")
            };
            for (i, tau) in tau.chunks_mut(n).enumerate() {
                let r = i * n..(i + 1) * n;
                algorithm(
                    robot,
                    &mut workspace,
                    &q[r.clone()],
                    &qd[r.clone()],
                    &qdd[r],
                    tau,
                );
            }
        });
    out
}
