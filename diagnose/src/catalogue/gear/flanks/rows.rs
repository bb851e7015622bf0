//! Rows of one joint for the fit of its gear, and the flanks found.

use super::products::Products;
use std::ops::Range;

/// Relative error of a stiffness, and of a gap, by laws that the equation lacks: chosen on seeds 9101 and 9102
/// of the project's own simulator.
pub(super) const LAWS: [f64; 2] = [0.04, 0.02];
/// Least stiffness or gap, in deviations, and least part of the torque beyond the motor's own that it explains.
/// Below either, a departure is the encoder's error and not the gear's.
pub(super) const SURE: f64 = 3.0;
pub(super) const EXPLAINS: f64 = 0.05;

/// Length of a block of the jackknife, s, which counts as independent of the next one.
const BLOCK: f64 = 3.0;

/// Rows of one joint: the fitted rows.
#[derive(Clone, Debug)]
pub struct Rows {
    /// Departure of the link, rad, and its rate, rad/s.
    pub departure: Vec<f64>,
    pub rate: Vec<f64>,
    /// Motor's velocity, its softened sign, its acceleration, and ones.
    pub motor: [Vec<f64>; 4],
    /// Sine and cosine of the joint's position: departure that an encoder with an eccentric disc shows.
    pub turn: [Vec<f64>; 2],
    /// Torque that the joint's own link alone needs, N·m.
    pub own: Vec<f64>,
    /// Measured torque, N·m, and whether each row is counted; rows without weight are not.
    pub torque: Vec<f64>,
    pub counts: Vec<bool>,
    /// Ranges of the rows of each trajectory.
    pub trajectories: Vec<Range<usize>>,
    /// Rate of the rows, Hz.
    pub rate_hz: f64,
}

/// Flanks of a joint's gear as fitted to the departure of link from motor.
#[derive(Clone, Copy, Debug)]
pub struct Flanks {
    /// Departure of link from motor at which each flank begins, rad; equal where there is no gap.
    pub at: [f64; 2],
    /// Stiffness at the flanks and its standard deviation, N·m/rad; none where they are too stiff to tell.
    pub stiffness: Option<[f64; 2]>,
    /// Half of the gap and its standard deviation, rad; none for a spring.
    pub half_gap: Option<[f64; 2]>,
    /// Inertia that turns with the motor, kg·m².
    pub inertia: f64,
    /// Part of the squared torque that the gear explains, of that beyond the motor's own torque.
    pub explained: f64,
    /// Root mean square of the departure between the flanks and beyond them, rad.
    pub parts: [f64; 2],
}

impl Rows {
    /// Rows by block of the jackknife.
    pub(super) fn blocks(&self) -> Vec<Vec<usize>> {
        let length = (BLOCK * self.rate_hz).max(1.0);
        let cut = |rows: &Range<usize>| {
            let (start, all) = (rows.start, rows.len());
            let n = ((all as f64 / length).round() as usize).max(1);
            (0..n).map(move |k| (start + k * all / n..start + (k + 1) * all / n).collect())
        };
        self.trajectories.iter().flat_map(cut).collect()
    }

    /// Sums of products of some columns and the measured values over some rows.
    pub(super) fn products(
        &self,
        columns: &[&Vec<f64>],
        measured: &[f64],
        over: &[usize],
    ) -> Products {
        let mut sums = Products::new(columns.len());
        let mut row = vec![0.0; columns.len()];
        for &i in over.iter().filter(|&&i| self.counts[i]) {
            row.iter_mut().zip(columns).for_each(|(x, c)| *x = c[i]);
            sums.row(&row, measured[i]);
        }
        sums
    }

    /// Sum of squares of the torque's residual beside some columns.
    pub(super) fn left(&self, columns: &[&Vec<f64>]) -> Option<f64> {
        let all: Vec<usize> = (0..self.torque.len()).collect();
        let x = self.products(columns, &self.torque, &all).solve()?;
        let counted = all.iter().filter(|&&i| self.counts[i]);
        let left = counted.map(|&i| {
            let each = columns.iter().zip(&x);
            (self.torque[i] - each.map(|(c, b)| c[i] * b).sum::<f64>()).powi(2)
        });
        Some(left.sum())
    }
}

/// Root mean square of the values `x`; zero where there are none.
pub(super) fn rms(x: impl Iterator<Item = f64>) -> f64 {
    let (sum, n) = x.fold((0.0, 0usize), |(s, n), x| (s + x * x, n + 1));
    (sum / n.max(1) as f64).sqrt()
}
