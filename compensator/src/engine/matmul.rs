//! Matrix products on strided views, over the `gemm` kernels (AVX-512, AVX2 or NEON chosen at run-time).
//!
//! At default build flags `gemm` with `x86-v4` was the fastest of `gemm`, `faer` and `matrixmultiply` on
//! every shape of the paper's unit (1.0–1.2 × the others on the large products, 1.5–2.6 × on the narrow
//! one); see `docs/compensator.md`.
#![allow(unsafe_code)]

use super::real::Real;

/// Read-only matrix over a slice: element (i, j) is `data[i·row + j·column]`.
#[derive(Clone, Copy)]
pub(crate) struct View<'a, T> {
    data: &'a [T],
    rows: usize,
    columns: usize,
    row: usize,
    column: usize,
}

impl<'a, T> View<'a, T> {
    /// Row-major with `stride` elements from row to row.
    pub(crate) fn new(data: &'a [T], rows: usize, columns: usize, stride: usize) -> Self {
        assert!(
            rows == 0 || columns == 0 || (rows - 1) * stride + columns <= data.len(),
            "view beyond its slice"
        );
        Self {
            data,
            rows,
            columns,
            row: stride,
            column: 1,
        }
    }

    /// Transposed view of the same matrix.
    pub(crate) fn t(self) -> Self {
        Self {
            rows: self.columns,
            columns: self.rows,
            row: self.column,
            column: self.row,
            ..self
        }
    }
}

/// Row-major destination with `stride` elements from row to row.
pub(crate) struct ViewMut<'a, T> {
    data: &'a mut [T],
    rows: usize,
    columns: usize,
    stride: usize,
}

impl<'a, T> ViewMut<'a, T> {
    /// Row-major destination over `data`, with `stride` elements from row to row.
    pub(crate) fn new(data: &'a mut [T], rows: usize, columns: usize, stride: usize) -> Self {
        assert!(columns <= stride, "rows overlap");
        assert!(
            rows == 0 || columns == 0 || (rows - 1) * stride + columns <= data.len(),
            "view beyond its slice"
        );
        Self {
            data,
            rows,
            columns,
            stride,
        }
    }
}

/// Matrix product c = a·b.
pub(crate) fn multiply<T: Real>(c: ViewMut<T>, a: View<T>, b: View<T>) {
    product(c, a, b, false);
}

/// Matrix product added to a matrix: c += a·b.
pub(crate) fn multiply_add<T: Real>(c: ViewMut<T>, a: View<T>, b: View<T>) {
    product(c, a, b, true);
}

/// Matrix product c = a·b, or c += a·b with `accumulate`.
fn product<T: Real>(c: ViewMut<T>, a: View<T>, b: View<T>, accumulate: bool) {
    assert!(
        a.columns == b.rows && c.rows == a.rows && c.columns == b.columns,
        "shapes of a product"
    );
    // SAFETY: the constructors checked that every (i, j) of each view lies within its slice, and that the
    // rows of `c` do not overlap; `c` is a unique borrow, so it aliases neither `a` nor `b`. T is f32 or
    // f64, the two of our types that `gemm` supports.
    unsafe {
        gemm::gemm(
            c.rows,
            c.columns,
            a.columns,
            c.data.as_mut_ptr(),
            1,
            c.stride as isize,
            accumulate,
            a.data.as_ptr(),
            a.column as isize,
            a.row as isize,
            b.data.as_ptr(),
            b.column as isize,
            b.row as isize,
            T::ONE,
            T::ONE,
            false,
            false,
            false,
            gemm::Parallelism::None,
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strided_and_transposed_products_match_the_definition() {
        // a is the left 2 × 3 part of a 2 × 4 matrix, b the transpose of a 2 × 3 one.
        let a = [1.0, 2.0, 3.0, 99.0, 4.0, 5.0, 6.0, 99.0];
        let b = [1.0, 0.0, 2.0, -1.0, 3.0, 1.0];
        let mut c = [10.0_f64; 6];
        multiply_add(
            ViewMut::new(&mut c, 2, 2, 3),
            View::new(&a, 2, 3, 4),
            View::new(&b, 2, 3, 3).t(),
        );
        assert_eq!(c, [17.0, 18.0, 10.0, 26.0, 27.0, 10.0]);
        multiply(
            ViewMut::new(&mut c, 2, 2, 3),
            View::new(&a, 2, 3, 4),
            View::new(&b, 2, 3, 3).t(),
        );
        assert_eq!(c, [7.0, 8.0, 10.0, 16.0, 17.0, 10.0]);
    }

    #[test]
    #[should_panic(expected = "view beyond its slice")]
    fn a_view_that_would_leave_its_slice_is_refused() {
        View::new(&[0.0_f32; 5], 2, 3, 3);
    }
}
