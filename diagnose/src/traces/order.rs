//! Periodogram of a residual over a joint's position. An order is an angular frequency over position, 1/rad (1/m); it
//! need not be a whole number.

use crate::algebra::cholesky::Cholesky;
use ndarray::{Array1, Array2, ArrayView1};
use std::f64::consts::{PI, TAU};

/// Least number of cycles that a line must have over the recorded range of positions.
const FEWEST_CYCLES: f64 = 2.5;
/// Largest number of cycles that are searched over the recorded range of positions.
const MOST_CYCLES: f64 = 320.0;
/// Largest frequency in time of a line at the joint's RMS velocity, as a part of the sampling rate.
const RATE_SHARE: f64 = 0.33;
/// Number of bins after which sine and cosine are computed anew, so that rounding errors do not add up.
const ANEW: usize = 64;

/// Residual of a joint, summed over bins of its position, from which slow torques of position are removed.
pub struct Orders {
    /// Sum of the residual in each bin, N·m (N).
    sum: Vec<f64>,
    /// Number of samples in each bin.
    count: Vec<f64>,
    /// Lowest recorded position, rad (m).
    low: f64,
    /// Range of the recorded positions, rad (m).
    range: f64,
    /// Least and largest order that the recording resolves, 1/rad (1/m).
    pub span: [f64; 2],
}

/// Periodic line of one order: its sine and cosine coefficients, and the squared error that it removes.
struct Line {
    /// Coefficient of the sine, N·m (N).
    sine: f64,
    /// Coefficient of the cosine, N·m (N).
    cosine: f64,
    /// Squared error that the line removes, summed over samples, (N·m)².
    gain: f64,
}

/// Least and largest order, 1/rad (1/m), that a recording resolves. `range` is that of the position, `speed`
/// the root mean square velocity, `rate` in Hz. None where range or rate is too small.
pub fn span(range: f64, speed: f64, rate: f64) -> Option<[f64; 2]> {
    let least = FEWEST_CYCLES * TAU / range;
    let most = (MOST_CYCLES * TAU / range).min(RATE_SHARE * TAU * rate / speed);
    (range >= 1e-4 && most > least).then_some([least, most])
}

