//! Triangular factor of a tall system, accumulated block by block (tall-skinny QR).

use super::{LeastSquaresError, check_size};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::qr::no_pivoting::factor::{
    qr_in_place, qr_in_place_scratch, recommended_block_size,
};
use faer::{Mat, MatMut, MatRef, Par, Spec};
use ndarray::{ArrayView1, ArrayView2};

/// Rows buffered before they are folded into the factor, at least. 1024 rows of 61 columns are 0.5 MB:
/// they stay in the second-level cache while the reflections pass over them.
const BLOCK_ROWS: usize = 1024;

/// Upper-triangular factor of [A b]: with [A b] = Q [[R, z], [0, ρ]], ‖A x − b‖² = ‖R x − z‖² + ρ²
/// for every x, so the rows themselves need not be kept.
#[derive(Debug, Clone)]
pub struct Triangle {
    /// Triangular factor of [A b], (p + 1) × (p + 1), zero below the diagonal.
    factor: Mat<f64>,
    rows: usize,
}

impl Triangle {
    /// The triangle of an empty system with `columns` unknowns.
    pub fn empty(columns: usize) -> Self {
        Self {
            factor: Mat::zeros(columns + 1, columns + 1),
            rows: 0,
        }
    }

    /// The triangle of a system that is in memory: `a` (rows × columns), `b` (rows).
    ///
    /// # Errors
    /// Sizes that do not agree; NaN or infinite values.
    pub fn of(a: ArrayView2<f64>, b: ArrayView1<f64>) -> Result<Self, LeastSquaresError> {
        let mut accumulator = Accumulator::new(a.ncols());
        accumulator.push_rows(a, b, None)?;
        accumulator.finish()
    }

