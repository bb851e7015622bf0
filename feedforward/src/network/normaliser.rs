//! Scaling of inputs and targets, stored with the unit.

use serde::{Deserialize, Serialize};

/// Kind of scaling that is fitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Normalisation {
    /// Scaling to a range: (x − min)/(max − min), equation 26 of Wang et al.
    MinMax,
    /// Scaling to unit deviation: (x − mean)/standard deviation.
    ZScore,
}

/// Column-wise affine scaling x ↦ (x − offset)/span.
///
/// A column that never varied in training has span 0: it carries no information and is mapped to 0
/// whatever its value.
#[derive(Debug, Clone, PartialEq)]
pub struct Normaliser {
    offset: Vec<f32>,
    span: Vec<f32>,
    inverse: Vec<f32>,
}

impl Normaliser {
    /// Scaling by offsets and spans of equal length; `None` where they are not finite or a span is negative.
    pub fn new(offset: Vec<f32>, span: Vec<f32>) -> Option<Self> {
        let usable = offset.len() == span.len()
            && offset.iter().all(|v| v.is_finite())
            && span.iter().all(|v| v.is_finite() && *v >= 0.0);
        let inverse = span
            .iter()
            .map(|&s| if s > 0.0 { 1.0 / s } else { 0.0 })
            .collect();
        usable.then_some(Self {
            offset,
            span,
            inverse,
        })
    }

    /// Fits `kind` to `rows` yielded as slices of `columns` values each.
    pub fn fit<'a>(
        kind: Normalisation,
        columns: usize,
        rows: impl Iterator<Item = &'a [f32]>,
    ) -> Option<Self> {
        let mut low = vec![f32::INFINITY; columns];
        let mut high = vec![f32::NEG_INFINITY; columns];
        let mut mean = vec![0.0_f64; columns];
        let mut square = vec![0.0_f64; columns];
        let mut count = 0.0;
        for row in rows {
            count += 1.0;
            for (j, &x) in row.iter().enumerate().take(columns) {
                low[j] = low[j].min(x);
                high[j] = high[j].max(x);
                // Welford's update: no cancellation for large means.
                let d = f64::from(x) - mean[j];
                mean[j] += d / count;
                square[j] += d * (f64::from(x) - mean[j]);
            }
        }
        let (offset, span) = match kind {
            Normalisation::MinMax => {
                let span = low.iter().zip(&high).map(|(l, h)| h - l).collect();
                (low, span)
            }
            Normalisation::ZScore => {
                let varies = |j: usize| high[j] > low[j];
                let span = (0..columns).map(|j| {
                    if varies(j) {
                        (square[j] / count).sqrt() as f32
                    } else {
                        0.0
                    }
                });
                let span = span.collect();
                (mean.iter().map(|&m| m as f32).collect(), span)
            }
        };
        Self::new(offset, span)
    }

    /// Number of columns that are scaled.
    pub fn columns(&self) -> usize {
        self.offset.len()
    }

    /// Offset of each column, in the column's unit.
    pub fn offset(&self) -> &[f32] {
        &self.offset
    }

    /// Span of each column, in the column's unit; 0 for a column that never varied.
    pub fn span(&self) -> &[f32] {
        &self.span
    }

    /// Scales one value of column `j`.
    #[inline]
    pub fn apply(&self, j: usize, x: f32) -> f32 {
        (x - self.offset[j]) * self.inverse[j]
    }

    /// Physical value of a normalised one: the inverse of [`Self::apply`].
    #[inline]
    pub fn invert(&self, j: usize, x: f32) -> f32 {
        x * self.span[j] + self.offset[j]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn min_max_maps_the_extremes_to_zero_and_one() {
        let rows: [&[f32]; 3] = [&[2.0, 7.0], &[6.0, 7.0], &[3.0, 7.0]];
        let n = Normaliser::fit(Normalisation::MinMax, 2, rows.into_iter()).unwrap();
        assert_eq!(
            [n.apply(0, 2.0), n.apply(0, 6.0), n.apply(0, 3.0)],
            [0.0, 1.0, 0.25]
        );
        assert_eq!(n.apply(1, 9.0), 0.0);
        assert_eq!(n.invert(0, 0.25), 3.0);
    }

    #[test]
    fn z_score_gives_zero_mean_and_unit_deviation() {
        let rows: [&[f32]; 2] = [&[1.0], &[5.0]];
        let n = Normaliser::fit(Normalisation::ZScore, 1, rows.into_iter()).unwrap();
        assert_eq!([n.apply(0, 1.0), n.apply(0, 5.0)], [-1.0, 1.0]);
    }

    #[test]
    fn unusable_scalings_are_refused() {
        assert!(Normaliser::new(vec![f32::NAN], vec![1.0]).is_none());
        assert!(Normaliser::new(vec![0.0], vec![-1.0]).is_none());
        assert!(Normaliser::fit(Normalisation::MinMax, 1, std::iter::empty()).is_none());
    }
}