impl Orders {
    /// Sums of `residual` over position `q`, both at the recorded samples; `rate` in Hz, `speed` the joint's
    /// root mean square velocity. None where the range or the rate is too small for any order.
    pub fn new(
        residual: ArrayView1<'_, f64>,
        q: ArrayView1<'_, f64>,
        speed: f64,
        rate: f64,
    ) -> Option<Self> {
        let (low, high) = q
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &x| {
                (a.min(x), b.max(x))
            });
        let range = high - low;
        let [least, most] = span(range, speed, rate)?;
        // Eight bins per period of the highest order.
        let bins = ((range * most / TAU * 8.0).ceil() as usize).max(16);
        let (mut sum, mut count) = (vec![0.0; bins], vec![0.0; bins]);
        for (&x, &r) in q.iter().zip(residual) {
            let b = (((x - low) / range * bins as f64) as usize).min(bins - 1);
            sum[b] += r;
            count[b] += 1.0;
        }
        remove_trend(&mut sum, &count);
        Some(Self {
            sum,
            count,
            low,
            range,
            span: [least, most],
        })
    }

    /// Step between neighbouring orders of the periodogram, 1/rad (1/m): a quarter of the resolution.
    fn step(&self) -> f64 {
        0.5 * PI / self.range
    }

    /// Resolution, 1/rad (1/m): orders closer than this are one line over the recorded range.
    pub fn resolution(&self) -> f64 {
        TAU / self.range
    }

    /// Width of a bin of position, rad (m).
    fn width(&self) -> f64 {
        self.range / self.count.len() as f64
    }

    /// Position at the middle of a bin, rad (m).
    fn place(&self, bin: usize) -> f64 {
        self.low + (bin as f64 + 0.5) * self.width()
    }

    /// Calls `f` with each bin, and the sine and cosine of order `k` at its middle. Both are rotated from bin to bin,
    /// and computed anew every [`ANEW`] bins so that rounding errors do not add up.
    fn turning(&self, k: f64, mut f: impl FnMut(usize, f64, f64)) {
        let (turn_s, turn_c) = (k * self.width()).sin_cos();
        for start in (0..self.count.len()).step_by(ANEW) {
            let (mut s, mut c) = (k * self.place(start)).sin_cos();
            for b in start..(start + ANEW).min(self.count.len()) {
                f(b, s, c);
                (s, c) = (s * turn_c + c * turn_s, c * turn_c - s * turn_s);
            }
        }
    }

    /// Orders of the periodogram, 1/rad (1/m), each with the squared error, summed over samples, that a sine of it removes.
    pub fn periodogram(&self) -> Vec<(f64, f64)> {
        let [least, most] = self.span;
        let n = ((most - least) / self.step()) as usize;
        (0..n)
            .map(|i| least + i as f64 * self.step())
            .map(|k| (k, self.line(k).gain))
            .collect()
    }

    /// Order that removes most squared error, 1/rad (1/m), and that squared error; none where no order is resolved.
    pub fn strongest(&self) -> Option<(f64, f64)> {
        let all = self.periodogram().into_iter();
        all.max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Strongest orders, 1/rad (1/m), at most `most`, fitted together.
    pub fn lines(mut self, most: usize) -> Vec<f64> {
        let mut found: Vec<(f64, Line)> = Vec::new();
        for _ in 0..most {
            let Some((best, _)) = self.strongest() else {
                break;
            };
            found.push(self.taken(best));
            // Lines overlap where positions are unevenly covered, so each is fitted again with the others removed.
            for l in (0..found.len()).chain(0..found.len()) {
                let (k, line) = &found[l];
                self.add(*k, line, 1.0);
                found[l] = self.taken(found[l].0);
            }
        }
        found.into_iter().map(|(k, _)| k).collect()
    }

    /// Line whose order is the best near `order`, with that order. The line is removed from the sums.
    fn taken(&mut self, order: f64) -> (f64, Line) {
        let k = self.refined(order);
        let line = self.line(k);
        self.add(k, &line, -1.0);
        (k, line)
    }

    /// Order near `k` at which a line removes most squared error.
    fn refined(&self, mut k: f64) -> f64 {
        let gain = |k: f64| self.line(k).gain;
        for width in [self.step() / 2.0, self.step() / 8.0, self.step() / 32.0] {
            let around = (-3..=3).map(|i| k + width * f64::from(i) / 2.0);
            k = around
                .max_by(|a, b| gain(*a).total_cmp(&gain(*b)))
                .unwrap_or(k);
        }
        k
    }

    /// Adds a line of order `k` times `sign` to the sums.
    fn add(&mut self, k: f64, line: &Line, sign: f64) {
        let mut sum = std::mem::take(&mut self.sum);
        let count = &self.count;
        self.turning(k, |b, s, c| {
            sum[b] += sign * count[b] * (line.sine * s + line.cosine * c);
        });
        self.sum = sum;
    }

    /// Line of one order, by least squares.
    fn line(&self, k: f64) -> Line {
        let (mut ss, mut sc, mut cc, mut sy, mut cy) = (0.0, 0.0, 0.0, 0.0, 0.0);
        self.turning(k, |b, s, c| {
            let (y, n) = (self.sum[b], self.count[b]);
            ss += n * s * s;
            sc += n * s * c;
            cc += n * c * c;
            sy += s * y;
            cy += c * y;
        });
        let det = ss * cc - sc * sc;
        if det <= 1e-9 * ss * cc {
            return Line {
                sine: 0.0,
                cosine: 0.0,
                gain: 0.0,
            };
        }
        let (sine, cosine) = ((cc * sy - sc * cy) / det, (ss * cy - sc * sy) / det);
        Line {
            sine,
            cosine,
            gain: sine * sy + cosine * cy,
        }
    }
}

/// Removes a polynomial of degree four over position from the sums. Slow torques of position would otherwise appear as
/// low orders.
fn remove_trend(sum: &mut [f64], count: &[f64]) {
    const TERMS: usize = 5;
    let powers = |b: usize| {
        let x = 2.0 * (b as f64 + 0.5) / count.len() as f64 - 1.0;
        std::array::from_fn::<f64, TERMS, _>(|k| x.powi(k as i32))
    };
    let mut a = Array2::<f64>::eye(TERMS) * 1e-9;
    let mut y = Array1::<f64>::zeros(TERMS);
    for (b, (s, n)) in sum.iter().zip(count).enumerate() {
        let p = powers(b);
        for i in 0..TERMS {
            y[i] += p[i] * s;
            for k in 0..TERMS {
                a[[i, k]] += n * p[i] * p[k];
            }
        }
    }
    let c = Cholesky::new(&a).solve(y.view());
    for (b, (s, n)) in sum.iter_mut().zip(count).enumerate() {
        *s -= n * powers(b).iter().zip(&c).map(|(p, c)| p * c).sum::<f64>();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_incommensurate_orders() {
        let q: Array1<f64> = (0..20_000)
            .map(|i| 1.3 * (f64::from(i) * 7e-4).sin())
            .collect();
        let r = q.mapv(|x| 0.8 * (20.7 * x + 0.3).sin() + 0.3 * (74.39 * x).cos() + 0.5 * x);
        let found = Orders::new(r.view(), q.view(), 0.5, 250.0)
            .unwrap()
            .lines(3);
        assert!(
            (found[0] - 20.7).abs() < 0.1 && found.iter().any(|k| (k - 74.39).abs() < 0.1),
            "{found:?}"
        );
    }
}
