//! The gap as motion: how long a simulated robot follows the recorded motion, and the tracking error of a
//! controller with the model's torque as feed-forward.
//!
//! A simulated robot is the rigid body with friction and rotor inertia, τ_b(q, q̇, q̈). Torque of the model
//! beyond that is taken along the recorded motion: τ_x(t) = τ̂(t) − τ_b(q, q̇, q̈ as recorded). It holds
//! effects with memory, shifts in time and errors of the torque measurement without a simulation of their own.
//! This is valid while the simulated motion is near the recorded one, which is what is measured.
//!
//! - Free: τ_b(q, q̇, q̈) = τ − τ_x(t) from the recorded state on, τ as recorded. A model without gap stays on the recorded
//!   motion.
//! - Closed loop: the robot is one that moves as recorded under the recorded torque, τ_x(t) = τ − τ_b. A controller tracks
//!   the recorded motion with u = τ̂ + M(q_r) (ω² (q_r − q) + 2 ζ ω (q̇_r − q̇)), and the gap is what its feedback must make up.

use crate::motion::frame::Frame;
use crate::schema::{ClosedLoop, Free, Simulation};
use ndarray::Array2;
use physics::batch::rigid_torque;
use physics::dynamics::{Workspace, mass_matrix};
use physics::robot::Robot;
use plant::mechanism::RestLaw;
use plant::{Friction, Plant};
use rayon::prelude::*;
use signal::quantile::median;
use std::f64::consts::TAU;
use std::ops::Range;

/// Integration step and control period, s.
const STEP: f64 = 1e-3;
/// Longest duration of motion that is simulated, s.
const LONGEST: f64 = 20.0;
/// Time between the starts of free runs, s, and their longest duration, s.
const FREE: (f64, f64) = (2.0, 5.0);
/// Distance from the recorded motion at which a free run ends, rad and m.
const TOLERANCE: [f64; 2] = [0.035, 0.01];
/// Bandwidth (Hz) and damping of the controller.
const CONTROLLER: (f64, f64) = (5.0, 0.8);
/// Speed below which the sign of velocity is softened, rad/s (m/s), in the simulation.
const SOFT: f64 = 0.005;

/// A model and its predicted torque at the recorded samples.
pub struct Model<'a> {
    /// Rigid body, friction and rotor inertia; its links are possible bodies.
    pub robot: &'a Robot,
    /// Predicted torque, N·m (N), shape (samples, joints).
    pub torque: &'a Array2<f64>,
}

/// Simulates the recording with two models. None where a simulation diverges.
pub fn compare(frame: &Frame, before: &Model, after: &Model) -> Option<Simulation> {
    let stretches = stretches(frame);
    let seconds: f64 = stretches.iter().map(|r| duration(frame, r)).sum();
    let (free, closed) = rayon::join(
        || [before, after].map(|m| follows(frame, m, &stretches)),
        || [before, after].map(|m| tracks(frame, after.robot, m.torque, &stretches)),
    );
    let [Some(tracked_before), Some(tracked_after)] = closed else {
        return None;
    };
    let [followed_before, followed_after] = free;
    Some(Simulation {
        seconds,
        closed_loop: ClosedLoop {
            bandwidth_hz: CONTROLLER.0,
            before: tracked_before,
            after: tracked_after,
        },
        free: Free {
            tolerance: tolerances(before.robot),
            starts: followed_before.len(),
            longest_s: FREE.1,
            before_s: median(followed_before)?,
            after_s: median(followed_after)?,
        },
    })
}

/// First trajectories of the recording, cut to the simulated duration.
fn stretches(frame: &Frame) -> Vec<Range<usize>> {
    let rate = frame.report().rate_hz;
    let mut left = (LONGEST * rate) as usize;
    let mut out = Vec::new();
    for segment in &frame.samples().segments {
        let n = segment.len().min(left);
        left -= n;
        // Too short to start a run in.
        if n as f64 > rate {
            out.push(segment.start..segment.start + n);
        }
    }
    out
}

fn duration(frame: &Frame, rows: &Range<usize>) -> f64 {
    let time = &frame.samples().time;
    time[rows.end - 1] - time[rows.start]
}

fn tolerances(robot: &Robot) -> Vec<f64> {
    let of = |rotation| if rotation { TOLERANCE[0] } else { TOLERANCE[1] };
    let joints = robot.joints().iter();
    joints.map(|j| of(j.kind.is_rotation())).collect()
}

/// τ_b on the recorded motion, N·m (N), shape (samples, joints).
fn body_torque(frame: &Frame, robot: &Robot) -> Array2<f64> {
    let m = frame.samples();
    let mut tau = rigid_torque(robot, &m.q, &m.qd, &m.qdd);
    for (j, joint) in robot.joints().iter().enumerate() {
        let friction = friction(joint.damping, joint.friction);
        let mut column = tau.column_mut(j);
        column += &m.qd.column(j).mapv(|v| friction.torque(v));
        column.scaled_add(joint.rotor_inertia, &m.qdd.column(j));
    }
    tau
}

