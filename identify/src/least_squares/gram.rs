//! Normal equations for searches over subsets of columns.

use super::{LeastSquaresError, Triangle, check_size};
use faer::linalg::solvers::DenseSolveCore;
use faer::{Mat, MatRef, Side};
use signal::cholesky;

/// Normal equations of [A b]: N = AᵀA, h = Aᵀb, Σb². Half the digits of a [`Triangle`], but sums are exact in form
/// and a fit of k of the columns costs k³/3, which a forward selection over hundreds of candidates needs.
#[derive(Debug, Clone)]
pub struct Gram {
    /// Matrix [[AᵀA, Aᵀb], [bᵀA, bᵀb]] of the rows as weighted, (p + 1) × (p + 1), both triangles stored.
    products: Mat<f64>,
    rows: usize,
}

/// Fit of a subset of the columns.
#[derive(Debug, Clone, PartialEq)]
pub struct GramFit {
    /// Parameters of the fit, in the order of the subset.
    pub parameters: Vec<f64>,
    /// Residual sum of squares on the rows fitted.
    pub residual_sum_of_squares: f64,
}

impl From<&Triangle> for Gram {
    fn from(triangle: &Triangle) -> Self {
        let factor = triangle.factor();
        Self {
            products: factor.transpose() * factor,
            rows: triangle.rows(),
        }
    }
}

impl Gram {
    /// Number of unknowns p of the sums.
    pub fn columns(&self) -> usize {
        self.products.ncols() - 1
    }

    /// Number of rows behind the sums.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Root mean square of a column over the rows; zero without rows.
    ///
    /// # Errors
    /// A column that does not exist.
    pub fn rms(&self, column: usize) -> Result<f64, LeastSquaresError> {
        self.check_columns(&[column])?;
        let mean = self.products[(column, column)].max(0.0) / self.rows.max(1) as f64;
        Ok(mean.sqrt())
    }

    /// Normal equations from the sums of products: (p + 1) × (p + 1), symmetric, the target last.
    pub(crate) fn from_products(products: Mat<f64>, rows: usize) -> Self {
        Self { products, rows }
    }

    /// Standard deviations of all parameters, for rows in units of their independent noise: the roots of the diagonal
    /// of N⁻¹.
    ///
    /// A column that no row determines has a deviation of 10⁵ over its own norm.
    ///
    /// # Errors
    /// Sums that are not sums of squares.
    pub fn deviations(&self) -> Result<Vec<f64>, LeastSquaresError> {
        let p = self.columns();
        let norm = |i: usize| match self.products[(i, i)] {
            square if square > 0.0 => square.sqrt(),
            _ => 1.0,
        };
        let unit = Mat::from_fn(p, p, |i, j| {
            let ridge = if i == j { 1e-10 } else { 0.0 };
            self.products[(i, j)] / (norm(i) * norm(j)) + ridge
        });
        let factor = unit
            .llt(Side::Lower)
            .map_err(|_| LeastSquaresError::Decomposition)?;
        let inverse = factor.inverse();
        let deviation = |i: usize| inverse[(i, i)].max(0.0).sqrt() / norm(i);
        Ok((0..p).map(deviation).collect())
    }

