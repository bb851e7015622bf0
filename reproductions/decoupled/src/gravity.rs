//! Gravity from runs at constant speed, there and back (COMAU paper, section 3.2.1).

use crate::DecoupledError;
use crate::joint::GRAVITY;
use crate::run::Run;
use identify::least_squares::{Accumulator, Gram, SolveOptions, Triangle, block_covariance, solve};
use serde::Serialize;

/// Gravity of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Gravity {
    /// mx and my, kg·m.
    pub moments: [f64; 2],
    /// Their standard deviations.
    pub std: [f64; 2],
    /// Friction at the run's speed, forwards and backwards, N·m.
    pub friction: [f64; 2],
    /// That speed, rad/s.
    pub speed: f64,
    /// Samples at constant speed.
    pub samples: usize,
}

/// Share of the top speed from which a sample is at constant speed.
const CRUISE: f64 = 0.999;
/// What is left out at the beginning of each way, s: the controller settles.
const SETTLE: f64 = 0.5;
/// Length of a block of time from which deviations are taken, s.
const BLOCK: f64 = 0.1;

impl Gravity {
    /// Amplitude k (N·m) and offset (rad) of τ = k sin(q + q^off) (equation 23).
    pub fn sine(&self) -> [f64; 2] {
        let [mx, my] = self.moments;
        [GRAVITY * mx.hypot(my), mx.atan2(-my)]
    }

    /// Torque at position `q`, N·m.
    pub fn torque(&self, q: f64) -> f64 {
        GRAVITY * (self.moments[0] * q.cos() - self.moments[1] * q.sin())
    }

    /// From a run there and back at constant speed: without acceleration the torque is gravity, and one value of friction each
    /// way.
    ///
    /// # Errors
    /// Fewer than a hundred samples at constant speed either way.
    pub fn of(run: &Run) -> Result<Self, DecoupledError> {
        let top = run.speed();
        let wait = (SETTLE / run.step) as usize;
        let each = ((BLOCK / run.step) as usize).max(1);
        let (mut blocks, mut rows) = (Vec::new(), Accumulator::new(4));
        let (mut pending, mut way, mut since) = (0, 0.0, 0);
        let mut samples = [0usize; 2];
        for (k, [_, v, _]) in run.reference.iter().enumerate() {
            let cruising = v.abs() >= CRUISE * top && top > 0.0;
            since = if cruising && v.signum() == way {
                since + 1
            } else {
                0
            };
            way = if cruising { v.signum() } else { 0.0 };
            if !cruising || since < wait {
                continue;
            }
            let (sin, cos) = run.q[k].sin_cos();
            let back = usize::from(*v < 0.0);
            samples[back] += 1;
            let row = [
                GRAVITY * cos,
                -GRAVITY * sin,
                1.0 - back as f64,
                -(back as f64),
            ];
            rows.push(&row, run.tau[k], 1.0)?;
            pending += 1;
            if pending == each {
                blocks.push(std::mem::replace(&mut rows, Accumulator::new(4)).finish()?);
                pending = 0;
            }
        }
        if samples.iter().any(|&n| n < 100) || blocks.is_empty() {
            return Err(DecoupledError::Recording {
                source_name: run.source.clone(),
                problem: format!(
                    "has {} samples at constant speed forwards and {} backwards, after {SETTLE} s for the controller; a hundred each way \
                     are needed",
                    samples[0], samples[1]
                ),
            });
        }
        let options = SolveOptions::default();
        let found = solve(&Triangle::stack(&blocks)?, &options)?;
        let grams: Vec<Gram> = blocks.iter().map(Gram::from).collect();
        let covariance = block_covariance(&grams, &found, options.ridge, None)?;
        let found = found.with_covariance(covariance)?;
        let p = &found.parameters;
        Ok(Self {
            moments: [p[0], p[1]],
            std: [found.std[0], found.std[1]],
            friction: [p[2], p[3]],
            speed: top,
            samples: samples[0] + samples[1],
        })
    }
}
