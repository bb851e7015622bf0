//! Parameters, covariance and standard deviations from a triangle.

use super::triangle::triangle_of;
use super::{LeastSquaresError, Triangle, check_size};
use faer::linalg::triangular_solve::solve_upper_triangular_in_place;
use faer::{Mat, Par};
use ndarray::Array2;

/// Prior distribution of the parameters: independent normal distributions.
#[derive(Debug, Clone, PartialEq)]
pub struct Prior {
    /// Prior mean of each parameter, length p.
    pub mean: Vec<f64>,
    /// Standard deviation, length p, in the units of the parameters; infinite: nothing is known.
    pub std: Vec<f64>,
}

/// Settings of the solution [`solve`].
#[derive(Debug, Clone, PartialEq)]
pub struct SolveOptions {
    /// Indices of the columns to use; the parameters of the others are zero. `None`: all.
    pub columns: Option<Vec<usize>>,
    /// Ridge relative to the norm of each column: holds directions that the data do not determine (singular
    /// values below this, of the system with columns of unit norm) at the prior mean or zero. Default 1e-9.
    pub ridge: f64,
    /// Prior towards a nominal or older model, for short data. Default none.
    pub prior: Option<Prior>,
    /// Variance of the noise of a (weighted) row; `None`: estimated from the residual.
    pub sigma2: Option<f64>,
}

impl Default for SolveOptions {
    fn default() -> Self {
        Self {
            columns: None,
            ridge: 1e-9,
            prior: None,
            sigma2: None,
        }
    }
}

/// A least-squares estimate with its uncertainty.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Estimated parameters, length p.
    pub parameters: Vec<f64>,
    /// Covariance of the parameters, p × p, for independent noise; zero for columns left out.
    pub covariance: Array2<f64>,
    /// Standard deviation of each parameter, length p.
    pub std: Vec<f64>,
    /// Standard deviation relative to the parameter's magnitude; `None` for a parameter of zero.
    pub relative_std: Vec<Option<f64>>,
    /// Variance of the noise of a (weighted) row.
    pub sigma2: f64,
    /// Residual sum of squares over the (weighted) rows, prior and ridge not counted.
    pub residual_sum_of_squares: f64,
    /// Number of rows behind the estimate.
    pub rows: usize,
    /// Numerical rank of the columns used, at the relative ridge: below their number, some
    /// parameters are held by prior or ridge alone.
    pub rank: usize,
}

impl Estimate {
    /// Same estimate with another covariance (p × p).
    ///
    /// # Errors
    /// A covariance of another size.
    pub fn with_covariance(mut self, covariance: Array2<f64>) -> Result<Self, LeastSquaresError> {
        let p = self.parameters.len();
        check_size("the covariance", covariance.nrows(), p)?;
        check_size("the covariance", covariance.ncols(), p)?;
        self.covariance = covariance;
        self.set_deviations();
        Ok(self)
    }

    fn set_deviations(&mut self) {
        let variances = self.covariance.diag();
        self.std = variances.iter().map(|v| v.max(0.0).sqrt()).collect();
        self.relative_std = std::iter::zip(&self.std, &self.parameters)
            .map(|(s, x)| (*x != 0.0).then(|| s / x.abs()))
            .collect();
    }
}

/// Minimises ‖A x − b‖² + σ² Σ ((x_j − x̄_j)/s_j)² + ridge² Σ (‖A_j‖ (x_j − x̄_j))² over the columns chosen,
/// where x̄, s are the prior (without one, x̄ = 0 and the second sum is absent).
///
/// The covariance is σ² (AᵀA + σ² S⁻² + ridge²)⁻¹: the posterior one where there is a prior. σ² is the
/// residual sum of squares over rows minus rank, unless given; where the rows are as few as the rank,
/// the mean squared error of the prior mean.
///
/// # Errors
/// A triangle without rows, a column that does not exist, a prior of the wrong size or without positive deviations.
pub fn solve(triangle: &Triangle, options: &SolveOptions) -> Result<Estimate, LeastSquaresError> {
    let p = triangle.columns();
    if triangle.rows() == 0 {
        return Err(LeastSquaresError::NoRows);
    }
    let prior = options.prior.as_ref();
    check_prior(prior, p)?;
    let columns: Vec<usize> = match &options.columns {
        Some(columns) => columns.clone(),
        None => (0..p).collect(),
    };
    let picked = triangle.select(&columns)?;
    let mean: Vec<f64> = columns
        .iter()
        .map(|&c| prior.map_or(0.0, |prior| prior.mean[c]))
        .collect();
    let scale = column_norms(&picked);
    let rank = rank(&picked, &scale, options.ridge);

    let sigma2 = match options.sigma2 {
        Some(sigma2) => sigma2,
        None if picked.rows() > rank => {
            let free = regularised(&picked, &scale, &mean, options.ridge, None)?;
            picked.residual_sum_of_squares(&free.x)? / (picked.rows() - rank) as f64
        }
        None => picked.residual_sum_of_squares(&mean)? / picked.rows() as f64,
    };
    let pull: Option<Vec<f64>> = prior.map(|prior| {
        let sigma = sigma2.sqrt();
        columns.iter().map(|&c| sigma / prior.std[c]).collect()
    });
    let fit = regularised(&picked, &scale, &mean, options.ridge, pull.as_deref())?;

    let mut parameters = vec![0.0; p];
    let mut covariance = Array2::zeros((p, p));
    for (i, &ci) in columns.iter().enumerate() {
        parameters[ci] = fit.x[i];
        for (j, &cj) in columns.iter().enumerate() {
            covariance[(ci, cj)] = sigma2 * fit.inverse_normal[(i, j)];
        }
    }
    let mut estimate = Estimate {
        residual_sum_of_squares: picked.residual_sum_of_squares(&fit.x)?,
        parameters,
        covariance,
        std: Vec::new(),
        relative_std: Vec::new(),
        sigma2,
        rows: triangle.rows(),
        rank,
    };
    estimate.set_deviations();
    Ok(estimate)
}

