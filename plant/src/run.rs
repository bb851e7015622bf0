//! The closed loop of reference, controller and plant, and its perfect trace.

use crate::control::Controller;
use crate::integrate::Plant;
use crate::reference::{Command, Session};

/// Times of the control loop: steps and samples.
#[derive(Debug, Clone, Copy)]
pub struct Clock {
    /// Integration step of the plant, s.
    pub step: f64,
    /// Number of integration steps per control period.
    pub control: usize,
    /// Number of integration steps per sample.
    pub sample: usize,
}

/// Motion and torque without any sensor's error, at the samples of the trajectories. Tables are row after row,
/// N values each.
#[derive(Debug, Clone, Default)]
pub struct Trace {
    /// Number of joints, the length of a row.
    pub dof: usize,
    /// Session time of each sample, s.
    pub time: Vec<f64>,
    /// Number of samples of each trajectory.
    pub lengths: Vec<usize>,
    /// Motor-side position, rad (m).
    pub q: Vec<f64>,
    /// Motor-side velocity, rad/s (m/s).
    pub qd: Vec<f64>,
    /// Motor-side acceleration, rad/s² (m/s²).
    pub qdd: Vec<f64>,
    /// Motor torque without a sensor's error, N·m (N).
    pub tau: Vec<f64>,
    /// Torque by which each mechanism in turn changed the motor's, N values each.
    pub exerted: Vec<f64>,
    /// Commanded position, rad (m).
    pub q_ref: Vec<f64>,
    /// Position of the link behind each motor's transmission.
    pub link: Vec<f64>,
    /// Relative temperature where a mechanism has one, as [`crate::mechanism::Mechanism::warmth`]; NaN without one.
    pub warmth: Vec<f64>,
}

impl Trace {
    /// Number of samples of the trace.
    pub fn len(&self) -> usize {
        self.time.len()
    }

    /// True when nothing was sampled.
    pub fn is_empty(&self) -> bool {
        self.time.is_empty()
    }

    /// Position and velocity of joint `j` a part `w` of a step of `step` seconds after row `k`, by the cubic through the
    /// states of both rows.
    pub fn between(&self, j: usize, k: usize, w: f64, step: f64) -> [f64; 2] {
        let n = self.dof;
        let at = |row: usize| (self.q[row * n + j], step * self.qd[row * n + j]);
        let ((a, va), (b, vb)) = (at(k), at((k + 1).min(self.len() - 1)));
        let (c, d) = (3.0 * (b - a) - 2.0 * va - vb, 2.0 * (a - b) + va + vb);
        let position = a + w * (va + w * (c + w * d));
        let velocity = (va + w * (2.0 * c + 3.0 * w * d)) / step;
        [position, velocity]
    }

    /// First row of each trajectory, and the end.
    pub fn bounds(&self) -> Vec<usize> {
        let mut bounds = vec![0];
        for n in &self.lengths {
            bounds.push(bounds[bounds.len() - 1] + n);
        }
        bounds
    }
}

/// Runs the session. `axes` are the plant's joints that have motors and encoders; `delay` is that of the
/// recorded torque after the motion, s.
///
/// The torque is held over a control period. The recorded value is the mean of the periods before and after a
/// sample, since position, velocity and acceleration are those at the sample.
pub fn run(
    session: &Session,
    controller: &mut Controller,
    plant: &mut Plant,
    axes: &[usize],
    clock: Clock,
    delay: f64,
) -> Trace {
    let n = axes.len();
    let (start, end) = session.span();
    let steps = ((end - start) / clock.step).round() as usize;
    let lengths: Vec<usize> = session
        .lengths
        .iter()
        .map(|l| (l / (clock.step * clock.sample as f64)).round() as usize)
        .collect();
    let samples: usize = lengths.iter().sum();
    let mechanisms = plant.exerted.len() / plant.dof();
    let mut trace = Trace {
        dof: n,
        time: Vec::with_capacity(samples),
        q: Vec::with_capacity(samples * n),
        qd: Vec::with_capacity(samples * n),
        qdd: Vec::with_capacity(samples * n),
        q_ref: Vec::with_capacity(samples * n),
        exerted: Vec::with_capacity(samples * n * mechanisms),
        link: Vec::with_capacity(samples * n),
        warmth: Vec::with_capacity(samples * n),
        lengths,
        ..Trace::default()
    };
    // First step of each sample, ascending.
    let mut due = session
        .starts
        .iter()
        .zip(&trace.lengths)
        .flat_map(|(s, &count)| {
            let first = ((s - start) / clock.step).round() as usize;
            (0..count).map(move |k| first + k * clock.sample)
        })
        .collect::<Vec<_>>()
        .into_iter()
        .peekable();
    // What stands between a motor and the next one is its transmission.
    let ends: Vec<usize> = axes.iter().skip(1).copied().chain([plant.dof()]).collect();
    let mut command = Command::new(n);
    let mut torque = vec![0.0; n];
    let mut u = vec![0.0; plant.dof()];
    let (mut q, mut v) = (vec![0.0; n], vec![0.0; n]);
    // Torques of all control periods, for the delay.
    let mut held: Vec<f64> = Vec::with_capacity((steps / clock.control + 2) * n);
    let (mut before, mut exerted_before) = (vec![0.0; n], vec![0.0; plant.exerted.len()]);
    for k in 0..=steps {
        let t = start + k as f64 * clock.step;
        if k % clock.control == 0 {
            session.sample(t, &mut command);
            for (j, &axis) in axes.iter().enumerate() {
                q[j] = plant.q[axis];
                v[j] = plant.v[axis];
            }
            controller.torque(&command, &q, &v, &mut torque);
            for (j, &axis) in axes.iter().enumerate() {
                u[axis] = torque[j];
            }
            held.extend_from_slice(&torque);
        }
        let sampled = due.next_if_eq(&k).is_some();
        if sampled {
            trace.time.push(t);
            session.sample(t, &mut command);
            trace.q_ref.extend_from_slice(&command.q);
            for (j, &axis) in axes.iter().enumerate() {
                trace.q.push(plant.q[axis]);
                trace.qd.push(plant.v[axis]);
                before[j] = plant.a[axis];
                trace.link.push(plant.q[axis..ends[j]].iter().sum());
                trace.warmth.push(plant.warmth(axis).unwrap_or(f64::NAN));
            }
            exerted_before.copy_from_slice(&plant.exerted);
        }
        plant.step(t, clock.step, &u);
        if sampled {
            trace.qdd.extend(
                axes.iter()
                    .zip(&before)
                    .map(|(&axis, b)| 0.5 * (b + plant.a[axis])),
            );
            for m in 0..mechanisms {
                let row = m * plant.dof();
                let mean =
                    |&axis: &usize| -0.5 * (exerted_before[row + axis] + plant.exerted[row + axis]);
                trace.exerted.extend(axes.iter().map(mean));
            }
        }
    }
    let period = clock.step * clock.control as f64;
    let periods = held.len() / n;
    for &t in &trace.time {
        // held[k] spans [k, k+1] periods, so that its time is k + 1/2.
        let x = ((t - delay - start) / period - 0.5).clamp(0.0, (periods - 1) as f64 - 1e-9);
        let (k, w) = (x as usize, x.fract());
        let (a, b) = (
            &held[k * n..][..n],
            &held[(k + 1).min(periods - 1) * n..][..n],
        );
        trace
            .tau
            .extend(a.iter().zip(b).map(|(a, b)| a + (b - a) * w));
    }
    trace
}
