//! Two sources that write into one log by turns.

use ndarray::Array2;
use signal::quantile::median;
use std::ops::Range;

/// Least ratio of the offset of every second row to the difference of neighbouring rows of one source: white
/// noise alone makes 0.9.
const ALTERNATING: f64 = 3.0;
/// Least ratio of the offset of every second row to the torque's RMS; below it the alternation counts as a ripple.
const LARGE: f64 = 0.1;
/// Fraction of the rows at which zeros begin, from which on they are a source of their own.
const ZEROS: f64 = 0.1;

/// Form in which a second source shows in a torque.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Second {
    /// All torques are zero in its rows.
    Zeros,
    /// Every second row is another signal.
    Other,
}

/// Whether rows of two sources alternate in a torque; and the first row (from 0) of the second.
pub(crate) fn second(tau: &Array2<f64>, trajectories: &[Range<usize>]) -> Option<(Second, usize)> {
    let inner = || {
        trajectories
            .iter()
            .flat_map(|t| t.start + 1..t.end.max(t.start + 2) - 1)
    };
    let zero = |row: usize| tau.row(row).iter().all(|v| *v == 0.0);
    let begins: Vec<usize> = inner().filter(|&r| zero(r) && !zero(r - 1)).collect();
    let rows = inner().count().max(1) as f64;
    if begins.len() as f64 > ZEROS * rows {
        // Where a torque goes through zero its neighbours are small and of both signs; beside the rows of a second source they agree.
        let around = |f: &dyn Fn(f64, f64) -> f64| {
            let each = begins.iter().flat_map(|&r| {
                let ends = (r + 1..(r + 8).min(tau.nrows())).find(|&e| !zero(e));
                ends.into_iter().flat_map(move |e| {
                    (0..tau.ncols()).map(move |j| (tau[(r - 1, j)], tau[(e, j)]))
                })
            });
            median(each.map(|(a, b)| f(a, b)).collect()).unwrap_or(0.0)
        };
        let apart = around(&|a, b| (a - b).abs());
        let size = around(&|a, b| 0.5 * (a.abs() + b.abs()));
        if ALTERNATING * apart < size {
            return begins.first().map(|r| (Second::Zeros, *r));
        }
    }
    let alternates = |j: usize| {
        let of = |f: &dyn Fn(usize) -> f64| median(inner().map(f).collect()).unwrap_or(0.0);
        let off = of(&|r| (tau[(r, j)] - 0.5 * (tau[(r - 1, j)] + tau[(r + 1, j)])).abs());
        let alike = of(&|r| (tau[(r + 1, j)] - tau[(r - 1, j)]).abs());
        let size = (tau.column(j).iter().map(|v| v * v).sum::<f64>() / tau.nrows() as f64).sqrt();
        off > ALTERNATING * alike && off > LARGE * size
    };
    let several = (0..tau.ncols()).filter(|&j| alternates(j)).count();
    (2 * several > tau.ncols()).then_some((Second::Other, 1))
}
