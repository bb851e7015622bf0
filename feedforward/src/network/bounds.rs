//! Bounds of the training inputs, and the fade of the output outside them.

use serde::{Deserialize, Serialize};
use signal::cholesky;

/// Start and end of the fade, as an excess over the training data: of a column's range, relative to its span,
/// and of the largest Mahalanobis distance of training, relative to that.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Fade {
    /// Excess up to which the output is untouched (0.1).
    pub start: f32,
    /// Excess from which the output is exactly zero (0.6).
    pub end: f32,
}

/// Position of a sample relative to the training samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inside {
    /// Factor on the compensator's output: 1 inside, 0 from where the fade ends.
    pub weight: f32,
    /// Excess: the larger of the distance beyond a column's range over its span, and of the Mahalanobis
    /// distance beyond the largest of training over that. Negative inside, minus infinity for a joint without a
    /// unit.
    pub excess: f32,
}

impl Inside {
    /// Value of a joint without a unit.
    pub const NOTHING_LEARNED: Self = Self {
        weight: 1.0,
        excess: f32::NEG_INFINITY,
    };

    /// Worse of two units: the lower weight and the larger excess.
    pub fn worse(self, other: Self) -> Self {
        Self {
            weight: self.weight.min(other.weight),
            excess: self.excess.max(other.excess),
        }
    }
}

impl Default for Fade {
    fn default() -> Self {
        Self {
            start: 0.1,
            end: 0.6,
        }
    }
}

impl Fade {
    /// 1 up to `start`, 0 from `end`, in between the quintic smootherstep (two continuous derivatives).
    #[inline]
    pub fn weight(&self, excess: f32) -> f32 {
        let s = ((excess - self.start) / (self.end - self.start)).clamp(0.0, 1.0);
        // Rounding may leave −10⁻⁷ just before the end.
        (1.0 - s * s * s * (s * (s * 6.0 - 15.0) + 10.0)).max(0.0)
    }

    pub(super) fn is_usable(&self) -> bool {
        self.start >= 0.0 && self.end > self.start && self.end.is_finite()
    }
}

/// Region of the training inputs, in normalised units, and the largest torque seen there.
///
/// A column that never varied is ignored, as by the normaliser.
#[derive(Debug, Clone, PartialEq)]
pub struct Bounds {
    low: Vec<f32>,
    high: Vec<f32>,
    mean: Vec<f32>,
    /// Lower Cholesky factor L of the covariance, row-major (columns × columns).
    factor: Vec<f32>,
    /// Largest Mahalanobis distance of a training sample.
    radius: f32,
    /// Largest magnitude of the training target, N·m.
    limit: f32,
    fade: Fade,
}

/// Share of the limit up to which the output is not bent.
const KNEE: f32 = 0.9;

impl Bounds {
    /// Bounds from stored parts; `None` where lengths disagree, a value is not finite or L is singular.
    pub fn new(
        low: Vec<f32>,
        high: Vec<f32>,
        mean: Vec<f32>,
        factor: Vec<f32>,
        radius: f32,
        limit: f32,
        fade: Fade,
    ) -> Option<Self> {
        let d = low.len();
        let lengths = high.len() == d && mean.len() == d && factor.len() == d.checked_mul(d)?;
        let finite = [&low, &high, &mean, &factor]
            .iter()
            .all(|v| v.iter().all(|x| x.is_finite()));
        let usable = lengths
            && finite
            && low.iter().zip(&high).all(|(l, h)| l <= h)
            && (0..d).all(|j| factor[j * d + j] > 0.0)
            && radius > 0.0
            && radius.is_finite()
            && limit >= 0.0
            && limit.is_finite()
            && fade.is_usable();
        usable.then_some(Self {
            low,
            high,
            mean,
            factor,
            radius,
            limit,
            fade,
        })
    }

