//! What a first fit leaves, without what is only early or late.

use crate::algebra::cholesky::Cholesky;
use crate::catalogue::time_delay;
use crate::motion::frame::Frame;
use crate::motion::scene::Scene;
use ndarray::{Array1, Array2, ArrayView1};

/// A residual without what each joint's torque leaves by being late or early, at the recorded samples, shape (samples,
/// joints): a few milliseconds at every reversal hide a line over position. `weight` on the fitted rows, shape (rows, joints).
pub(super) fn on_time(
    scene: &Scene,
    data: &Frame,
    residual: &Array2<f64>,
    weight: &Array2<f64>,
) -> Array2<f64> {
    let mut out = residual.clone();
    for (joint, mut own) in out.columns_mut().into_iter().enumerate() {
        let fine = time_delay::changes(scene, joint);
        let columns: Vec<Vec<f64>> = fine.iter().map(|c| data.to_samples(c)).collect();
        // Sizes are fitted where the search fits, on its rows and in their band.
        let rows: Vec<Array1<f64>> = columns.iter().map(|c| data.thin(c)).collect();
        let y = data.thin(&own.to_vec());
        let weight = weight.column(joint);
        let weighed = |a: &Array1<f64>, b: &Array1<f64>| (a * b).dot(&weight);
        let k = rows.len();
        let a = Array2::from_shape_fn((k, k), |(i, j)| weighed(&rows[i], &rows[j]));
        let b: Array1<f64> = rows.iter().map(|c| weighed(c, &y)).collect();
        let sizes = Cholesky::raised(a, 1e-6).solve(b.view());
        for (column, size) in columns.iter().zip(sizes) {
            own.scaled_add(-size, &ArrayView1::from(column));
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use datasets::{PrepareOptions, Recording};
    use ndarray::Axis;
    use physics::dynamics::{Workspace, inverse_dynamics};
    use physics::effects::EarlySign;
    use physics::robot::Robot;
    use std::f64::consts::{FRAC_PI_2, TAU};

    const RATE: f64 = 250.0;

    /// Angle of a joint, or a derivative of it.
    fn angle(joint: usize, t: f64, order: i32) -> f64 {
        let [a, b] = [0.41 + 0.07 * joint as f64, 0.93 - 0.05 * joint as f64].map(|f| f * TAU);
        let turn = f64::from(order) * FRAC_PI_2;
        0.4 * a.powi(order) * (a * t + turn).sin()
            + 0.2 * b.powi(order) * (b * t + 1.0 + turn).sin()
    }

    /// Torque that the arm needs at some times, from the motion as it is written down.
    fn torque(robot: &Robot, times: impl Iterator<Item = f64>) -> Array2<f64> {
        let dof = robot.dof();
        let mut workspace = Workspace::new(robot);
        let mut out = Array2::zeros((0, dof));
        for t in times {
            let [q, qd, qdd] =
                [0, 1, 2].map(|k| (0..dof).map(|j| angle(j, t, k)).collect::<Vec<f64>>());
            let mut tau = vec![0.0; dof];
            inverse_dynamics(robot, &mut workspace, &q, &qd, &qdd, &mut tau);
            out.push_row(ArrayView1::from(&tau))
                .expect("as many joints");
        }
        out
    }

    #[test]
    fn a_line_over_position_is_left_and_lateness_is_not() {
        let robot = Robot::builtin("ur5").unwrap();
        let n = 3000;
        let time: Vec<f64> = (0..n).map(|i| f64::from(i) / RATE).collect();
        let q = Array2::from_shape_fn((time.len(), robot.dof()), |(i, j)| angle(j, time[i], 0));
        let now = torque(&robot, time.iter().copied());
        let late = torque(&robot, time.iter().map(|t| t - 0.0065));
        let spread = now.std_axis(Axis(0), 0.0);
        let line = |(i, j): (usize, usize)| 0.02 * spread[j] * (11.0 * q[[i, j]]).sin();
        let line = Array2::from_shape_fn(now.dim(), line);
        let recording = Recording::new("r", time, q, Some(now.clone()));
        let frame = Frame::new(&recording, now.clone(), &PrepareOptions::low_passed(40.0)).unwrap();
        let sign = EarlySign {
            velocity: 0.002,
            lead: 0.0,
        };
        let scale = frame.scale(&[], &vec![sign; robot.dof()]);
        let scene = Scene::new(&robot, frame.motion(), &scale);
        let weight = Array2::ones(frame.table_thin(&now).dim());
        let left = on_time(&scene, &frame, &(&late - &now + &line), &weight);
        let size = |x: &Array2<f64>, j: usize| x.column(j).dot(&x.column(j)).sqrt();
        for j in 0..robot.dof() {
            let (before, after) = (size(&(&late - &now), j), size(&(&left - &line), j));
            assert!(
                before > 2.0 * size(&line, j),
                "joint {j}: lateness hides nothing"
            );
            assert!(
                after < 0.25 * size(&line, j),
                "joint {j}: {after} of {}",
                size(&line, j)
            );
        }
    }
}
