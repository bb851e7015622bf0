//! Quadratic log likelihood, and the evidence of a model in which some of its parameters are free.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// Gaussian prior of one parameter where it is free. Where it is fixed, it has the value `mean`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prior {
    /// Mean of the prior, in the parameter's unit: the given value. A fixed parameter has this value.
    pub mean: f64,
    /// Standard deviation of the prior, in the parameter's unit, above zero.
    pub deviation: f64,
    /// Whether the parameter cannot be negative. The search fixes it at zero where its posterior mean would be
    /// negative.
    pub positive: bool,
}

/// Quadratic expansion of the negative log likelihood in P parameters x: ½ (x − x₀)ᵀ H (x − x₀) + gᵀ (x − x₀), in nats,
/// up to a constant.
#[derive(Debug, Clone)]
pub struct Quadratic {
    /// Point x₀ of the expansion: the value of each of the P parameters there.
    pub at: Vec<f64>,
    /// Gradient g of the negative log likelihood at x₀, P values.
    pub gradient: DVector<f64>,
    /// Hessian H of the negative log likelihood, P × P, positive semidefinite (Gauss-Newton or Fisher information).
    pub information: DMatrix<f64>,
}

/// Gaussian posterior of the free parameters of one model, and the model's evidence.
#[derive(Debug, Clone)]
pub struct Mode {
    /// Log evidence of the model, nats: the likelihood integrated over the prior, up to the likelihood's constant.
    pub log_evidence: f64,
    /// Indices of the free parameters among all P, in the order of `x`.
    pub free: Vec<usize>,
    /// Posterior mean of each free parameter, in the order of `free`.
    pub x: DVector<f64>,
    /// Cholesky factor of the posterior precision matrix (inverse covariance) of the free parameters.
    precision: Cholesky<f64, Dyn>,
}

impl Mode {
    /// Posterior covariance matrix of the free parameters, in the order of `free`.
    pub fn covariance(&self) -> DMatrix<f64> {
        self.precision.inverse()
    }
}

impl Quadratic {
    /// Posterior and evidence of the model with the parameters `free`. All others stay at their priors' means. `priors`
    /// has one entry for each of the P parameters. None where the posterior precision is not positive definite or the
    /// evidence not finite.
    ///
    /// With d = means − x₀ and y = x − means, the exponent is ½ yᵀ (H + Λ) y + yᵀ (g + H d) + const. Λ is the diagonal
    /// matrix of prior precisions. The evidence is the integral over y against the prior N(0, Λ⁻¹).
    pub fn mode(&self, free: &[usize], priors: &[Prior]) -> Option<Mode> {
        let p = self.at.len();
        let d = DVector::from_iterator(p, (0..p).map(|i| priors[i].mean - self.at[i]));
        let pushed = &self.gradient + &self.information * &d;
        let fixed = 0.5 * d.dot(&(&self.information * &d)) + self.gradient.dot(&d);
        let m = free.len();
        let mut precision = DMatrix::zeros(m, m);
        let mut log_prior = 0.0;
        for (r, &i) in free.iter().enumerate() {
            for (c, &k) in free.iter().enumerate() {
                precision[(r, c)] = self.information[(i, k)];
            }
            let own = priors[i].deviation.powi(-2);
            precision[(r, r)] += own;
            log_prior += 0.5 * own.ln();
        }
        let b = DVector::from_iterator(m, free.iter().map(|&i| pushed[i]));
        let precision = Cholesky::new(precision)?;
        let y = -precision.solve(&b);
        let log_determinant: f64 = precision.l_dirty().diagonal().iter().map(|l| l.ln()).sum();
        let log_evidence = -fixed - 0.5 * b.dot(&y) + log_prior - log_determinant;
        let x = DVector::from_iterator(
            m,
            free.iter().zip(y.iter()).map(|(&i, y)| priors[i].mean + y),
        );
        log_evidence.is_finite().then_some(Mode {
            log_evidence,
            free: free.to_vec(),
            x,
            precision,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One observation y = 2 of x with unit noise, prior N(0, 3²): the evidence is N(2; 0, 1 + 9).
    #[test]
    fn one_parameter_by_hand() {
        let quadratic = Quadratic {
            at: vec![2.0],
            gradient: DVector::zeros(1),
            information: DMatrix::identity(1, 1),
        };
        let prior = [Prior {
            mean: 0.0,
            deviation: 3.0,
            positive: false,
        }];
        let with = quadratic.mode(&[0], &prior).expect("proper");
        let without = quadratic.mode(&[], &prior).expect("proper");
        let normal = |v: f64| -0.5 * 4.0 / v - 0.5 * v.ln();
        assert!(
            (with.log_evidence - without.log_evidence - (normal(10.0) - normal(1.0))).abs() < 1e-12
        );
        assert!((with.x[0] - 1.8).abs() < 1e-12);
        assert!((with.covariance()[(0, 0)] - 0.9).abs() < 1e-12);
    }
}
