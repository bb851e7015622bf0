//! Axes: from data to pixels, and where the ticks stand.

/// A linear or logarithmic mapping of a range of data onto a range of pixels.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Scale {
    data: (f64, f64),
    pixels: (f64, f64),
    log: bool,
}

impl Scale {
    /// Maps `data` onto `pixels`; an empty or degenerate range is widened, and a logarithmic one is
    /// cut to six decades below its upper end.
    pub(super) fn new((low, high): (f64, f64), pixels: (f64, f64), log: bool) -> Self {
        let (mut low, mut high) = if low.is_finite() && high.is_finite() {
            (low, high)
        } else if log {
            (0.1, 1.0)
        } else {
            (0.0, 1.0)
        };
        if log {
            if high <= 0.0 {
                high = 1.0;
            }
            low = low.max(high * 1e-6);
            if high / low < 10.0 {
                low = high / 10.0;
            }
        } else if high - low <= 1e-12 * high.abs().max(low.abs()) {
            let half = if high == 0.0 { 1.0 } else { 0.1 * high.abs() };
            (low, high) = (low - half, high + half);
        }
        Self {
            data: (low, high),
            pixels,
            log,
        }
    }

    /// Pixel of a value; values outside the range are put on its ends.
    pub(super) fn at(&self, value: f64) -> f64 {
        let (low, high) = self.data;
        let part = if self.log {
            (value.max(low) / low).ln() / (high / low).ln()
        } else {
            (value - low) / (high - low)
        };
        self.pixels.0 + part.clamp(0.0, 1.0) * (self.pixels.1 - self.pixels.0)
    }

    pub(super) fn contains(&self, value: f64) -> bool {
        (self.data.0..=self.data.1).contains(&value)
    }

    /// About `count` ticks at 1, 2 or 5 times a power of ten (powers of ten alone when
    /// logarithmic), with their labels.
    pub(super) fn ticks(&self, count: usize) -> Vec<(f64, String)> {
        if self.log {
            return self.decades(count);
        }
        let (low, high) = self.data;
        // One tick alone says no scale.
        (count.max(1)..)
            .take(5)
            .map(|n| self.linear(low, high, n))
            .find(|ticks| ticks.len() > 1)
            .unwrap_or_else(|| self.linear(low, high, count))
    }

    fn linear(&self, low: f64, high: f64, count: usize) -> Vec<(f64, String)> {
        let raw = (high - low) / count.max(1) as f64;
        let magnitude = 10_f64.powi(raw.log10().floor() as i32);
        let step = [1.0, 2.0, 5.0, 10.0]
            .map(|m| m * magnitude)
            .into_iter()
            .find(|s| *s >= raw * 0.999)
            .unwrap_or(10.0 * magnitude);
        let decimals = (-(step * 1.001).log10().floor()).clamp(0.0, 12.0) as usize;
        let (first, last) = ((low / step).ceil(), (high / step).floor());
        (0..=((last - first).clamp(0.0, 100.0) as usize))
            .map(|i| (first + i as f64) * step)
            .filter(|v| self.contains(*v))
            .map(|v| {
                let v = if v.abs() < 1e-9 * step { 0.0 } else { v };
                (v, label(v, decimals, high.abs().max(low.abs())))
            })
            .collect()
    }

    fn decades(&self, count: usize) -> Vec<(f64, String)> {
        let first = (self.data.0.log10() - 1e-9).ceil() as i32;
        let last = (self.data.1.log10() + 1e-9).floor() as i32;
        let every = (last - first + 1).div_euclid(count.max(1) as i32).max(1);
        (first..=last)
            .step_by(every as usize)
            .map(|e| {
                let text = match e {
                    -3..=4 => format!("{}", 10_f64.powi(e)),
                    _ => format!("10{}", superscript(e)),
                };
                (10_f64.powi(e), text.replace('-', "−"))
            })
            .collect()
    }
}

fn label(value: f64, decimals: usize, largest: f64) -> String {
    let text = if value != 0.0 && (largest >= 1e6 || decimals > 5) {
        format!("{value:.1e}")
    } else {
        format!("{value:.decimals$}")
    };
    text.replace('-', "−")
}

fn superscript(exponent: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    exponent
        .to_string()
        .chars()
        .map(|c| c.to_digit(10).map_or('⁻', |d| DIGITS[d as usize]))
        .collect()
}

/// Smallest and largest finite value, positive ones only where `log`.
pub(super) fn range(values: impl Iterator<Item = f64>, log: bool) -> (f64, f64) {
    values
        .filter(|v| v.is_finite() && (!log || *v > 0.0))
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
            (low.min(v), high.max(v))
        })
}

/// The range with a margin of a part of its length at both ends.
pub(super) fn padded((low, high): (f64, f64), part: f64) -> (f64, f64) {
    let margin = part * (high - low);
    (low - margin, high + margin)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn labels(scale: &Scale, count: usize) -> Vec<String> {
        scale.ticks(count).into_iter().map(|t| t.1).collect()
    }

    #[test]
    fn ticks_are_round_numbers() {
        let scale = Scale::new((-0.31, 0.52), (0.0, 100.0), false);
        assert_eq!(labels(&scale, 5), ["−0.2", "0.0", "0.2", "0.4"]);
        let scale = Scale::new((0.0, 1000.0), (0.0, 100.0), false);
        assert_eq!(labels(&scale, 4), ["0", "500", "1000"]);
        let scale = Scale::new((2e-5, 3e2), (0.0, 100.0), true);
        assert_eq!(
            labels(&scale, 9),
            ["0.001", "0.01", "0.1", "1", "10", "100"]
        );
    }

    #[test]
    fn one_tick_alone_is_none() {
        let scale = Scale::new((-4.2, 2.1), (0.0, 100.0), false);
        for count in 1..=4 {
            assert_eq!(labels(&scale, count), ["−4", "−2", "0", "2"]);
        }
    }

    #[test]
    fn values_map_linearly_and_by_decades() {
        let linear = Scale::new((0.0, 10.0), (100.0, 0.0), false);
        assert_eq!(linear.at(2.5), 75.0);
        assert_eq!(linear.at(99.0), 0.0);
        let log = Scale::new((0.01, 100.0), (0.0, 400.0), true);
        assert!((log.at(1.0) - 200.0).abs() < 1e-9);
    }

    proptest! {
        #[test]
        fn any_range_gives_finite_pixels_and_a_few_ticks(
            low in proptest::num::f64::ANY, high in proptest::num::f64::ANY, log: bool,
        ) {
            prop_assume!(!(low.is_finite() && high.is_finite() && (high - low).is_infinite()));
            let scale = Scale::new((low.min(high), high.max(low)), (0.0, 100.0), log);
            prop_assert!((0.0..=100.0).contains(&scale.at(low.max(-1e300))) || low.is_nan());
            prop_assert!(scale.ticks(5).len() <= 12);
        }
    }
}
