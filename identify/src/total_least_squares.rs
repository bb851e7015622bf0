//! Total least squares: recorded columns that are noisy themselves, with a known column as the scale.
//!
//! Columns A are exact, columns T carry noise, and the known b is exact as well: A x + T g = b where T is taken without its
//! noise. Ordinary least squares makes g too small, for the noise of T is all that T and b do not share. The
//! homogeneous system \[A b T\] is orthogonalised by its exact columns, and the right singular vector of the least singular
//! value of what is left of T, in units of its noise, is g but for a factor, which b gives (mixed least and total
//! least squares: Golub, Hoffman and Stewart, "A generalization of the Eckart–Young–Mirsky matrix approximation theorem",
//! Linear Algebra Appl. 88, 1987; drive gains so, with every column noisy: Gautier and Briot, "Global identification of
//! joint drive gains and dynamic parameters of robots", J. Dyn. Syst. Meas. Control 136(5), 2014).

use crate::least_squares::{Gram, LeastSquaresError, check_size};
use faer::linalg::solvers::Solve;
use faer::{Mat, Side};

/// Ridge relative to the norm of each exact column: a direction that no row determines stays at zero.
const RIDGE: f64 = 1e-6;

/// An estimate by total least squares.
#[derive(Debug, Clone, PartialEq)]
pub struct Total {
    /// Parameters of all columns, the exact ones first, where the target counts once.
    pub parameters: Vec<f64>,
    /// Squared singular values of the noisy columns behind the exact ones, ascending, in units of their noise: where the second
    /// is not well above the first, more than one combination of the noisy columns is nothing but noise.
    pub squares: Vec<f64>,
}

/// Solves from the sums of rows \[A T b\]; the last `noise.len()` columns are the noisy ones, and `noise` is the standard deviation of
/// an entry of each, in any common unit.
///
/// # Errors
/// More noisy columns than there are, a deviation that is not positive, a target that no noisy column shares in.
pub fn total(gram: &Gram, noise: &[f64]) -> Result<Total, LeastSquaresError> {
    let p = gram.columns();
    if noise.is_empty() || noise.len() > p {
        check_size("the list of noisy columns", noise.len(), p)?;
        return Err(LeastSquaresError::NoRows);
    }
    if let Some(column) = noise.iter().position(|s| !(s.is_finite() && *s > 0.0)) {
        return Err(LeastSquaresError::BadNoise { column });
    }
    let (n, exact) = (noise.len(), p - noise.len());
    let products = gram.products();
    // The target stands behind the exact columns.
    let place = |i: usize| if i < exact { i } else { p };
    let scale: Vec<f64> = (0..=exact)
        .map(|i| {
            let norm = products[(place(i), place(i))].max(0.0).sqrt();
            if norm > 0.0 { norm } else { 1.0 }
        })
        .collect();
    let known = Mat::from_fn(exact + 1, exact + 1, |i, j| {
        let entry = products[(place(i), place(j))] / (scale[i] * scale[j]);
        entry + if i == j { RIDGE * RIDGE } else { 0.0 }
    });
    let cross = Mat::from_fn(exact + 1, n, |i, j| {
        products[(place(i), exact + j)] / (scale[i] * noise[j])
    });
    let factor = known
        .llt(Side::Lower)
        .map_err(|_| LeastSquaresError::Decomposition)?;
    let reach = factor.solve(&cross);
    let within = cross.transpose() * &reach;
    let left = Mat::from_fn(n, n, |i, j| {
        products[(exact + i, exact + j)] / (noise[i] * noise[j]) - within[(i, j)]
    });
    let eigen = left
        .self_adjoint_eigen(Side::Lower)
        .map_err(|_| LeastSquaresError::Decomposition)?;
    let direction = Mat::from_fn(n, 1, |i, _| eigen.U()[(i, 0)]);
    // A x − c b = −T g.
    let rest = -(&reach * &direction);
    let count = -rest[(exact, 0)] / scale[exact];
    let parameters: Vec<f64> = (0..exact)
        .map(|i| rest[(i, 0)] / scale[i] / count)
        .chain((0..n).map(|j| direction[(j, 0)] / noise[j] / count))
        .collect();
    if parameters.iter().any(|v| !v.is_finite()) {
        return Err(LeastSquaresError::NoScale);
    }
    Ok(Total {
        parameters,
        squares: (0..n).map(|k| eigen.S()[k].max(0.0)).collect(),
    })
}

