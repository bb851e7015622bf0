//! Filters between a torque and its log.

use serde::Serialize;
use std::f64::consts::TAU;

/// A causal filter on the torque.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Lag {
    /// No filter: the torque passes as it is.
    None,
    /// First order, corner in Hz.
    First {
        /// Corner frequency of the filter, Hz.
        corner_hz: f64,
    },
    /// Low-pass of second order.
    Second {
        /// Undamped frequency of the poles, Hz.
        corner_hz: f64,
        /// Damping ratio of the poles.
        damping: f64,
    },
    /// Mean of the last ten samples of a controller.
    MovingAverage {
        /// Time between the averaged samples, s.
        period_s: f64,
    },
}

/// Integration steps per tick of the trace.
const SUBSTEPS: usize = 10;

impl Lag {
    /// Delay of a slow signal by the filter, s: the first moment of its impulse response.
    pub fn first_moment(self) -> f64 {
        match self {
            Self::None => 0.0,
            Self::First { corner_hz } => 1.0 / (TAU * corner_hz),
            Self::Second { corner_hz, damping } => 2.0 * damping / (TAU * corner_hz),
            Self::MovingAverage { period_s } => 4.5 * period_s,
        }
    }

    /// Change of the filter's output y and of its rate v in a tick (s), for an input x: (y, v) becomes the rows' products with
    /// (y, v, x). None for a filter with a longer memory.
    pub fn per_tick(self, tick: f64) -> Option<[[f64; 3]; 2]> {
        match self {
            Self::None => Some([[0.0, 0.0, 1.0], [0.0; 3]]),
            Self::First { corner_hz } => {
                let pass = 1.0 - (-TAU * corner_hz * tick).exp();
                Some([[1.0 - pass, 0.0, pass], [0.0; 3]])
            }
            Self::Second { corner_hz, damping } => {
                let (w, h) = (TAU * corner_hz, tick / SUBSTEPS as f64);
                let (mut y, mut v) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
                for _ in 0..SUBSTEPS {
                    for i in 0..3 {
                        let x = if i == 2 { 1.0 } else { 0.0 };
                        v[i] += h * (w * w * (x - y[i]) - 2.0 * damping * w * v[i]);
                        y[i] += h * v[i];
                    }
                }
                Some([y, v])
            }
            Self::MovingAverage { .. } => None,
        }
    }

    /// The filtered signal; the filter starts settled at the first value. `tick` is the step of `x`, s.
    pub fn apply(self, x: &[f64], tick: f64) -> Vec<f64> {
        let first = x.first().copied().unwrap_or(0.0);
        match self {
            Self::None => x.to_vec(),
            Self::First { corner_hz } => {
                let pass = 1.0 - (-TAU * corner_hz * tick).exp();
                let mut y = first;
                let step = |x: &f64| {
                    y += pass * (x - y);
                    y
                };
                x.iter().map(step).collect()
            }
            Self::Second { corner_hz, damping } => {
                let (w, h) = (TAU * corner_hz, tick / SUBSTEPS as f64);
                let (mut y, mut v) = (first, 0.0);
                let step = |x: &f64| {
                    for _ in 0..SUBSTEPS {
                        v += h * (w * w * (x - y) - 2.0 * damping * w * v);
                        y += h * v;
                    }
                    y
                };
                x.iter().map(step).collect()
            }
            Self::MovingAverage { period_s } => {
                let at = |t: f64| {
                    let k = t.max(0.0).min((x.len() - 1) as f64);
                    let (i, w) = (k as usize, k.fract());
                    x[i] + w * (x[(i + 1).min(x.len() - 1)] - x[i])
                };
                let ticks = period_s / tick;
                let mean = |k: usize| {
                    let ten = (0..10).map(|i| at(k as f64 - f64::from(i) * ticks));
                    ten.sum::<f64>() / 10.0
                };
                (0..x.len()).map(mean).collect()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every filter delays a slow ramp by its first moment: 1/w, 2ζ/w, and 4.5 periods.
    #[test]
    fn a_ramp_is_late_by_the_first_moment() {
        let x: Vec<f64> = (0..3000).map(|k| f64::from(k) * 1e-3).collect();
        let corner_hz = 8.0;
        let cases = [
            (Lag::None, 0.0),
            (Lag::First { corner_hz }, 1.0 / (TAU * 8.0)),
            (
                Lag::Second {
                    corner_hz,
                    damping: 0.7,
                },
                1.4 / (TAU * 8.0),
            ),
            (Lag::MovingAverage { period_s: 0.008 }, 0.036),
        ];
        for (lag, expected) in cases {
            let y = lag.apply(&x, 1e-3);
            assert!((x[2999] - y[2999] - expected).abs() < 6e-4, "{lag:?}");
            assert!((lag.first_moment() - expected).abs() < 1e-12, "{lag:?}");
            let Some([by_y, by_v]) = lag.per_tick(1e-3) else {
                continue;
            };
            let (mut at, mut rate) = (x[0], 0.0);
            for (x, y) in x.iter().zip(&y) {
                let state = [at, rate, *x];
                let of = |by: [f64; 3]| by.iter().zip(state).map(|(b, s)| b * s).sum::<f64>();
                (at, rate) = (of(by_y), of(by_v));
                assert!((at - y).abs() < 1e-9, "{lag:?}");
            }
        }
    }
}
