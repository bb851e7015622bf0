//! Choice of independent columns, and the dependence of the others on them.

use faer::linalg::solvers::SolveLstsqCore;
use faer::prelude::*;
use faer::{Mat, MatRef};

/// A column whose part outside the span of the others is smaller than this, relative to its length, is
/// dependent. Real dependencies leave rounding (1e-14), or 1e-11 where a description rounds π/2; independent columns leave
/// more than 1e-4 even for a wrist of centimetres.
const DEPENDENT: f64 = 1e-8;

/// Result of [`select`]: columns and their dependences.
pub(super) struct Selection {
    /// Independent columns, ascending.
    pub independent: Vec<usize>,
    /// Indices of columns that are zero.
    pub unidentifiable: Vec<usize>,
    /// Grouping matrix G, b × p: dependence of all columns on the independent ones.
    pub grouping: Mat<f64>,
}

/// Selects independent columns of `samples`, first those named first in `order`.
///
/// A column-pivoted QR gives the rank. Gram–Schmidt in the given order, on the small triangular factor, then
/// takes that number of columns.
pub(super) fn select(samples: MatRef<'_, f64>, order: &[usize]) -> Selection {
    let p = samples.ncols();
    let lengths: Vec<f64> = (0..p).map(|j| samples.col(j).norm_l2()).collect();
    let longest = lengths.iter().copied().fold(0.0, f64::max);
    let silent = |j: usize| lengths[j] <= DEPENDENT * longest;
    let mut scaled = samples.to_owned();
    for (j, &length) in lengths.iter().enumerate() {
        let scale = if silent(j) { 0.0 } else { 1.0 / length };
        scaled.col_mut(j).iter_mut().for_each(|v| *v *= scale);
    }
    let pivoted = scaled.col_piv_qr();
    let r = pivoted.thin_R();
    let diagonal = (0..r.nrows().min(p)).map(|k| r[(k, k)].abs());
    let rank = diagonal.filter(|d| *d > DEPENDENT).count();
    // Columns of R, in the order of `samples`: the same inner products with far fewer rows.
    let small = r * pivoted.P();

    let mut independent = in_order(small.as_ref(), order, rank);
    independent.sort_unstable();
    let unidentifiable = (0..p).filter(|&j| silent(j)).collect();
    let grouping = group(small.as_ref(), &independent, &lengths);
    Selection {
        independent,
        unidentifiable,
        grouping,
    }
}

/// The first `rank` columns, in `order`, that are not in the span of those before them.
fn in_order(columns: MatRef<'_, f64>, order: &[usize], rank: usize) -> Vec<usize> {
    let mut basis: Vec<Col<f64>> = Vec::with_capacity(rank);
    let mut chosen = Vec::with_capacity(rank);
    for &j in order {
        if chosen.len() == rank {
            break;
        }
        let mut rest = columns.col(j).to_owned();
        // Twice: once is not orthogonal to rounding.
        for _ in 0..2 {
            for direction in &basis {
                let part = direction.transpose() * &rest;
                rest -= direction * Scale(part);
            }
        }
        let length = rest.norm_l2();
        if length > DEPENDENT {
            basis.push(rest * Scale(1.0 / length));
            chosen.push(j);
        }
    }
    chosen
}

/// G with Y = Y[:, independent]·G, rounding cleared to zero.
fn group(columns: MatRef<'_, f64>, independent: &[usize], lengths: &[f64]) -> Mat<f64> {
    let (b, p) = (independent.len(), columns.ncols());
    let kept = Mat::from_fn(columns.nrows(), b, |i, k| columns[(i, independent[k])]);
    let mut solution = columns.to_owned();
    kept.qr()
        .solve_lstsq_in_place_with_conj(faer::Conj::No, solution.as_mut());
    let mut grouping = Mat::zeros(b, p);
    for j in 0..p {
        if let Some(k) = independent.iter().position(|&i| i == j) {
            grouping[(k, j)] = 1.0;
            continue;
        }
        for k in 0..b {
            // In normalised columns every coefficient is of order one, so this cuts rounding alone.
            if solution[(k, j)].abs() > DEPENDENT {
                grouping[(k, j)] = solution[(k, j)] * lengths[j] / lengths[independent[k]];
            }
        }
    }
    grouping
}
