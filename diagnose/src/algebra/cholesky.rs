//! Cholesky factor of a symmetric positive definite matrix whose columns differ in size and may coincide.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{
    LltRegularization, cholesky_in_place, cholesky_in_place_scratch,
};
use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_upper_triangular_in_place,
};
use faer::{Mat, MatMut, Par, Spec};
use ndarray::{Array1, Array2, ArrayView1};

/// Pivot of the scaled matrix below which two columns count as one.
const LOST: f64 = 1e-13;

/// D·A·D = L·Lᵀ with D = diag(A)^(−1/2) and L lower triangular.
#[derive(Clone, Debug)]
pub struct Cholesky {
    l: Mat<f64>,
    scale: Vec<f64>,
}

impl Cholesky {
    /// Factorises `a`, of which only the lower triangle is read. A pivot lost to rounding is replaced by 1e-13 of
    /// its diagonal entry, which pins that unknown near zero: every system here carries a prior, so a vanishing
    /// pivot means two columns that differ by rounding alone.
    pub fn new(a: &Array2<f64>) -> Self {
        let n = a.nrows();
        let scale: Vec<f64> = a
            .diag()
            .iter()
            .map(|d| 1.0 / d.max(f64::MIN_POSITIVE).sqrt())
            .collect();
        let mut l = Mat::from_fn(n, n, |i, k| {
            if k > i {
                0.0
            } else {
                a[[i, k]] * scale[i] * scale[k]
            }
        });
        let pinned = LltRegularization {
            dynamic_regularization_delta: LOST,
            dynamic_regularization_epsilon: LOST,
        };
        let scratch = cholesky_in_place_scratch::<f64>(n, Par::Seq, Spec::default());
        let factored = cholesky_in_place(
            l.as_mut(),
            pinned,
            Par::Seq,
            MemStack::new(&mut MemBuffer::new(scratch)),
            Spec::default(),
        );
        debug_assert!(factored.is_ok(), "no pivot is left below {LOST}");
        // faer 0.24 divides the column by the replaced pivot's root, but leaves the lost one on the diagonal.
        for i in 0..n {
            l[(i, i)] = l[(i, i)].max(LOST.sqrt());
        }
        Self { l, scale }
    }

    /// Factorises `a` with its diagonal raised by a part of itself. Columns that repeat one another then share
    /// their coefficient, and a zero column gets none.
    pub fn raised(mut a: Array2<f64>, part: f64) -> Self {
        a.diag_mut()
            .mapv_inplace(|d| d * (1.0 + part) + f64::MIN_POSITIVE);
        Self::new(&a)
    }

    /// Logarithm ln |A| of the matrix's determinant.
    pub fn log_determinant(&self) -> f64 {
        let each = self.scale.iter().enumerate();
        each.map(|(i, s)| 2.0 * (self.l[(i, i)] / s).ln()).sum()
    }

    /// Solution x of A·x = b.
    pub fn solve(&self, b: ArrayView1<f64>) -> Array1<f64> {
        let mut x = b.to_vec();
        self.solve_in_place(&mut x, 1);
        Array1::from(x)
    }

    /// Rows x with A·x = b for the rows b, shape (rows, n).
    pub fn solve_rows(&self, b: &Array2<f64>) -> Array2<f64> {
        let mut x: Vec<f64> = b.iter().copied().collect();
        self.solve_in_place(&mut x, b.nrows());
        Array2::from_shape_vec(b.dim(), x).expect("as many values as before")
    }

    /// Solves in place for the `count` right-hand sides in `x`, one after the other.
    fn solve_in_place(&self, x: &mut [f64], count: usize) {
        let n = self.scale.len();
        let scaled = |x: &mut [f64]| {
            for own in x.chunks_exact_mut(n.max(1)) {
                own.iter_mut().zip(&self.scale).for_each(|(v, s)| *v *= s);
            }
        };
        scaled(x);
        let mut columns = MatMut::from_column_major_slice_mut(x, n, count);
        solve_lower_triangular_in_place(self.l.as_ref(), columns.as_mut(), Par::Seq);
        solve_upper_triangular_in_place(self.l.transpose(), columns, Par::Seq);
        scaled(x);
    }

    /// A vector with covariance A⁻¹; `noise` is one of independent unit normals.
    pub fn draw(&self, noise: ArrayView1<f64>) -> Array1<f64> {
        let n = self.scale.len();
        let mut x = noise.to_vec();
        let columns = MatMut::from_column_major_slice_mut(&mut x, n, 1);
        solve_upper_triangular_in_place(self.l.transpose(), columns, Par::Seq);
        x.iter().zip(&self.scale).map(|(v, s)| v * s).collect()
    }

    /// Diagonal of the inverse matrix A⁻¹.
    pub fn inverse_diagonal(&self) -> Array1<f64> {
        let n = self.scale.len();
        let mut inverse = Mat::<f64>::identity(n, n);
        solve_lower_triangular_in_place(self.l.as_ref(), inverse.as_mut(), Par::Seq);
        let of = |(i, s): (usize, &f64)| s * s * inverse.col(i).squared_norm_l2();
        self.scale.iter().enumerate().map(of).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::array;

    #[test]
    fn solves_a_system_by_hand() {
        // [[4, 2], [2, 3]]·[1, −1] = [2, −1]; the inverse has the diagonal [3, 4]/8.
        let c = Cholesky::new(&array![[4.0, 2.0], [2.0, 3.0]]);
        let x = c.solve_rows(&array![[2.0, -1.0], [4.0, 2.0]]);
        let expected = array![[1.0, -1.0], [1.0, 0.0]];
        assert!((&x - &expected).iter().all(|e| e.abs() < 1e-15), "{x}");
        let d = c.inverse_diagonal();
        assert!((d[0] - 0.375).abs() < 1e-15 && (d[1] - 0.5).abs() < 1e-15);
    }

    #[test]
    fn one_column_twice_leaves_a_finite_answer() {
        let c = Cholesky::new(&array![[4.0, 4e-6], [4e-6, 4e-12]]);
        let x = c.solve(array![8.0, 8e-6].view());
        assert!((x[0] + 1e-6 * x[1] - 2.0).abs() < 1e-6, "{x}");
    }
}