/// Sums of products whose ordinary least-squares solution is the total one: those of the noisy columns less the
/// contribution of the noise.
///
/// A quadratic that is nowhere negative, so that it can be minimised under conditions.
pub fn without_noise(gram: &Gram, noise: &[f64], total: &Total) -> Gram {
    let mut products = gram.products().to_owned();
    let exact = gram.columns() - noise.len();
    let least = total.squares.first().copied().unwrap_or(0.0);
    for (j, s) in noise.iter().enumerate() {
        products[(exact + j, exact + j)] -= least * s * s;
    }
    Gram::from_products(products, gram.rows())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::least_squares::{Accumulator, SolveOptions, solve};
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::StandardNormal;

    /// One noisy column and no other: the singular vector is the column itself, so that g = 1/c with T = b c + noise, by hand:
    /// b = (1, 1), T = (2, 4): c = (2 + 4)/2 = 3, g = 1/3; ordinary least squares has 6/20.
    #[test]
    fn by_hand() {
        let mut rows = Accumulator::new(1);
        rows.push(&[2.0], 1.0, 1.0).unwrap();
        rows.push(&[4.0], 1.0, 1.0).unwrap();
        let triangle = rows.finish().unwrap();
        let found = total(&Gram::from(&triangle), &[1.0]).unwrap();
        assert!(
            (found.parameters[0] - 1.0 / 3.0).abs() < 1e-9,
            "{:?}",
            found.parameters
        );
        // What is left of T: (−1, 1).
        assert!((found.squares[0] - 2.0).abs() < 1e-9);
        let ordinary = solve(&triangle, &SolveOptions::default()).unwrap();
        assert!((ordinary.parameters[0] - 0.3).abs() < 1e-9);
    }

    /// Two noisy columns of different noise and an exact one: no bias where ordinary least squares has one of tens of deviations, and
    /// the sums without noise give the same by ordinary least squares.
    #[test]
    fn noise_of_the_columns_biases_nothing() {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let truth = [1.3, 0.8];
        let noise = [0.5, 0.9];
        let mut rows = Accumulator::new(3);
        for k in 0..40_000_usize {
            let t = 0.01 * k as f64;
            let (a, b) = (t.sin(), (1.7 * t).cos());
            // Two joints: each row has the torque of one.
            let joint = k % 2;
            let torque = if joint == 0 {
                0.7 * a + b
            } else {
                0.7 * a - 2.0 * b
            };
            let recorded =
                torque / truth[joint] + noise[joint] * rng.sample::<f64, _>(StandardNormal);
            let mut row = [-a, 0.0, 0.0];
            row[1 + joint] = recorded;
            let known = if joint == 0 { b } else { -2.0 * b };
            // Rows in units of their own noise; the noise of a column's entries is in the same.
            rows.push(&row, known, 1.0 / (noise[joint] * truth[joint]))
                .unwrap();
        }
        let triangle = rows.finish().unwrap();
        let gram = Gram::from(&triangle);
        let scale = [1.0 / truth[0], 1.0 / truth[1]];
        let found = total(&gram, &scale).unwrap();
        let ordinary = solve(&triangle, &SolveOptions::default()).unwrap();
        for (j, gain) in truth.iter().enumerate() {
            let error = (found.parameters[1 + j] / gain - 1.0).abs();
            assert!(error < 0.02, "{error}");
        }
        assert!((found.parameters[0] - 0.7).abs() < 0.03);
        assert!(ordinary.parameters[1] < 0.9 * truth[0]);
        let all = [0, 1, 2];
        let again = without_noise(&gram, &scale, &found).fit(&all, 0.0).unwrap();
        for (a, b) in again.unwrap().parameters.iter().zip(&found.parameters) {
            assert!((a - b).abs() < 1e-6, "{a} {b}");
        }
    }

    #[test]
    fn bad_input_is_refused() {
        let triangle = Accumulator::new(1).finish().unwrap();
        let gram = Gram::from(&triangle);
        assert!(total(&gram, &[]).is_err());
        assert!(total(&gram, &[1.0, 1.0]).is_err());
        assert!(total(&gram, &[0.0]).is_err());
        // A target of zeros is no scale.
        let mut rows = Accumulator::new(1);
        rows.push(&[2.0], 0.0, 1.0).unwrap();
        let gram = Gram::from(&rows.finish().unwrap());
        let refused = total(&gram, &[1.0]);
        assert!(matches!(refused, Err(LeastSquaresError::NoScale)));
    }
}