    /// The triangle of all the rows of several groups: exact, as if they had been accumulated
    /// together.
    ///
    /// # Errors
    /// No group, or groups with different numbers of columns.
    pub fn stack<'a>(
        groups: impl IntoIterator<Item = &'a Triangle>,
    ) -> Result<Self, LeastSquaresError> {
        let mut groups = groups.into_iter();
        let mut whole = groups.next().ok_or(LeastSquaresError::NoRows)?.clone();
        for group in groups {
            whole.merge(group)?;
        }
        Ok(whole)
    }

    /// Adds the rows behind `other` to those behind `self`.
    ///
    /// # Errors
    /// Different numbers of columns.
    pub fn merge(&mut self, other: &Triangle) -> Result<(), LeastSquaresError> {
        check_size("the other triangle", other.columns(), self.columns())?;
        let n = self.factor.ncols();
        let mut stacked = Mat::from_fn(2 * n, n, |i, j| {
            if i < n {
                self.factor[(i, j)]
            } else {
                other.factor[(i - n, j)]
            }
        });
        self.factor = triangle_of(stacked.as_mut());
        self.rows += other.rows;
        Ok(())
    }

    /// Triangle of these rows multiplied by `scale` (a change of weight of the whole group).
    pub fn scaled(&self, scale: f64) -> Self {
        Self {
            factor: faer::Scale(scale) * &self.factor,
            rows: self.rows,
        }
    }

    /// Number of unknowns p of the system.
    pub fn columns(&self) -> usize {
        self.factor.ncols() - 1
    }

    /// Number of rows accumulated, those of zero weight not counted.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Factor R, p × p upper triangular.
    pub fn r(&self) -> MatRef<'_, f64> {
        let p = self.columns();
        self.factor.submatrix(0, 0, p, p)
    }

    /// Vector z, length p: the part of the target within reach of the columns.
    pub fn z(&self) -> Vec<f64> {
        let p = self.columns();
        (0..p).map(|i| self.factor[(i, p)]).collect()
    }

    /// Residual sum of squares ρ² of the least-squares solution, which no parameter vector can lower.
    pub fn unexplained(&self) -> f64 {
        let p = self.columns();
        self.factor[(p, p)].powi(2)
    }

    /// Σ b² over the (weighted) rows.
    pub fn target_sum_of_squares(&self) -> f64 {
        let p = self.columns();
        (0..=p).map(|i| self.factor[(i, p)].powi(2)).sum()
    }

    /// ‖A x − b‖² of a parameter vector x of length p.
    ///
    /// # Errors
    /// `x` of another length.
    pub fn residual_sum_of_squares(&self, x: &[f64]) -> Result<f64, LeastSquaresError> {
        check_size("the parameter vector", x.len(), self.columns())?;
        Ok(self.residual(x).iter().map(|e| e * e).sum::<f64>() + self.unexplained())
    }

    /// Residual z − R x of the triangular system.
    pub(super) fn residual(&self, x: &[f64]) -> Vec<f64> {
        let p = self.columns();
        (0..p)
            .map(|i| {
                let fitted: f64 = (i..p).map(|j| self.factor[(i, j)] * x[j]).sum();
                self.factor[(i, p)] - fitted
            })
            .collect()
    }

    /// Triangle of the same rows with some columns only, in the order given.
    ///
    /// # Errors
    /// A column that does not exist.
    pub fn select(&self, columns: &[usize]) -> Result<Self, LeastSquaresError> {
        let p = self.columns();
        if let Some(&column) = columns.iter().find(|&&c| c >= p) {
            return Err(LeastSquaresError::NoSuchColumn { column, columns: p });
        }
        let mut picked = Mat::from_fn(p + 1, columns.len() + 1, |i, j| {
            let source = columns.get(j).copied().unwrap_or(p);
            self.factor[(i, source)]
        });
        Ok(Self {
            factor: triangle_of(picked.as_mut()),
            rows: self.rows,
        })
    }

    /// Triangle of the same rows among `total` unknowns: column j becomes column `columns[j]`, the other columns are zero.
    ///
    /// # Errors
    /// Another number of places than columns; a place that does not exist.
    pub fn embed(&self, columns: &[usize], total: usize) -> Result<Self, LeastSquaresError> {
        let p = self.columns();
        check_size("the list of places", columns.len(), p)?;
        if let Some(&column) = columns.iter().find(|&&c| c >= total) {
            return Err(LeastSquaresError::NoSuchColumn {
                column,
                columns: total,
            });
        }
        let mut placed = Mat::zeros(total.max(p) + 1, total + 1);
        for (j, &place) in columns.iter().chain(std::iter::once(&total)).enumerate() {
            for i in 0..=p {
                placed[(i, place)] = self.factor[(i, j)];
            }
        }
        Ok(Self {
            factor: triangle_of(placed.as_mut()),
            rows: self.rows,
        })
    }

    /// The entries on and above the diagonal of the factor of [A b], (p + 1)(p + 2)/2 of them, column by column.
    pub fn values(&self) -> Vec<f64> {
        let columns = 0..self.factor.ncols();
        columns
            .flat_map(|j| (0..=j).map(move |i| self.factor[(i, j)]))
            .collect()
    }

    /// The triangle of `columns` unknowns and `rows` rows with these [`Triangle::values`].
    ///
    /// # Errors
    /// Another number of values; NaN or infinite ones.
    pub fn from_values(
        columns: usize,
        rows: usize,
        values: &[f64],
    ) -> Result<Self, LeastSquaresError> {
        let n = columns + 1;
        check_size("the stored triangle", values.len(), n * (n + 1) / 2)?;
        if !values.iter().all(|v| v.is_finite()) {
            return Err(LeastSquaresError::NotFinite);
        }
        let at = |i: usize, j: usize| values[j * (j + 1) / 2 + i];
        let factor = Mat::from_fn(n, n, |i, j| if i <= j { at(i, j) } else { 0.0 });
        Ok(Self { factor, rows })
    }

    pub(super) fn factor(&self) -> MatRef<'_, f64> {
        self.factor.as_ref()
    }
}

/// Folds rows into a [`Triangle`]; memory is one block of rows, whatever their number.
///
/// ```
/// use identify::least_squares::{Accumulator, SolveOptions, solve};
/// let mut rows = Accumulator::new(2);
/// for k in 0..1_000 {
///     let t = f64::from(k);
///     rows.push(&[1.0, t], 3.0 + 0.5 * t, 1.0)?;
/// }
/// let line = solve(&rows.finish()?, &SolveOptions::default())?;
/// assert!((line.parameters[1] - 0.5).abs() < 1e-9);
/// # Ok::<(), identify::least_squares::LeastSquaresError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Accumulator {
    /// Buffer, column-major; its first p + 1 rows hold the factor so far, the others pending rows.
    buffer: Mat<f64>,
    pending: usize,
    rows: usize,
}

impl Accumulator {
    /// Accumulator for systems with `columns` unknowns.
    pub fn new(columns: usize) -> Self {
        let n = columns + 1;
        Self {
            buffer: Mat::zeros(n + BLOCK_ROWS.max(4 * n), n),
            pending: 0,
            rows: 0,
        }
    }

    /// Number of unknowns p of the system.
    pub fn columns(&self) -> usize {
        self.buffer.ncols() - 1
    }