fn check_prior(prior: Option<&Prior>, p: usize) -> Result<(), LeastSquaresError> {
    let Some(prior) = prior else { return Ok(()) };
    check_size("the prior mean", prior.mean.len(), p)?;
    check_size("the prior deviation", prior.std.len(), p)?;
    if prior.mean.iter().any(|m| !m.is_finite()) {
        return Err(LeastSquaresError::NotFinite);
    }
    match prior.std.iter().position(|s| s.is_nan() || *s <= 0.0) {
        Some(column) => Err(LeastSquaresError::BadPrior { column }),
        None => Ok(()),
    }
}

/// Euclidean norm of each column of A; 1 for a column of zeros.
fn column_norms(triangle: &Triangle) -> Vec<f64> {
    let r = triangle.r();
    (0..triangle.columns())
        .map(|j| {
            let norm = r.col(j).norm_l2();
            if norm > 0.0 { norm } else { 1.0 }
        })
        .collect()
}

/// Number of pivots above `tolerance` in the pivoted QR decomposition of R with unit columns.
fn rank(triangle: &Triangle, scale: &[f64], tolerance: f64) -> usize {
    let p = triangle.columns();
    let r = triangle.r();
    let unit = Mat::from_fn(p, p, |i, j| r[(i, j)] / scale[j]);
    let qr = unit.col_piv_qr();
    let pivots = qr.R();
    (0..p)
        .filter(|&i| pivots[(i, i)].abs() > tolerance.max(1e-14))
        .count()
}

struct Regularised {
    x: Vec<f64>,
    /// (AᵀA + ridge and prior)⁻¹.
    inverse_normal: Mat<f64>,
}

/// Solves in y = D (x − x̄), D the column norms, with the rows `ridge` and `pull`/D appended below R D⁻¹.
fn regularised(
    triangle: &Triangle,
    scale: &[f64],
    mean: &[f64],
    ridge: f64,
    pull: Option<&[f64]>,
) -> Result<Regularised, LeastSquaresError> {
    let p = triangle.columns();
    let (r, e) = (triangle.r(), triangle.residual(mean));
    let mut stacked = Mat::zeros(3 * p, p + 1);
    for j in 0..p {
        for i in 0..=j {
            stacked[(i, j)] = r[(i, j)] / scale[j];
        }
        stacked[(p + j, j)] = ridge;
        stacked[(2 * p + j, j)] = pull.map_or(0.0, |pull| pull[j] / scale[j]);
        stacked[(j, p)] = e[j];
    }
    let factor = triangle_of(stacked.as_mut());
    let upper = factor.as_ref().submatrix(0, 0, p, p);
    let mut y = factor.as_ref().submatrix(0, p, p, 1).to_owned();
    solve_upper_triangular_in_place(upper, y.as_mut(), Par::Seq);
    let mut inverse = Mat::<f64>::identity(p, p);
    solve_upper_triangular_in_place(upper, inverse.as_mut(), Par::Seq);
    if !inverse.is_all_finite() || !y.is_all_finite() {
        return Err(LeastSquaresError::NotFinite);
    }
    let normal = &inverse * inverse.transpose();
    // One step of refinement (corrected semi-normal equations): the reflections leave rounding of the size of
    // the target in rows as small as the ridge, which would show in columns held by it alone.
    let unit = |i: usize, j: usize| r[(i, j)] / scale[j];
    let left: Vec<f64> = (0..p)
        .map(|i| e[i] - (i..p).map(|j| unit(i, j) * y[(j, 0)]).sum::<f64>())
        .collect();
    let gradient = Mat::from_fn(p, 1, |j, _| {
        let held = ridge * ridge + pull.map_or(0.0, |pull| (pull[j] / scale[j]).powi(2));
        (0..=j).map(|i| unit(i, j) * left[i]).sum::<f64>() - held * y[(j, 0)]
    });
    y += &normal * gradient;
    Ok(Regularised {
        x: (0..p).map(|j| mean[j] + y[(j, 0)] / scale[j]).collect(),
        inverse_normal: Mat::from_fn(p, p, |i, j| normal[(i, j)] / (scale[i] * scale[j])),
    })
}