    /// Fits range, mean and covariance to normalised rows, which are gone through twice.
    ///
    /// The covariance gets 10⁻⁶ of its mean variance on the diagonal, so nearly dependent columns (one
    /// joint's position and its sine) do not make it singular. `limit` is in N·m.
    pub fn fit<'a, I>(columns: usize, rows: I, limit: f32, fade: Fade) -> Option<Self>
    where
        I: Iterator<Item = &'a [f32]> + Clone,
    {
        let d = columns;
        let mut low = vec![f32::INFINITY; d];
        let mut high = vec![f32::NEG_INFINITY; d];
        let mut mean = vec![0.0_f64; d];
        let mut scatter = vec![0.0_f64; d * d];
        let mut before = vec![0.0_f64; d];
        let mut count = 0.0;
        for row in rows.clone() {
            count += 1.0;
            for (j, &x) in row.iter().enumerate() {
                low[j] = low[j].min(x);
                high[j] = high[j].max(x);
                before[j] = f64::from(x) - mean[j];
                mean[j] += before[j] / count;
            }
            for j in 0..d {
                for k in 0..=j {
                    scatter[j * d + k] += before[j] * (f64::from(row[k]) - mean[k]);
                }
            }
        }
        let trace: f64 = (0..d).map(|j| scatter[j * d + j] / count).sum();
        let ridge = (1e-6 * trace / d as f64).max(1e-12);
        let mut factor: Vec<f64> = scatter.iter().map(|sum| sum / count).collect();
        (0..d).for_each(|j| factor[j * d + j] += ridge);
        // Rounding may eat a pivot that the diagonal term kept positive.
        cholesky::factor_above(&mut factor, d, 1e-12);
        let mut bounds = Self {
            low,
            high,
            mean: mean.iter().map(|&m| m as f32).collect(),
            factor: factor.iter().map(|&v| v as f32).collect(),
            radius: 1.0,
            limit,
            fade,
        };
        let mut scratch = vec![0.0; d];
        let radius = rows
            .map(|row| bounds.distance(row, &mut scratch))
            .fold(0.0, f32::max);
        bounds.radius = radius.max(1.0);
        Self::new(
            bounds.low,
            bounds.high,
            bounds.mean,
            bounds.factor,
            bounds.radius,
            limit,
            fade,
        )
    }

    /// Number of input columns with bounds.
    pub fn columns(&self) -> usize {
        self.low.len()
    }

    /// Smallest normalised training value of each column.
    pub fn low(&self) -> &[f32] {
        &self.low
    }

    /// Largest normalised training value of each column.
    pub fn high(&self) -> &[f32] {
        &self.high
    }

    /// Mean of each normalised column.
    pub fn mean(&self) -> &[f32] {
        &self.mean
    }

    /// Lower Cholesky factor of the covariance of the normalised columns, row-major.
    pub fn factor(&self) -> &[f32] {
        &self.factor
    }

    /// Largest Mahalanobis distance of a training sample.
    pub fn radius(&self) -> f32 {
        self.radius
    }

    /// Magnitude that the output never exceeds, N·m.
    pub fn limit(&self) -> f32 {
        self.limit
    }

    /// Start and end of the fade.
    pub fn fade(&self) -> Fade {
        self.fade
    }

    /// Mahalanobis distance ‖L⁻¹(x − mean)‖ of a normalised sample from the training inputs, without unit. L is `factor`;
    /// `scratch` has one element per input column.
    pub fn distance(&self, x: &[f32], scratch: &mut [f32]) -> f32 {
        let d = self.columns();
        let mut sum = 0.0;
        for j in 0..d {
            let row = &self.factor[j * d..=j * d + j];
            let inner: f32 = row[..j].iter().zip(&scratch[..j]).map(|(l, y)| l * y).sum();
            let y = (x[j] - self.mean[j] - inner) / row[j];
            scratch[j] = y;
            sum += y * y;
        }
        sum.sqrt()
    }

    /// Factor in [0, 1] on the output for a normalised sample: 1 among the training inputs, smoothly to 0
    /// away from them, 0 for a sample that is not finite.
    pub fn weight(&self, x: &[f32], scratch: &mut [f32]) -> f32 {
        self.inside(x, scratch).weight
    }

    /// Position of a normalised sample relative to the training samples.
    pub fn inside(&self, x: &[f32], scratch: &mut [f32]) -> Inside {
        if !x.iter().all(|v| v.is_finite()) {
            return Inside {
                weight: 0.0,
                excess: f32::INFINITY,
            };
        }
        let distance = self.distance(x, scratch) / self.radius - 1.0;
        let (mut weight, mut excess) = (1.0, distance);
        for (j, &v) in x.iter().enumerate() {
            let span = self.high[j] - self.low[j];
            if span > 0.0 {
                let beyond = (v - self.high[j]).max(self.low[j] - v) / span;
                weight *= self.fade.weight(beyond);
                excess = excess.max(beyond);
            }
        }
        weight *= self.fade.weight(distance);
        Inside { weight, excess }
    }

    /// Holds a normalised value of column `j` within the region where the output is not yet zero, so that
    /// an absurd sample cannot drive recurrent states further than the training inputs could.
    #[inline]
    pub fn hold(&self, j: usize, x: f32) -> f32 {
        let slack = self.fade.end * (self.high[j] - self.low[j]);
        x.clamp(self.low[j] - slack, self.high[j] + slack)
    }

