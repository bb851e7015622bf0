//! The softMC manual's sine wave on single axes; the others stay.

use super::Motion;
use plant::reference::Command;
use std::f64::consts::TAU;

/// One axis from its start to `start + swing` and back, over and over; it starts at rest and ends after whole periods.
#[derive(Debug, Clone, PartialEq)]
pub struct Sine {
    /// Positions of all axes at the start.
    pub start: Vec<f64>,
    /// The axis that moves.
    pub axis: usize,
    /// From turning point to turning point.
    pub swing: f64,
    /// Hz.
    pub frequency: f64,
    /// Periods.
    pub periods: usize,
}

impl Motion for Sine {
    fn duration(&self) -> f64 {
        self.periods as f64 / self.frequency
    }

    fn at(&self, t: f64, command: &mut Command) {
        command.q.copy_from_slice(&self.start);
        command.qd.fill(0.0);
        command.qdd.fill(0.0);
        let (w, half) = (TAU * self.frequency, 0.5 * self.swing);
        let (sin, cos) = (w * t).sin_cos();
        command.q[self.axis] += half * (1.0 - cos);
        command.qd[self.axis] = half * w * sin;
        // At standstill before and after it rests; the wave itself starts with full acceleration, as the manual's does.
        if t > 0.0 && t < self.duration() {
            command.qdd[self.axis] = half * w * w * cos;
        }
    }
}
