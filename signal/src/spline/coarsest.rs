//! Splines through rounded values: the coarsest one that rounds to them.

use super::{BSpline, Banded, MAX_DEGREE, Spline, SplineError, check, clamped};

/// Variance of an error that is evenly spread over one unit.
const EVEN_SPREAD: f64 = 1.0 / 12.0;

impl Spline {
    /// Quintic spline near values that were rounded to multiples of `rounding`: that of the fewest even pieces whose mean
    /// square distance from the values is that of rounding, rounding²/12. `still` is the number of derivatives that vanish
    /// at either end, first and last: 0, 1 or 2.
    ///
    /// Second differences of rounded values are noise where samples are dense. A piece averages over its samples, and there
    /// are no more pieces than the digits can tell. So a short motion keeps its content, whatever its length. Samples beside
    /// equal ones are not counted in the mean: where the values stand still, rounding leaves no error.
    ///
    /// Where no fewer pieces do, or without rounding, it goes through the values: [`Spline::quintic`].
    ///
    /// # Errors
    /// Fewer than 6 samples, times that do not increase.
    pub fn coarsest(
        time: &[f64],
        values: &[f64],
        still: [usize; 2],
        rounding: f64,
    ) -> Result<Self, SplineError> {
        check(time, values, MAX_DEGREE + 1)?;
        let still = still.map(|s| s.min(2));
        let allowed = EVEN_SPREAD * rounding * rounding;
        let fit = |pieces: usize| {
            let fitted = fitted(time, values, still, pieces)?;
            (misfit(&fitted, time, values) <= allowed).then_some(fitted)
        };
        // Coefficients that are left have to be fewer than the samples.
        let most = (time.len() + still[0] + still[1]).saturating_sub(MAX_DEGREE + 1);
        let (mut fails, mut holds, mut best) = (0, most + 1, None);
        let mut next = 1;
        while holds - fails > 1 {
            match fit(next) {
                Some(spline) => (holds, best) = (next, Some(spline)),
                None => fails = next,
            }
            next = if best.is_some() {
                fails.midpoint(holds)
            } else {
                (2 * next).min(most)
            };
        }
        match best {
            Some(spline) => Ok(Self::with_derivatives(spline)),
            None => Self::quintic(time, values),
        }
    }
}

/// Least squares on `pieces` even pieces; none where samples leave a piece undetermined.
fn fitted(time: &[f64], values: &[f64], still: [usize; 2], pieces: usize) -> Option<BSpline> {
    let (first, span) = (time[0], time[time.len() - 1] - time[0]);
    let inner: Vec<f64> = (1..pieces)
        .map(|k| first + span * k as f64 / pieces as f64)
        .collect();
    let all = pieces + MAX_DEGREE;
    let mut spline = BSpline {
        knots: clamped(time, &inner, MAX_DEGREE),
        coefficients: Vec::new(),
        degree: MAX_DEGREE,
        parent: MAX_DEGREE,
    };
    // At an end where k derivatives vanish, the first k + 1 coefficients are equal: one unknown.
    let unknown = |coefficient: usize| coefficient.clamp(still[0], all - 1 - still[1]) - still[0];
    let size = all - still[0] - still[1];
    let mut system = Banded::new(size, MAX_DEGREE);
    let mut right = vec![0.0; size];
    for (&t, value) in time.iter().zip(values) {
        let piece = spline.piece_among(t, all);
        let basis = spline.basis(t, piece);
        let own = |k: usize| unknown(piece - MAX_DEGREE + k);
        for (i, a) in basis.iter().enumerate() {
            right[own(i)] += a * (value - values[0]);
            for (j, b) in basis.iter().enumerate() {
                system.add(own(i), own(j), a * b);
            }
        }
    }
    let solved = system.solve(right);
    let coefficients = (0..all).map(|c| values[0] + solved[unknown(c)]);
    spline.coefficients = coefficients.collect();
    spline
        .coefficients
        .iter()
        .all(|c| c.is_finite())
        .then_some(spline)
}

