//! One joint's rows, and what a gear's departure from its motor says of it.

use super::products::Products;
use std::ops::Range;

/// Part by which laws that the equation does not have shift a stiffness, and a gap: chosen on seeds 9101 and 9102 of the project's own
/// simulator.
pub(super) const LAWS: [f64; 2] = [0.04, 0.02];
/// Deviations of a stiffness or a gap above nothing, and part of the torque beyond the motor's own that it explains, from which a departure is
/// the gear's and not the encoder's.
pub(super) const SURE: f64 = 3.0;
pub(super) const EXPLAINS: f64 = 0.05;

/// Length of a block that knows nothing of the next one, s.
const BLOCK: f64 = 3.0;

/// One joint on the fitted rows.
#[derive(Clone, Debug)]
pub struct Rows {
    /// Departure of the link, rad, and its rate.
    pub departure: Vec<f64>,
    pub rate: Vec<f64>,
    /// Velocity, its softened sign, and acceleration of the motor, and ones.
    pub motor: [Vec<f64>; 4],
    /// Sine and cosine of the joint's position: what an encoder whose disc is not centred shows as a departure.
    pub turn: [Vec<f64>; 2],
    /// Torque that the joint's own link alone needs.
    pub own: Vec<f64>,
    /// Measured torque; rows without weight are left out.
    pub torque: Vec<f64>,
    pub counts: Vec<bool>,
    /// Trajectories.
    pub trajectories: Vec<Range<usize>>,
    /// Rows per second.
    pub rate_hz: f64,
}

/// Flanks of a gear.
#[derive(Clone, Copy, Debug)]
pub struct Flanks {
    /// Where they stand, rad; the same where there is no gap.
    pub at: [f64; 2],
    /// Stiffness where they begin, N·m/rad, and its deviation; none where they are too stiff to tell.
    pub stiffness: Option<[f64; 2]>,
    /// Half of the gap and its deviation; none of a spring.
    pub half_gap: Option<[f64; 2]>,
    /// Inertia that turns with the motor, kg·m².
    pub inertia: f64,
    /// Part of the squared torque beyond what the motor itself takes that the gear accounts for.
    pub explained: f64,
    /// Root mean square of the departure between the flanks and beyond them.
    pub parts: [f64; 2],
}

impl Rows {
    /// Rows cut into blocks.
    pub(super) fn blocks(&self) -> Vec<Vec<usize>> {
        let length = (BLOCK * self.rate_hz).max(1.0);
        let cut = |rows: &Range<usize>| {
            let (start, all) = (rows.start, rows.len());
            let n = ((all as f64 / length).round() as usize).max(1);
            (0..n).map(move |k| (start + k * all / n..start + (k + 1) * all / n).collect())
        };
        self.trajectories.iter().flat_map(cut).collect()
    }

    /// Products of some columns and what was measured over some rows.
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

    /// Sum of squares of the torque that some columns leave.
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

/// Root mean square.
pub(super) fn rms(x: impl Iterator<Item = f64>) -> f64 {
    let (sum, n) = x.fold((0.0, 0usize), |(s, n), x| (s + x * x, n + 1));
    (sum / n.max(1) as f64).sqrt()
}
