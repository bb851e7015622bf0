//! Robust local regression.

/// Local polynomials over the nearest samples, with outliers weighed down: W. S. Cleveland, "Robust locally weighted regression and
/// smoothing scatterplots", J. Am. Stat. Assoc. 74(368), 1979. Degree 1 is LOWESS, degree 2 LOESS; with five robust passes the
/// latter is what MATLAB's `smooth` calls `rloess`, by which the UR5 paper smooths motor currents.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Loess {
    /// Number of samples that each local polynomial is fitted to.
    pub span: usize,
    /// Degree of the local polynomials: 1 or 2.
    pub degree: usize,
    /// Number of passes that weigh samples by their residual r: (1 − (r/6 m)²)² up to six times the median m of |r|.
    pub robust: usize,
}

/// Settings that do not fit the samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LoessError {
    /// Degree other than 1 or 2.
    #[error("degree {0} of local regression is neither 1 nor 2")]
    Degree(usize),
    /// Too few samples in a span, or more than there are.
    #[error("a span of {span} samples is not between {least} and the {samples} that there are")]
    Span {
        /// Number of samples in a span that was asked for.
        span: usize,
        /// Least span: two more than the degree.
        least: usize,
        /// Number of samples that were given.
        samples: usize,
    },
}

impl Loess {
    /// Smoothed `y` at `x`, which increases.
    ///
    /// # Errors
    /// See [`LoessError`].
    ///
    /// # Panics
    /// Where `x` and `y` differ in length.
    pub fn smooth(&self, x: &[f64], y: &[f64]) -> Result<Vec<f64>, LoessError> {
        assert_eq!(x.len(), y.len(), "one value for each place");
        if !(1..=2).contains(&self.degree) {
            return Err(LoessError::Degree(self.degree));
        }
        let least = self.degree + 2;
        if !(least..=x.len()).contains(&self.span) {
            return Err(LoessError::Span {
                span: self.span,
                least,
                samples: x.len(),
            });
        }
        let mut smooth = self.pass(x, y, &vec![0.0; x.len()]);
        for _ in 0..self.robust {
            let left: Vec<f64> = y.iter().zip(&smooth).map(|(y, s)| (y - s).abs()).collect();
            smooth = self.pass(x, y, &left);
        }
        Ok(smooth)
    }

    /// Smoothed values, with samples weighted by their residuals `left`. Around an outlier far beyond all
    /// others' residuals every weight would vanish; there the window's own median of residuals sets the scale.
    fn pass(&self, x: &[f64], y: &[f64], left: &[f64]) -> Vec<f64> {
        let scale = |left: &[f64]| 6.0 * crate::quantile::median(left.to_vec()).unwrap_or(0.0);
        let all = scale(left);
        let mut first = 0;
        (0..x.len())
            .map(|i| {
                // The window moves on while the sample after it is nearer than its own first.
                while first + self.span < x.len() && x[first + self.span] - x[i] < x[i] - x[first] {
                    first += 1;
                }
                let window = first..first + self.span;
                let reach = (x[i] - x[first]).max(x[window.end - 1] - x[i]);
                let at = |k: usize| (x[k] - x[i]) / reach;
                let near = |k: usize| (1.0 - at(k).abs().min(1.0).powi(3)).powi(3);
                let by = |scale: f64| {
                    let weight = |k: usize| trust(left[k], scale) * near(k);
                    self.local(window.clone().map(|k| (at(k), y[k], weight(k))))
                };
                by(all)
                    .or_else(|| by(scale(&left[window.clone()])))
                    .unwrap_or(y[i])
            })
            .collect()
    }

    /// The polynomial's value at zero; none where the weights leave too few samples for it.
    fn local(&self, samples: impl Iterator<Item = (f64, f64, f64)>) -> Option<f64> {
        let n = self.degree + 1;
        let (mut normal, mut right) = ([0.0; 9], [0.0; 3]);
        for (u, y, w) in samples {
            let powers = [1.0, u, u * u];
            for i in 0..n {
                right[i] += w * powers[i] * y;
                for j in 0..=i {
                    normal[i * n + j] += w * powers[i] * powers[j];
                }
            }
        }
        crate::cholesky::factor(&mut normal, n)?;
        crate::cholesky::solve(&normal, &mut right[..n]);
        Some(right[0])
    }
}

/// Bisquare weight of a sample by its residual.
fn trust(left: f64, scale: f64) -> f64 {
    if scale > 0.0 {
        (1.0 - (left / scale).min(1.0).powi(2)).powi(2)
    } else {
        1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A parabola is its own smooth, whatever one sample of it says.
    #[test]
    fn an_outlier_has_no_say() {
        let x: Vec<f64> = (0..40).map(f64::from).collect();
        let truth: Vec<f64> = x.iter().map(|t| 1.0 + 0.3 * t - 0.02 * t * t).collect();
        let mut y = truth.clone();
        for (k, y) in y.iter_mut().enumerate() {
            *y += 1e-3 * (7.0 * k as f64).sin();
        }
        y[17] += 25.0;
        let loess = Loess {
            span: 11,
            degree: 2,
            robust: 5,
        };
        let smooth = loess.smooth(&x, &y).unwrap();
        let off = smooth.iter().zip(&truth).map(|(a, b)| (a - b).abs());
        assert!(off.fold(0.0, f64::max) < 3e-3);
        let plain = Loess { robust: 0, ..loess }.smooth(&x, &y).unwrap();
        assert!((plain[17] - truth[17]).abs() > 1.0);
    }

    #[test]
    fn settings_that_do_not_fit() {
        let loess = Loess {
            span: 3,
            degree: 2,
            robust: 0,
        };
        let wrong = loess.smooth(&[0.0; 9], &[0.0; 9]);
        assert!(matches!(wrong, Err(LoessError::Span { least: 4, .. })));
        let wrong = Loess { degree: 3, ..loess }.smooth(&[0.0; 9], &[0.0; 9]);
        assert_eq!(wrong, Err(LoessError::Degree(3)));
    }
}