/// Mean square distance from the values, over samples that differ from a neighbour.
fn misfit(spline: &BSpline, time: &[f64], values: &[f64]) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0_f64);
    for (i, &t) in time.iter().enumerate() {
        let near = &values[i.saturating_sub(1)..(i + 2).min(values.len())];
        if near.iter().any(|v| *v != values[i]) {
            sum += (spline.evaluate(t, spline.piece(t)) - values[i]).powi(2);
            count += 1.0;
        }
    }
    sum / count.max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Largest error of the acceleration, as a part of its largest value.
    fn worst(
        motion: impl Fn(f64) -> [f64; 2],
        period: f64,
        still: [usize; 2],
        rounding: f64,
    ) -> f64 {
        let time: Vec<f64> = (0..=(2.0 / period).round() as usize)
            .map(|k| k as f64 * period)
            .collect();
        let values: Vec<f64> = time
            .iter()
            .map(|t| (motion(*t)[0] / rounding).round() * rounding)
            .collect();
        let spline = Spline::coarsest(&time, &values, still, rounding).unwrap();
        let (mut error, mut largest) = (0.0_f64, 0.0_f64);
        for &t in &time {
            let truth = motion(t)[1];
            error = error.max((spline.at(t)[2] - truth).abs());
            largest = largest.max(truth.abs());
        }
        error / largest
    }

    #[test]
    fn accelerations_of_rounded_values_up_to_the_ends() {
        let sine = |t: f64| [(3.0 * t + 0.4).sin(), -9.0 * (3.0 * t + 0.4).sin()];
        // From rest, with an acceleration from the first sample on; and from rest in third order.
        let turn = |t: f64| [1.0 - (3.0 * t).cos(), 9.0 * (3.0 * t).cos()];
        let soft = |t: f64| [3.0 * t - (3.0 * t).sin(), 9.0 * (3.0 * t).sin()];
        for period in [0.01, 0.001] {
            for rounding in [1e-6, 1e-5] {
                assert!(worst(sine, period, [0, 0], rounding) < 0.03);
                assert!(worst(turn, period, [1, 0], rounding) < 0.03);
                assert!(worst(soft, period, [2, 0], rounding) < 0.03);
            }
        }
    }

    #[test]
    fn derivatives_that_vanish_do() {
        let time: Vec<f64> = (0..200).map(|k| f64::from(k) * 0.01).collect();
        let values: Vec<f64> = time
            .iter()
            .map(|t| (t.powi(3) * 1e4).round() * 1e-4)
            .collect();
        let spline = Spline::coarsest(&time, &values, [2, 0], 1e-4).unwrap();
        let [_, speed, turn] = spline.at(0.0);
        assert!(speed.abs() < 1e-9 && turn.abs() < 1e-9, "{speed} {turn}");
        // 3 t² and 6 t at the other end.
        let [_, speed, turn] = spline.at(1.99);
        assert!((speed - 11.88).abs() < 0.01 && (turn - 11.94).abs() < 0.1);
    }

    #[test]
    fn exact_values_and_lost_samples() {
        let mut time: Vec<f64> = (0..60).map(|k| f64::from(k) * 0.05).collect();
        let exact = |time: &[f64]| -> Vec<f64> { time.iter().map(|t| t.sin()).collect() };
        let values = exact(&time);
        let through = Spline::coarsest(&time, &values, [0, 0], 0.0).unwrap();
        let quintic = Spline::quintic(&time, &values).unwrap();
        assert_eq!(through.at(1.234), quintic.at(1.234));
        // A pause that leaves pieces without samples.
        time.iter_mut().skip(30).for_each(|t| *t += 20.0);
        let spline = Spline::coarsest(&time, &exact(&time), [0, 0], 1e-9).unwrap();
        assert!((spline.at(1.0)[2] + 1.0_f64.sin()).abs() < 1e-3);
    }
}
