//! Cholesky factor of a small symmetric positive definite matrix, in place and without allocation.
//!
//! For up to some tens of unknowns in a flat slice, row-major, n × n: A = L·Lᵀ by rows (Golub and Van Loan,
//! Matrix Computations, 4th ed., section 4.2.5). The lower triangle of A is read, and L is written into it; the
//! elements above the diagonal are not touched. Larger systems are for `faer`, fixed 3 × 3 and 4 × 4 ones for
//! `nalgebra`.

/// Replaces the lower triangle of `a` (n × n) by L. `None` where a pivot is not positive: A is not positive definite,
/// or not finite; `a` is then half done.
///
/// # Panics
/// Where `a` has fewer than n² entries.
#[must_use]
pub fn factor(a: &mut [f64], n: usize) -> Option<()> {
    by_rows(a, n, |pivot| (pivot > 0.0).then_some(pivot))
}

/// Factorises like [`factor`], but raises a pivot below `least` to `least`. That pins an unknown that is, up to
/// rounding, a copy of earlier ones. `least` is in the units of the diagonal, above zero.
///
/// # Panics
/// Where `a` has fewer than n² entries.
pub fn factor_above(a: &mut [f64], n: usize, least: f64) {
    let pinned = by_rows(a, n, |pivot| Some(pivot.max(least)));
    debug_assert!(pinned.is_some(), "every pivot is taken");
}

fn by_rows(a: &mut [f64], n: usize, accept: impl Fn(f64) -> Option<f64>) -> Option<()> {
    for i in 0..n {
        let (above, rest) = a.split_at_mut(i * n);
        let row = &mut rest[..n];
        for j in 0..i {
            let done = &above[j * n..][..n];
            row[j] = (row[j] - dot(&row[..j], done)) / done[j];
        }
        row[i] = accept(row[i] - dot(&row[..i], &row[..i]))?.sqrt();
    }
    Some(())
}

/// x with L·Lᵀ·x = b, in place of b (n), for the factor `l` (n × n).
///
/// # Panics
/// Where `l` has fewer than n² entries.
pub fn solve(l: &[f64], b: &mut [f64]) {
    let n = b.len();
    for i in 0..n {
        b[i] = (b[i] - dot(&l[i * n..][..i], b)) / l[i * n + i];
    }
    for i in (0..n).rev() {
        let later: f64 = (i + 1..n).map(|k| l[k * n + i] * b[k]).sum();
        b[i] = (b[i] - later) / l[i * n + i];
    }
}

/// Sum Σ a·b over the length of the shorter vector.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    std::iter::zip(a, b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// [[4, 2, −2], [2, 10, 2], [−2, 2, 6]] = L·Lᵀ with L = [[2, 0, 0], [1, 3, 0], [−1, 1, 2]], by hand.
    const A: [f64; 9] = [4.0, 9.0, 9.0, 2.0, 10.0, 9.0, -2.0, 2.0, 6.0];

    #[test]
    fn solves_a_system_by_hand() {
        let mut a = A;
        assert_eq!(factor(&mut a, 3), Some(()));
        assert_eq!(a, [2.0, 9.0, 9.0, 1.0, 3.0, 9.0, -1.0, 1.0, 2.0]);
        // A·[1, −1, 2].
        let mut x = [-2.0, -4.0, 8.0];
        solve(&a, &mut x);
        assert_eq!(x, [1.0, -1.0, 2.0]);
        let mut same = A;
        factor_above(&mut same, 3, 1e-9);
        assert_eq!(same, a);
    }

    #[test]
    fn what_is_not_positive_definite_is_refused() {
        for wrong in [
            [1.0, 0.0, 1.0, 1.0],
            [1.0, 0.0, 2.0, 1.0],
            [-1.0, 0.0, 0.0, 1.0],
            [f64::NAN, 0.0, 0.0, 1.0],
            [1.0, 0.0, f64::INFINITY, 1.0],
        ] {
            assert_eq!(factor(&mut wrong.clone(), 2), None, "{wrong:?}");
        }
        assert_eq!(factor(&mut [], 0), Some(()));
    }

    #[test]
    fn one_column_twice_is_pinned() {
        let mut a = [4.0, 0.0, 4.0, 4.0];
        factor_above(&mut a, 2, 1e-6);
        assert_eq!(a, [2.0, 0.0, 2.0, 1e-3]);
        let mut x = [8.0, 8.0];
        solve(&a, &mut x);
        assert_eq!(x, [2.0, 0.0]);
    }
}
