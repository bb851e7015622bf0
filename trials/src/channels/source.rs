//! Source of a torque channel.

use super::fault::Fault;
use crate::raw::TRACE_HZ;
use crate::raw::robot::Drawn;
use nalgebra::Vector3;
use physics::dynamics::{Workspace, inverse_dynamics};
use physics::robot::{Robot, RobotError};
use plant::arm::altered;
use plant::run::Trace;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

/// Torque on the clock of a trace, row after row.
pub struct Fed {
    /// Torque that enters the channel, N·m (N).
    pub torque: Vec<f64>,
    /// Whether the torque is computed, not measured, so that the channel adds no error of a sensor.
    pub exact: bool,
    /// Whether gravity's torque varies on some joint as much as a fifth of that joint's.
    pub gravity_varies: bool,
}

/// The torque of a trace as `fault` has it.
///
/// # Errors
/// The drawn bodies make no possible robot.
pub fn torque(
    fault: Fault,
    drawn: &Drawn,
    trace: &Trace,
    rng: &mut ChaCha8Rng,
) -> Result<Fed, RobotError> {
    let mut fed = Fed {
        torque: trace.tau.clone(),
        exact: false,
        gravity_varies: true,
    };
    match fault {
        Fault::GravityRemoved => {
            // The maker knows the robot a little better than its description does.
            let mut known = drawn.plain.clone();
            for joint in &mut known.joints {
                let body = &joint.link.inertia;
                let mass = 1.0 + rng.random_range(-0.03..0.03);
                joint.link.inertia = altered(body, mass, Vector3::zeros(), 1.0);
            }
            let gravity = along(&known.robot()?, trace, |_| [0.0; 2]);
            fed.gravity_varies = varies(&gravity, &trace.tau, trace.dof);
            let both = fed.torque.iter_mut().zip(gravity);
            both.for_each(|(t, g)| *t -= g);
        }
        Fault::JointSensor => {
            let n = trace.dof;
            let links = along(&drawn.plain.robot()?, trace, |i| {
                [trace.qd[i], trace.qdd[i]]
            });
            // Seals and bearings behind the sensor.
            let seals: Vec<f64> = (0..n).map(|_| rng.random_range(0.0..0.03)).collect();
            for (i, (t, link)) in fed.torque.iter_mut().zip(links).enumerate() {
                let (j, v) = (i % n, trace.qd[i]);
                let joint = &drawn.plain.joints[j];
                let loss = joint.damping * v + joint.friction * (v / drawn.plain.v_eps[j]).tanh();
                *t = link - drawn.plain.disc[j] * trace.qdd[i] + seals[j] * loss;
            }
        }
        Fault::Commanded => {
            fed.exact = true;
            if rng.random_bool(0.5) {
                fed.torque = feedforward(drawn, trace)?;
            }
        }
        _ => {}
    }
    Ok(fed)
}

/// Torque of `robot` at the positions of a trace, with the velocity and acceleration that `rates` has of an entry.
fn along(robot: &Robot, trace: &Trace, rates: impl Fn(usize) -> [f64; 2]) -> Vec<f64> {
    let n = trace.dof;
    let mut workspace = Workspace::new(robot);
    let mut all = vec![0.0; trace.tau.len()];
    for (row, out) in all.chunks_mut(n).enumerate() {
        let entries = row * n..(row + 1) * n;
        let both: Vec<[f64; 2]> = entries.clone().map(&rates).collect();
        let [v, a] = [0, 1].map(|k| both.iter().map(|b| b[k]).collect::<Vec<f64>>());
        inverse_dynamics(robot, &mut workspace, &trace.q[entries], &v, &a, out);
    }
    all
}

/// The feed-forward torque of the described robot along its reference, friction included.
fn feedforward(drawn: &Drawn, trace: &Trace) -> Result<Vec<f64>, RobotError> {
    let n = trace.dof;
    let robot = drawn.nominal.robot()?;
    let mut workspace = Workspace::new(&robot);
    let mut all = vec![0.0; trace.tau.len()];
    let bounds = trace.bounds();
    let part = |row: usize| bounds.partition_point(|b| *b <= row) - 1;
    for (row, out) in all.chunks_mut(n).enumerate() {
        let [low, high] = [bounds[part(row)], bounds[part(row) + 1] - 1];
        // The reference is smooth: central differences over two ticks are its derivatives.
        let middle = row.clamp(low + 1, high - 1);
        let at = |k: usize, j: usize| trace.q_ref[k * n + j];
        let state: Vec<[f64; 3]> = (0..n)
            .map(|j| {
                let (before, now, after) = (at(middle - 1, j), at(middle, j), at(middle + 1, j));
                [
                    at(row, j),
                    0.5 * (after - before) * TRACE_HZ,
                    (after - 2.0 * now + before) * TRACE_HZ * TRACE_HZ,
                ]
            })
            .collect();
        let [q, v, a] = [0, 1, 2].map(|k| state.iter().map(|s| s[k]).collect::<Vec<f64>>());
        inverse_dynamics(&robot, &mut workspace, &q, &v, &a, out);
        for (j, t) in out.iter_mut().enumerate() {
            let joint = &drawn.nominal.joints[j];
            *t += joint.damping * v[j]
                + joint.friction * (v[j] / (0.002 * joint.limits.velocity)).tanh();
        }
    }
    Ok(all)
}

fn varies(gravity: &[f64], tau: &[f64], n: usize) -> bool {
    let deviation = |table: &[f64], j: usize| {
        let column: Vec<f64> = table.iter().skip(j).step_by(n).copied().collect();
        let mean = column.iter().sum::<f64>() / column.len() as f64;
        (column.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / column.len() as f64).sqrt()
    };
    (0..n).any(|j| deviation(gravity, j) > 0.2 * deviation(tau, j))
}