fn friction(viscous: f64, coulomb: f64) -> Friction {
    Friction {
        viscous,
        coulomb,
        v_eps: SOFT,
        rest: RestLaw::default(),
    }
}

fn plant(frame: &Frame, robot: &Robot, row: usize) -> Plant {
    let joints = robot.joints();
    let motion = frame.samples();
    let mut plant = Plant::new(
        robot.clone(),
        robot.rotor_inertia(),
        joints
            .iter()
            .map(|j| friction(j.damping, j.friction))
            .collect(),
        Vec::new(),
        motion.q.row(row).to_vec(),
    );
    plant.v = motion.qd.row(row).to_vec();
    plant.a = motion.qdd.row(row).to_vec();
    plant
}

/// Interpolation of a table between its samples within one trajectory, by cubic splines (Catmull and Rom).
struct Between<'a> {
    table: &'a Array2<f64>,
    time: &'a [f64],
    rows: Range<usize>,
    at: usize,
}

impl<'a> Between<'a> {
    fn new(table: &'a Array2<f64>, frame: &'a Frame, rows: &Range<usize>) -> Self {
        Self {
            table,
            time: &frame.samples().time,
            rows: rows.clone(),
            at: rows.start,
        }
    }

    /// Values at the time `t`, s, which must not fall from call to call.
    fn values(&mut self, t: f64, out: &mut [f64]) {
        while self.at + 2 < self.rows.end && self.time[self.at + 1] <= t {
            self.at += 1;
        }
        let i = self.at;
        let last = self.rows.end - 1;
        let near = [
            i.saturating_sub(1).max(self.rows.start),
            i,
            (i + 1).min(last),
            (i + 2).min(last),
        ];
        let span = (self.time[near[2]] - self.time[i]).max(1e-9);
        let x = ((t - self.time[i]) / span).clamp(0.0, 1.0);
        let weights = [
            0.5 * x * (x * (2.0 - x) - 1.0),
            0.5 * (x * x * (3.0 * x - 5.0) + 2.0),
            0.5 * x * (x * (4.0 - 3.0 * x) + 1.0),
            0.5 * x * x * (x - 1.0),
        ];
        for (j, out) in out.iter_mut().enumerate() {
            *out = near
                .iter()
                .zip(weights)
                .map(|(&r, w)| w * self.table[[r, j]])
                .sum();
        }
    }
}

/// Time for which each free run stays within the tolerance, s.
fn follows(frame: &Frame, model: &Model, stretches: &[Range<usize>]) -> Vec<f64> {
    let acting = &frame.tau - model.torque + body_torque(frame, model.robot);
    let rate = frame.report().rate_hz;
    let stride = ((FREE.0 * rate) as usize).max(1);
    let starts: Vec<Range<usize>> = stretches
        .iter()
        .flat_map(|s| {
            let last = s.end.saturating_sub((rate as usize).max(2));
            (s.start..last.max(s.start + 1))
                .step_by(stride)
                .map(|a| a..s.end)
        })
        .collect();
    let tolerance = tolerances(model.robot);
    starts
        .par_iter()
        .map(|rows| run_free(frame, model.robot, &acting, rows, &tolerance))
        .collect()
}

fn run_free(
    frame: &Frame,
    robot: &Robot,
    acting: &Array2<f64>,
    rows: &Range<usize>,
    tolerance: &[f64],
) -> f64 {
    let motion = frame.samples();
    let mut plant = plant(frame, robot, rows.start);
    let (mut u, mut q) = (vec![0.0; robot.dof()], vec![0.0; robot.dof()]);
    let mut torque = Between::new(acting, frame, rows);
    let mut real = Between::new(&motion.q, frame, rows);
    let start = motion.time[rows.start];
    let steps = (duration(frame, rows).min(FREE.1) / STEP) as usize;
    for k in 0..steps {
        let t = start + k as f64 * STEP;
        torque.values(t + 0.5 * STEP, &mut u);
        plant.step(t, STEP, &u);
        real.values(t + STEP, &mut q);
        let near = |j: usize| (plant.q[j] - q[j]).abs() <= tolerance[j];
        if !(0..q.len()).all(near) {
            return k as f64 * STEP;
        }
    }
    steps as f64 * STEP
}