    /// The sums: [[N, h], [hᵀ, Σb²]].
    pub(crate) fn products(&self) -> MatRef<'_, f64> {
        self.products.as_ref()
    }

    /// Normal equations of the same rows multiplied by `scale` (a change of weight of the whole group).
    pub fn scaled(&self, scale: f64) -> Gram {
        Gram {
            products: faer::Scale(scale * scale) * &self.products,
            rows: self.rows,
        }
    }

    /// Normal equations of the same rows among `total` unknowns: column j becomes column `columns[j]`.
    ///
    /// # Errors
    /// Another number of places than columns; a place that does not exist.
    pub fn embed(&self, columns: &[usize], total: usize) -> Result<Gram, LeastSquaresError> {
        check_size("the list of places", columns.len(), self.columns())?;
        if let Some(&column) = columns.iter().find(|&&c| c >= total) {
            return Err(LeastSquaresError::NoSuchColumn {
                column,
                columns: total,
            });
        }
        let mut products = Mat::zeros(total + 1, total + 1);
        let place = |j: usize| columns.get(j).copied().unwrap_or(total);
        for i in 0..=columns.len() {
            for j in 0..=columns.len() {
                products[(place(i), place(j))] = self.products[(i, j)];
            }
        }
        Ok(Gram {
            products,
            rows: self.rows,
        })
    }

    /// Normal equations of the same rows with the target less A·`mean`: a fit of them is the distance from `mean`.
    ///
    /// # Errors
    /// `mean` of another length.
    pub fn about(&self, mean: &[f64]) -> Result<Gram, LeastSquaresError> {
        let p = self.columns();
        check_size("the prior mean", mean.len(), p)?;
        let mut products = self.products.clone();
        for i in 0..=p {
            let shift: f64 = (0..p).map(|j| self.products[(i, j)] * mean[j]).sum();
            products[(i, p)] -= shift;
        }
        let shift: f64 = (0..p).map(|j| products[(j, p)] * mean[j]).sum();
        products[(p, p)] -= shift;
        for j in 0..p {
            products[(p, j)] = products[(j, p)];
        }
        Ok(Gram {
            products,
            rows: self.rows,
        })
    }

    /// The sums over the rows of both.
    ///
    /// # Errors
    /// Different numbers of columns.
    pub fn plus(&self, other: &Gram) -> Result<Gram, LeastSquaresError> {
        check_size("the other system", other.columns(), self.columns())?;
        Ok(Gram {
            products: &self.products + &other.products,
            rows: self.rows + other.rows,
        })
    }

    /// The sums over the rows of all.
    ///
    /// # Errors
    /// None at all, or different numbers of columns.
    pub fn sum(all: &[Gram]) -> Result<Gram, LeastSquaresError> {
        let (first, rest) = all.split_first().ok_or(LeastSquaresError::NoRows)?;
        rest.iter().try_fold(first.clone(), |sum, g| sum.plus(g))
    }

    /// The sums over these rows without those of `other`, which are among them.
    ///
    /// # Errors
    /// Different numbers of columns.
    pub fn less(&self, other: &Gram) -> Result<Gram, LeastSquaresError> {
        check_size("the other system", other.columns(), self.columns())?;
        Ok(Gram {
            products: &self.products - &other.products,
            rows: self.rows.saturating_sub(other.rows),
        })
    }

    /// Least squares on the columns of `subset`, with `ridge` relative to the norm of each column (1e-6 is the
    /// least that squared condition numbers leave room for; smaller values are raised to it). `None` where
    /// the columns are numerically dependent all the same.
    ///
    /// # Errors
    /// A column that does not exist.
    pub fn fit(&self, subset: &[usize], ridge: f64) -> Result<Option<GramFit>, LeastSquaresError> {
        self.check_columns(subset)?;
        let (k, p) = (subset.len(), self.columns());
        let n = &self.products;
        let scale: Vec<f64> = subset
            .iter()
            .map(|&c| {
                if n[(c, c)] > 0.0 {
                    n[(c, c)].sqrt()
                } else {
                    1.0
                }
            })
            .collect();
        let ridge2 = ridge.max(1e-6).powi(2);
        let mut l = vec![0.0; k * k];
        for i in 0..k {
            for j in 0..=i {
                l[i * k + j] = n[(subset[i], subset[j])] / (scale[i] * scale[j]);
            }
            l[i * k + i] += ridge2;
        }
        if cholesky::factor(&mut l, k).is_none() {
            return Ok(None);
        }
        let mut y: Vec<f64> = (0..k).map(|i| n[(subset[i], p)] / scale[i]).collect();
        cholesky::solve(&l, &mut y);
        let parameters: Vec<f64> = std::iter::zip(y, scale).map(|(y, s)| y / s).collect();
        let residual_sum_of_squares = self.residual_sum_of_squares(subset, &parameters)?;
        Ok(Some(GramFit {
            parameters,
            residual_sum_of_squares,
        }))
    }

    /// ‖A_S x − b‖² of parameters x for the columns S of `subset`, on the rows behind `self` (those held out,
    /// for a fit made on the others).
    ///
    /// # Errors
    /// A column that does not exist; `x` of another length than `subset`.
    pub fn residual_sum_of_squares(
        &self,
        subset: &[usize],
        x: &[f64],
    ) -> Result<f64, LeastSquaresError> {
        self.check_columns(subset)?;
        check_size("the parameter vector", x.len(), subset.len())?;
        let (n, p) = (&self.products, self.columns());
        let mut sum = n[(p, p)];
        for (&ci, &xi) in std::iter::zip(subset, x) {
            let nx: f64 = std::iter::zip(subset, x)
                .map(|(&cj, &xj)| n[(ci, cj)] * xj)
                .sum();
            sum += xi * (nx - 2.0 * n[(ci, p)]);
        }
        Ok(sum.max(0.0))
    }

    fn check_columns(&self, subset: &[usize]) -> Result<(), LeastSquaresError> {
        let columns = self.columns();
        match subset.iter().find(|&&c| c >= columns) {
            Some(&column) => Err(LeastSquaresError::NoSuchColumn { column, columns }),
            None => Ok(()),
        }
    }
}
