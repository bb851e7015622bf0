//! Residuals over time.

use super::regime::Regime;
use std::ops::Range;

/// A residual of N joints over stretches of time.
#[derive(Debug, Clone, Default)]
pub struct Signal {
    /// N.
    pub dof: usize,
    /// Time of each sample, s.
    pub time: Vec<f64>,
    /// Rows of each stretch without a break.
    pub stretches: Vec<Range<usize>>,
    /// Samples × N, row after row, N·m or N.
    pub values: Vec<f64>,
    /// Samples × N, how each joint moved.
    pub regimes: Vec<Regime>,
}

impl Signal {
    /// Without samples.
    pub fn new(dof: usize) -> Self {
        Self {
            dof,
            ..Self::default()
        }
    }

    /// Adds a sample; a new stretch begins where `breaks`.
    pub fn push(&mut self, time: f64, values: &[f64], regimes: &[Regime], breaks: bool) {
        let row = self.time.len();
        match self.stretches.last_mut() {
            Some(last) if !breaks => last.end = row + 1,
            _ => self.stretches.push(row..row + 1),
        }
        self.time.push(time);
        self.values.extend_from_slice(values);
        self.regimes.extend_from_slice(regimes);
    }

    /// Adds what another has.
    pub fn append(&mut self, other: &Self) {
        let rows = self.time.len();
        self.time.extend_from_slice(&other.time);
        self.values.extend_from_slice(&other.values);
        self.regimes.extend_from_slice(&other.regimes);
        let moved = other.stretches.iter().map(|s| s.start + rows..s.end + rows);
        self.stretches.extend(moved);
    }

    /// Time that it covers, s.
    pub fn seconds(&self) -> f64 {
        let each = self.stretches.iter().filter(|s| !s.is_empty());
        each.map(|s| self.time[s.end - 1] - self.time[s.start])
            .sum()
    }

    /// Value of a joint at a row.
    pub fn at(&self, row: usize, joint: usize) -> f64 {
        self.values[row * self.dof + joint]
    }

    /// How a joint moved at a row.
    pub fn regime(&self, row: usize, joint: usize) -> Regime {
        self.regimes[row * self.dof + joint]
    }

    /// Root mean square of every joint.
    pub fn rms(&self) -> Vec<f64> {
        let rows = self.time.len().max(1) as f64;
        let of = |j: usize| {
            let squares = self
                .values
                .iter()
                .skip(j)
                .step_by(self.dof.max(1))
                .map(|v| v * v);
            (squares.sum::<f64>() / rows).sqrt()
        };
        (0..self.dof).map(of).collect()
    }
}