/// Root mean square tracking error per joint with a model's torque as feed-forward, rad (m).
fn tracks(
    frame: &Frame,
    robot: &Robot,
    feedforward: &Array2<f64>,
    stretches: &[Range<usize>],
) -> Option<Vec<f64>> {
    let n = robot.dof();
    let acting = feedforward - &frame.tau + body_torque(frame, robot);
    let w = TAU * CONTROLLER.0;
    let armature = robot.rotor_inertia();
    let motion = frame.samples();
    let sums: Vec<(Vec<f64>, usize)> = stretches
        .par_iter()
        .map(|rows| {
            let mut plant = plant(frame, robot, rows.start);
            let mut torque = Between::new(&acting, frame, rows);
            let mut position = Between::new(&motion.q, frame, rows);
            let mut velocity = Between::new(&motion.qd, frame, rows);
            let (mut u, mut q, mut v) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
            let mut squares = vec![0.0; n];
            let (mut mass, mut wanted) = (vec![0.0; n * n], vec![0.0; n]);
            let mut workspace = Workspace::new(robot);
            let steps = (duration(frame, rows) / STEP) as usize;
            for k in 0..steps {
                let t = motion.time[rows.start] + k as f64 * STEP;
                position.values(t, &mut q);
                velocity.values(t, &mut v);
                torque.values(t, &mut u);
                mass_matrix(robot, &mut workspace, &q, &mut mass);
                for j in 0..n {
                    let error = q[j] - plant.q[j];
                    squares[j] += error * error;
                    wanted[j] = w * w * error + 2.0 * CONTROLLER.1 * w * (v[j] - plant.v[j]);
                }
                for j in 0..n {
                    let coupled = mass[j * n..(j + 1) * n].iter().zip(&wanted);
                    u[j] += armature[j] * wanted[j] + coupled.map(|(m, a)| m * a).sum::<f64>();
                }
                plant.step(t, STEP, &u);
            }
            (squares, steps)
        })
        .collect();
    let steps: usize = sums.iter().map(|s| s.1).sum();
    let rms = |j: usize| (sums.iter().map(|s| s.0[j]).sum::<f64>() / steps.max(1) as f64).sqrt();
    let error: Vec<f64> = (0..n).map(rms).collect();
    error.iter().all(|e| e.is_finite()).then_some(error)
}

#[cfg(test)]
mod tests {
    use super::*;
    use datasets::Recording;

    fn pendulum(mass: f64) -> Robot {
        let text = format!(
            r#"<robot name="p"><link name="b"/><link name="l"><inertial><origin xyz="0.2 0 0"/><mass value="{mass}"/>
            <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link><joint name="j" type="continuous">
            <parent link="b"/><child link="l"/><axis xyz="0 1 0"/><dynamics damping="0.5" friction="0.2"/></joint></robot>"#
        );
        Robot::from_urdf_str(&text).unwrap()
    }

    /// Ten seconds of a pendulum of 1 kg at 200 Hz.
    fn frame(robot: &Robot) -> Frame {
        let time: Vec<f64> = (0..2000).map(|i| 0.005 * f64::from(i)).collect();
        let column = |f: &dyn Fn(f64) -> f64| -> Array2<f64> {
            Array2::from_shape_fn((time.len(), 1), |(i, _)| f(time[i]))
        };
        let w = 2.3;
        let q = column(&|t| 0.8 * (w * t).sin());
        let (qd, qdd) = (
            column(&|t| 0.8 * w * (w * t).cos()),
            column(&|t| -0.8 * w * w * (w * t).sin()),
        );
        let law = friction(0.5, 0.2);
        let tau = rigid_torque(robot, &q, &qd, &qdd) + qd.mapv(|v| law.torque(v));
        let recording = Recording::new("pendulum", time, q, Some(tau.clone()));
        Frame::new(&recording, tau, &datasets::PrepareOptions::low_passed(40.0)).unwrap()
    }

    #[test]
    fn the_right_model_follows_and_tracks() {
        let (right, heavy) = (pendulum(1.0), pendulum(1.3));
        let frame = frame(&right);
        let torque = |r: &Robot| body_torque(&frame, r);
        let (good, bad) = (torque(&right), torque(&heavy));
        let model = |robot, torque| Model { robot, torque };
        let found = compare(&frame, &model(&heavy, &bad), &model(&right, &good)).unwrap();
        assert_eq!(found.free.after_s, FREE.1, "{found:?}");
        assert!(found.free.before_s < 1.0, "{found:?}");
        let (before, after) = (found.closed_loop.before[0], found.closed_loop.after[0]);
        // 0.3 kg at 0.2 m: 0.6 N·m of gravity against a stiffness of (0.05 kg·m²)(2π·5 Hz)².
        let gravity = 0.3 * 0.2 * 9.81 / (0.05 * (TAU * CONTROLLER.0).powi(2));
        assert!(
            before > 0.5 * gravity && before < 1.5 * gravity,
            "{before} {gravity}"
        );
        assert!(after < 0.02 * before, "{after} {before}");
    }
}
