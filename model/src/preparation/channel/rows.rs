//! Rows of one joint: its torque, and shared and own columns at a delay.

use super::systems::{Joint, Systems};
use faer::linalg::matmul::matmul;
use faer::linalg::solvers::Solve;
use faer::{Accum, Mat, MatRef, Par, Side};
use signal::correlation::correlation_time;
use signal::delay::{Search, System, rows_at};

/// Least variance of a residual, relative to the torque's mean square: no model is right to a thousandth.
const PRECISION: f64 = 1e-6;
/// Rows of one joint: shared columns, own columns, and, from the second iteration on, the derivative by the delay.
pub(super) struct Rows {
    /// Values of the columns, row after row.
    pub values: Vec<f64>,
    /// Recorded torque of each row, N·m (N).
    pub target: Vec<f64>,
    /// Number of shared columns, the first ones.
    pub shared: usize,
    /// Number of own columns without the derivative by the delay.
    pub own: usize,
    /// Number of columns, shared, own and derivative.
    pub width: usize,
    /// Whether the derivative by the delay is among the columns, as the last.
    pub slope: bool,
    /// Weight of a row: one over residual variance and correlation time.
    pub weight: f64,
    /// Correlation time of the residual, rows.
    pub correlation: f64,
    /// Sums of products of all columns, the target last.
    sums: Mat<f64>,
}

impl Rows {
    /// Rows at a delay, s. `known` are the coefficients of shared and own columns, from which the derivative by
    /// the delay follows.
    pub fn new(
        joint: &Joint,
        systems: &Systems,
        delay: f64,
        known: Option<&[f64]>,
    ) -> Option<Self> {
        let search = Search::default();
        let shared = joint.standard.len();
        let mut columns: Vec<Vec<f64>> = joint
            .standard
            .iter()
            .map(|c| {
                if c.is_empty() {
                    vec![0.0; joint.torque.len()]
                } else {
                    c.clone()
                }
            })
            .collect();
        columns.extend([joint.rigid.clone(), joint.rotor.clone()]);
        columns.extend(joint.friction.iter().cloned());
        let own = columns.len() - shared;
        let whole = known.map(|known| {
            // The whole prediction: its slope, with the sign of a delay, is the last column.
            let mut whole = vec![0.0; joint.torque.len()];
            for (column, c) in columns.iter().zip(known) {
                whole.iter_mut().zip(column).for_each(|(w, v)| *w += c * v);
            }
            whole
        });
        columns.extend(whole.clone());
        let width = columns.len();
        let system = |columns| System {
            columns,
            target: joint.torque.clone(),
            segments: systems.segments.clone(),
            steps: systems.steps.clone(),
        };
        let (mut values, target) = rows_at(&system(columns), delay, &search)?;
        let slope = whole.is_some();
        if let Some(whole) = whole {
            // Central difference over a few ms of a spline: as good as its derivative.
            let h = 1e-3;
            let alone = system(vec![whole]);
            let [before, after] = [delay - h, delay + h].map(|d| rows_at(&alone, d, &search));
            let (before, after) = (before?.0, after?.0);
            for row in 0..target.len() {
                values[row * width + width - 1] = (after[row] - before[row]) / (2.0 * h);
            }
        }
        let mut rows = Self {
            sums: sums(&values, &target, width),
            values,
            target,
            shared,
            own,
            width,
            slope,
            weight: 1.0,
            correlation: 1.0,
        };
        rows.weigh()?;
        Some(rows)
    }

    /// Sets the weight from the residual of the best model of this joint alone.
    fn weigh(&mut self) -> Option<()> {
        let p = self.width;
        let mut a = self.products(|_| 1.0);
        let mut size = Vec::with_capacity(p);
        for i in 0..p {
            size.push(a[(i, i)].max(f64::MIN_POSITIVE).sqrt());
        }
        let b = Mat::from_fn(p, 1, |i, _| a[(i, p)] / size[i]);
        let yy = a[(p, p)];
        a = Mat::from_fn(p, p, |i, j| {
            a[(i, j)] / (size[i] * size[j]) + if i == j { 1e-7 } else { 0.0 }
        });
        let x = a.llt(Side::Lower).ok()?.solve(&b);
        let residual: Vec<f64> = self
            .values
            .chunks(p)
            .zip(&self.target)
            .map(|(row, y)| {
                let fit: f64 = row
                    .iter()
                    .enumerate()
                    .map(|(i, v)| v * x[(i, 0)] / size[i])
                    .sum();
                y - fit
            })
            .collect();
        let square: f64 = residual.iter().map(|e| e * e).sum();
        let rows = residual.len() as f64;
        self.correlation = correlation_time(&[&residual]);
        let effective = rows / self.correlation;
        // Parameters take their part of the effective rows: those that act, in fact fewer.
        let spent = (self.own as f64 + 6.0).min(0.5 * effective);
        let variance = (square / rows).max(PRECISION * yy / rows) * effective / (effective - spent);
        self.weight = 1.0 / (variance.max(f64::MIN_POSITIVE) * self.correlation);
        Some(())
    }

    /// Sums of products of all columns, each times a factor, the target last.
    pub fn products(&self, factor: impl Fn(usize) -> f64) -> Mat<f64> {
        let p = self.width;
        let factor = |i: usize| if i < p { factor(i) } else { 1.0 };
        Mat::from_fn(p + 1, p + 1, |i, j| {
            self.sums[(i, j)] * factor(i) * factor(j)
        })
    }
}

/// Sums of products of columns, row after row, and a target, which comes last.
fn sums(values: &[f64], target: &[f64], width: usize) -> Mat<f64> {
    let x = MatRef::from_row_major_slice(values, target.len(), width);
    let y = MatRef::from_column_major_slice(target, target.len(), 1);
    let product = |a: MatRef<f64>, b: MatRef<f64>| {
        let mut out = Mat::zeros(a.ncols(), b.ncols());
        // On one thread: the same bits whatever their number.
        matmul(&mut out, Accum::Replace, a.transpose(), b, 1.0, Par::Seq);
        out
    };
    let (xx, xy, yy) = (product(x, x), product(x, y), product(y, y));
    Mat::from_fn(width + 1, width + 1, |i, j| match (i < width, j < width) {
        (true, true) => xx[(i, j)],
        (true, false) => xy[(i, 0)],
        (false, true) => xy[(j, 0)],
        (false, false) => yy[(0, 0)],
    })
}
