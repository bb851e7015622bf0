//! A cloud of points as a curve with its spread.

use super::scale::range;
use std::ops::Range;

/// Mean and standard deviation of y by bin of x.
pub(super) struct Bins {
    /// Centres of the bins that hold enough samples, ascending.
    pub(super) center: Vec<f64>,
    pub(super) mean: Vec<f64>,
    pub(super) std: Vec<f64>,
    /// Bins that follow each other with at most one empty one between them.
    pub(super) runs: Vec<Range<usize>>,
}

impl Bins {
    /// Least number of samples in a bin: a mean of fewer is too uncertain to be drawn.
    const FEWEST_SAMPLES: usize = 5;

    /// Equal bins over the range of x; pairs that are not finite are left out.
    pub(super) fn of(x: &[f64], y: &[f64], bins: usize) -> Self {
        let pairs = || {
            std::iter::zip(x, y)
                .map(|(&x, &y)| (x, y))
                .filter(|(x, y)| x.is_finite() && y.is_finite())
        };
        let (low, high) = range(pairs().map(|p| p.0), false);
        let width = (high - low) / bins.max(1) as f64;
        let mut members = vec![Vec::new(); bins.max(1)];
        for (x, y) in pairs() {
            let bin = if width > 0.0 {
                ((x - low) / width) as usize
            } else {
                0
            };
            members[bin.min(bins.max(1) - 1)].push(y);
        }
        let mut found = Self {
            center: Vec::new(),
            mean: Vec::new(),
            std: Vec::new(),
            runs: Vec::new(),
        };
        let mut last = None;
        for (bin, y) in members.iter().enumerate() {
            if y.len() < Self::FEWEST_SAMPLES {
                continue;
            }
            let n = y.len() as f64;
            let mean = y.iter().sum::<f64>() / n;
            let variance = y.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n;
            found.center.push(low + (bin as f64 + 0.5) * width);
            found.mean.push(mean);
            found.std.push(variance.sqrt());
            let at = found.center.len() - 1;
            match (found.runs.last_mut(), last) {
                (Some(run), Some(last)) if bin <= last + 2 => run.end = at + 1,
                _ => found.runs.push(at..at + 1),
            }
            last = Some(bin);
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bins_hold_mean_and_deviation() {
        // Five samples below 1 with mean 2 and deviation √2, three above: too few.
        let x = [0.0, 0.1, 0.2, 0.3, 0.4, 1.8, 1.9, 2.0];
        let y = [0.0, 1.0, 2.0, 3.0, 4.0, 9.0, 9.0, 9.0];
        let bins = Bins::of(&x, &y, 2);
        assert_eq!((bins.center, bins.mean), (vec![0.5], vec![2.0]));
        assert!((bins.std[0] - 2.0_f64.sqrt()).abs() < 1e-15);
    }

    #[test]
    fn a_gap_interrupts_a_curve() {
        // Bins 0, 2 and 3 hold samples, 4 to 7 none, 8 and 9 do.
        let x: Vec<f64> = [0.5, 2.5, 3.5, 8.5, 9.5, 0.0, 10.0]
            .iter()
            .flat_map(|x| [*x; 6])
            .collect();
        let bins = Bins::of(&x, &x, 10);
        assert_eq!(bins.runs, [0..3, 3..5]);
    }
}