    /// Adds one row a·x ≈ b; row and target are multiplied by `scale` (the square root of a weight, 1/σ). A row
    /// of scale zero is left out altogether.
    ///
    /// # Errors
    /// A row of the wrong length.
    pub fn push(&mut self, a: &[f64], b: f64, scale: f64) -> Result<(), LeastSquaresError> {
        let p = self.columns();
        check_size("the row", a.len(), p)?;
        if scale == 0.0 {
            return Ok(());
        }
        let i = self.next_row();
        for (j, &value) in a.iter().enumerate() {
            self.buffer[(i, j)] = value * scale;
        }
        self.buffer[(i, p)] = b * scale;
        Ok(())
    }

    /// Adds the rows of `a` (rows × p) with targets `b` (rows); `scale` as in [`Accumulator::push`],
    /// one per row.
    ///
    /// # Errors
    /// Sizes that do not agree.
    pub fn push_rows(
        &mut self,
        a: ArrayView2<f64>,
        b: ArrayView1<f64>,
        scale: Option<ArrayView1<f64>>,
    ) -> Result<(), LeastSquaresError> {
        let p = self.columns();
        check_size("a row of the block", a.ncols(), p)?;
        check_size("the target", b.len(), a.nrows())?;
        if let Some(scale) = scale {
            check_size("the scale", scale.len(), a.nrows())?;
        }
        for (k, row) in a.rows().into_iter().enumerate() {
            let s = scale.map_or(1.0, |scale| scale[k]);
            if s == 0.0 {
                continue;
            }
            let i = self.next_row();
            for (j, value) in row.iter().enumerate() {
                self.buffer[(i, j)] = value * s;
            }
            self.buffer[(i, p)] = b[k] * s;
        }
        Ok(())
    }

    /// Adds weighted rows (rows × p + 1, the target last), `live` of which are not all zero.
    pub(crate) fn push_block(&mut self, block: MatRef<'_, f64>, live: usize) {
        let n = self.buffer.ncols();
        let mut taken = 0;
        while taken < block.nrows() {
            if n + self.pending == self.buffer.nrows() {
                self.fold();
            }
            let at = n + self.pending;
            let count = (self.buffer.nrows() - at).min(block.nrows() - taken);
            let mut target = self.buffer.as_mut().subrows_mut(at, count);
            target.copy_from(block.subrows(taken, count));
            self.pending += count;
            taken += count;
        }
        self.rows += live;
    }

    /// The triangle of everything pushed.
    ///
    /// # Errors
    /// NaN or infinite values among the rows.
    pub fn finish(mut self) -> Result<Triangle, LeastSquaresError> {
        self.fold();
        let n = self.buffer.ncols();
        let factor = self.buffer.as_ref().submatrix(0, 0, n, n).to_owned();
        if !factor.is_all_finite() {
            return Err(LeastSquaresError::NotFinite);
        }
        Ok(Triangle {
            factor,
            rows: self.rows,
        })
    }

    /// Index in the buffer of a fresh row, after folding where the buffer is full.
    fn next_row(&mut self) -> usize {
        let n = self.buffer.ncols();
        if n + self.pending == self.buffer.nrows() {
            self.fold();
        }
        let i = n + self.pending;
        self.pending += 1;
        self.rows += 1;
        i
    }

    fn fold(&mut self) {
        if self.pending == 0 {
            return;
        }
        let n = self.buffer.ncols();
        let used = n + self.pending;
        let r = triangle_of(self.buffer.as_mut().subrows_mut(0, used));
        self.buffer.as_mut().subrows_mut(0, n).copy_from(&r);
        self.pending = 0;
    }
}

/// R of the QR decomposition of `a` (any shape), columns × columns with zeros below the diagonal; `a` is
/// overwritten.
pub(super) fn triangle_of(mut a: MatMut<'_, f64>) -> Mat<f64> {
    let (m, n) = (a.nrows(), a.ncols());
    let block = recommended_block_size::<f64>(m, n);
    let mut coefficients = Mat::zeros(block, m.min(n));
    let scratch = qr_in_place_scratch::<f64>(m, n, block, Par::Seq, Spec::default());
    qr_in_place(
        a.as_mut(),
        coefficients.as_mut(),
        Par::Seq,
        MemStack::new(&mut MemBuffer::new(scratch)),
        Spec::default(),
    );
    Mat::from_fn(n, n, |i, j| if i <= j && i < m { a[(i, j)] } else { 0.0 })
}
