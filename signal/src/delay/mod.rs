//! Delay of a signal behind a linear combination of others, y(t) ≈ X(t − d) β, with its deviation.
//!
//! The columns are shifted, never the target: interpolating a noisy target between its samples takes noise away, and
//! a search over d would find that. Columns are smooth; they go through a cubic B-spline (Unser 1999), whose shift by any
//! d is exact. At each d the coefficients β are fitted anew. The deviation comes from leaving blocks of time
//! out (block jackknife): it holds for residuals that are correlated within a block, and for models that are not exact.

mod cubic;
mod products;
mod shifted;
mod system;

pub use system::{Delay, Search, System, student, student_975};

use shifted::Shifted;

/// The delay of least squared error; `None` where there are too few rows, where the error is least at an end of the
/// search, or where nothing depends on the delay.
pub fn estimate(system: &System, search: &Search) -> Option<Delay> {
    let shifted = Shifted::new(system, search)?;
    let at: Vec<f64> = search.tries().collect();
    let errors: Vec<f64> = at.iter().map(|d| shifted.error(*d)).collect();
    let best = (0..at.len()).min_by(|&a, &b| errors[a].total_cmp(&errors[b]))?;
    if best == 0 || best + 1 == at.len() {
        return None;
    }
    let three = |list: &[f64]| [list[best - 1], list[best], list[best + 1]];
    let delay = refined(&shifted, three(&at), three(&errors));
    shifted.judged(delay, search.block)
}

/// Residual sum of squares at each delay of a search; `None` where there are too few rows.
pub fn profile(system: &System, search: &Search) -> Option<Vec<(f64, f64)>> {
    let shifted = Shifted::new(system, search)?;
    Some(search.tries().map(|d| (d, shifted.error(d))).collect())
}

/// Columns at a delay, row after row, and target of the rows that a search over all delays has in common; `None` where
/// there are too few.
pub fn rows_at(system: &System, delay: f64, search: &Search) -> Option<(Vec<f64>, Vec<f64>)> {
    let shifted = Shifted::new(system, search)?;
    let [low, high] = search.range;
    let rows = shifted.columns(delay.clamp(low, high), false);
    Some((rows, shifted.target().collect()))
}

/// Best delay between three that enclose it, by repeated parabolas.
fn refined(shifted: &Shifted, mut x: [f64; 3], mut e: [f64; 3]) -> f64 {
    for _ in 0..4 {
        let (a, b) = (x[1] - x[0], x[1] - x[2]);
        let (fa, fb) = (e[1] - e[2], e[1] - e[0]);
        let below = a * fa - b * fb;
        let mut next = if below == 0.0 {
            x[1]
        } else {
            x[1] - 0.5 * (a * a * fa - b * b * fb) / below
        };
        // A parabola that finds its old middle has to look aside.
        let aside = 0.02 * (x[2] - x[0]);
        if (next - x[1]).abs() < aside {
            next = if x[2] - x[1] > x[1] - x[0] {
                x[1] + aside
            } else {
                x[1] - aside
            };
        }
        next = next.clamp(x[0] + 1e-9, x[2] - 1e-9);
        let error = shifted.error(next);
        let (low, high) = (next.min(x[1]), next.max(x[1]));
        let (elow, ehigh) = if next < x[1] {
            (error, e[1])
        } else {
            (e[1], error)
        };
        if elow <= ehigh {
            (x, e) = ([x[0], low, high], [e[0], elow, ehigh]);
        } else {
            (x, e) = ([low, high, x[2]], [elow, ehigh, e[2]]);
        }
    }
    x[1]
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use std::f64::consts::TAU;

    fn wave(t: f64) -> f64 {
        (TAU * 0.7 * t).sin() + 0.4 * (TAU * 1.9 * t + 1.0).sin()
    }

    /// A wave behind an offset with an autocorrelated disturbance, 100 Hz.
    fn system(delay: f64, disturbance: f64, seed: u64) -> System {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let time: Vec<f64> = (0..3000).map(|k| f64::from(k) * 0.01).collect();
        let mut drift = 0.0;
        let target = time.iter().map(|t| {
            drift = 0.95 * drift + random.random_range(-1.0..1.0) * disturbance;
            2.0 + 3.0 * wave(t - delay) + drift
        });
        System {
            target: target.collect(),
            columns: vec![
                vec![1.0; time.len()],
                time.iter().map(|&t| wave(t)).collect(),
            ],
            segments: vec![0..1500, 1500..3000],
            steps: vec![0.01; 2],
        }
    }

    #[test]
    fn a_pure_delay_is_found_between_samples() {
        for delay in [-0.031, 0.0, 0.0047, 0.1503] {
            let found = estimate(&system(delay, 0.0, 1), &Search::default()).unwrap();
            assert!((found.delay - delay).abs() < 1e-5, "{delay}: {found:?}");
            assert!((found.coefficients[1] - 3.0).abs() < 1e-3);
        }
    }

    #[test]
    fn intervals_cover_under_correlated_disturbances() {
        let inside = (0..100).filter(|&seed| {
            let found = estimate(&system(0.02, 0.5, seed), &Search::default()).unwrap();
            let [low, high] = found.interval();
            (low..high).contains(&0.02)
        });
        // Of 100 intervals of 95 %, fewer than 89 or all would come by chance once in a hundred.
        let inside = inside.count();
        assert!((89..=100).contains(&inside), "{inside}");
    }

    #[test]
    fn nothing_is_found_where_nothing_depends_on_it() {
        let mut flat = system(0.02, 0.5, 3);
        flat.columns.pop();
        assert_eq!(estimate(&flat, &Search::default()), None);
        // Beyond the search: an end is no estimate.
        assert_eq!(estimate(&system(0.3, 0.0, 1), &Search::default()), None);
    }

    #[test]
    fn quantiles_of_student() {
        for (dof, expected) in [(4, 2.776), (5, 2.571), (7, 2.365), (10, 2.228), (30, 2.042)] {
            assert!((student_975(dof) - expected).abs() < 0.01, "{dof}");
        }
    }
}