    /// Bends a torque above 90 % of the limit towards it: identity below, then
    /// sign(τ)·limit·(0.9 + 0.1·tanh((|τ|/limit − 0.9)/0.1)), which never exceeds the limit.
    #[inline]
    pub fn clamp(&self, torque: f32) -> f32 {
        let knee = KNEE * self.limit;
        let above = torque.abs() - knee;
        if above <= 0.0 {
            return torque;
        }
        let room = self.limit - knee;
        let bent = if room > 0.0 {
            room * (above / room).tanh()
        } else {
            0.0
        };
        (knee + bent).min(self.limit).copysign(torque)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn ring() -> Vec<[f32; 2]> {
        // Correlated: y = x + small circle.
        (0..200)
            .map(|i| i as f32 * 0.0314)
            .map(|t| [t.cos(), t.cos() + 0.1 * t.sin()])
            .collect()
    }

    fn bounds() -> Bounds {
        let rows = ring();
        Bounds::fit(2, rows.iter().map(|r| &r[..]), 5.0, Fade::default()).unwrap()
    }

    #[test]
    fn training_samples_are_untouched() {
        let b = bounds();
        let mut s = [0.0; 2];
        assert!(ring().iter().all(|r| b.weight(r, &mut s) == 1.0));
    }

    #[test]
    fn outside_the_correlation_fades_although_each_column_is_in_range() {
        let b = bounds();
        assert_eq!(b.weight(&[0.9, -0.9], &mut [0.0; 2]), 0.0);
    }

    #[test]
    fn distance_matches_a_hand_calculation() {
        // Covariance [[4, 2], [2, 5]] = L Lᵀ with L = [[2, 0], [1, 2]]; x − mean = (2, 3): L⁻¹(2, 3) = (1, 1).
        let b = Bounds::new(
            vec![-9.0; 2],
            vec![9.0; 2],
            vec![0.0; 2],
            vec![2.0, 0.0, 1.0, 2.0],
            1.0,
            1.0,
            Fade::default(),
        )
        .unwrap();
        assert!((b.distance(&[2.0, 3.0], &mut [0.0; 2]) - 2.0_f32.sqrt()).abs() < 1e-6);
    }

    proptest! {
        #[test]
        fn weight_falls_monotonically_on_every_ray_and_reaches_zero(angle in 0.0_f32..std::f32::consts::TAU) {
            let b = bounds();
            let mut s = [0.0; 2];
            let mut last = 1.0;
            for i in 0..400 {
                let r = i as f32 * 0.02;
                let w = b.weight(&[b.mean()[0] + r * angle.cos(), b.mean()[1] + r * angle.sin()], &mut s);
                prop_assert!((0.0..=1.0).contains(&w) && w <= last + 1e-6);
                last = w;
            }
            prop_assert_eq!(last, 0.0);
        }

        #[test]
        fn magnitude_never_exceeds_the_limit(torque in proptest::num::f32::NORMAL) {
            let b = bounds();
            let y = b.clamp(torque);
            prop_assert!(y.abs() <= 5.0 && y.signum() == torque.signum());
            if torque.abs() < 4.5 { prop_assert_eq!(y, torque); }
        }
    }

    #[test]
    fn excess_by_hand() {
        // Columns from −9 to 9; the distance of (x, 0) is x/2, its largest 10: 10.8 lies a tenth of 18 beyond the range.
        let b = Bounds::new(
            vec![-9.0; 2],
            vec![9.0; 2],
            vec![0.0; 2],
            vec![2.0, 0.0, 0.0, 2.0],
            10.0,
            1.0,
            Fade::default(),
        )
        .unwrap();
        let excess = |x: f32| b.inside(&[x, 0.0], &mut [0.0; 2]).excess;
        assert!((excess(10.8) - 0.1).abs() < 1e-6);
        // On the edge of the range, and 4.5 of 10 from the mean: the edge is nearer.
        assert!(excess(9.0).abs() < 1e-6);
        assert!((excess(0.0) + 0.5).abs() < 1e-6);
    }

    #[test]
    fn samples_that_are_not_finite_have_no_weight() {
        let b = bounds();
        assert_eq!(b.weight(&[f32::NAN, 0.0], &mut [0.0; 2]), 0.0);
        assert_eq!(b.weight(&[f32::INFINITY, 0.0], &mut [0.0; 2]), 0.0);
    }
}
