//! Orders of torque that is periodic in a joint's position, found in the physics' residual.
//!
//! A motor's poles and a gear's teeth make torque that repeats with the position, at orders that no description
//! of the robot gives. They show as lines in the residual's spectrum over position.

use crate::identify::selection::ForwardOptions;
use ndarray::{Array2, ArrayView1};
use rayon::prelude::*;
use signal::cholesky;
use std::f64::consts::TAU;

/// Largest number of waves of a joint.
const MOST: usize = 4;
/// Periods over the range of a joint's motion: fewest, with which a wave differs from a slow curve, and most that are
/// searched.
const PERIODS: [f64; 2] = [3.0, 200.0];
/// Number of bins of position in the shortest period.
const BINS: f64 = 16.0;
/// Number of search steps in the width of a line, which is one period over the range.
const STEPS: f64 = 8.0;
/// Number of passes in which each wave is fitted again without the others.
const PASSES: usize = 3;
/// Degree of the slow curve over position that is removed first, since its edges would pass for waves.
const SLOW: usize = 3;
/// Conditions for a wave: on folds left out, as for terms of friction, but stricter, since hundreds of orders are tried.
const TAKEN: ForwardOptions = ForwardOptions {
    least_gain: 0.01,
    standard_errors: 2.0,
    most: MOST,
    ridge: 0.0,
};

/// Sample of a joint in motion.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    /// Position of the joint, rad or m.
    pub position: f64,
    /// Residual torque of the physics, N·m (N).
    pub left: f64,
    /// Index of the fold that the sample belongs to.
    pub fold: usize,
}

/// Number of columns of a fit: cosine and sine, then the slow curve. Without that, over unevenly covered
/// positions, a slow curve would pass for a wave.
const COLUMNS: usize = 2 + SLOW + 1;

/// Sums of products of the columns with each other (lower triangle), and with the residual.
type Products = ([f64; COLUMNS * COLUMNS], [f64; COLUMNS]);

/// Sums over bins of position, by fold.
#[derive(Clone)]
struct Binned {
    /// Centre of each bin, rad or m.
    position: Vec<f64>,
    /// Values of the slow curve's functions at the centres of the bins.
    slow: Vec<[f64; SLOW + 1]>,
    /// Number of samples, shape (folds, bins).
    count: Array2<f64>,
    /// Sum of the residuals, shape (folds, bins).
    sum: Array2<f64>,
    /// Sum of squared residuals, by fold.
    squares: Vec<f64>,
}

/// Orders (periods per 2π of position, or per 2π m) of the waves up to `highest`, strongest first; none with
/// fewer than two folds.
pub fn orders(seen: &[Seen], highest: f64) -> Vec<f64> {
    let folds = seen.iter().map(|s| s.fold + 1).max().unwrap_or(0);
    let ends = seen
        .iter()
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], s| {
            [a.min(s.position), b.max(s.position)]
        });
    let span = ends[1] - ends[0];
    if folds < 2 || span.is_nan() || span <= 0.0 {
        return Vec::new();
    }
    let fresh = Binned::new(&level(seen, ends), folds, ends);
    let mut binned = fresh.clone();
    let period = TAU / span;
    let count = ((PERIODS[1] - PERIODS[0]) * STEPS) as usize;
    let mut found = Vec::new();
    let grid: Vec<f64> = (0..count)
        .map(|k| period * (PERIODS[0] + k as f64 / STEPS))
        .collect();
    let normals: Vec<Vec<[f64; COLUMNS * COLUMNS]>> =
        grid.par_iter().map(|&order| fresh.normals(order)).collect();
    while found.len() < MOST {
        let before = binned.squares.clone();
        let gain = |after: Vec<f64>| before.iter().sum::<f64>() - after.iter().sum::<f64>();
        let lines: Vec<Vec<Products>> = grid
            .par_iter()
            .zip(&normals)
            .map(|(&order, normals)| binned.with_moments(order, normals))
            .collect();
        let strongest = |of: &dyn Fn(&[Products]) -> f64| {
            let tried = lines
                .iter()
                .zip(&grid)
                .map(|(line, &order)| (of(line), order));
            tried
                .max_by(|a, b| a.0.total_cmp(&b.0))
                .map(|(_, order)| order)
        };
        let Some(mut order) = strongest(&|line| gain(binned.left(line))) else {
            break;
        };
        // A wave is there in either half of the folds alone; the highest of hundreds of lines of noise is not.
        let again = (0..2).all(|half| {
            let own = |line: &[Products]| explained(line.iter().skip(half).step_by(2));
            strongest(&own).is_some_and(|o| (o - order).abs() <= period)
        });
        order = binned.refined(order, period);
        if !again || !TAKEN.falls(&before, &binned.left(&binned.products(order))) {
            break;
        }
        found.push(order);
        // Over positions that a motion sees unevenly waves leak into each other: each is placed again without the others.
        for _ in 0..PASSES {
            for i in 0..found.len() {
                let others = found.iter().enumerate().filter(|(k, _)| *k != i);
                let rest = fresh.without(others.map(|(_, o)| *o));
                found[i] = rest.refined(found[i], period);
            }
        }
        binned = fresh.without(found.iter().copied());
    }
    // One beyond is there, and would be taken for its shadows below; but it is nothing to foretell.
    found.retain(|&order| order <= highest);
    found
}

/// Samples with a slow curve over position removed.
fn level(seen: &[Seen], [low, high]: [f64; 2]) -> Vec<Seen> {
    const N: usize = SLOW + 1;
    let basis = |position: f64| chebyshev(position, [low, high]);
    let (mut normal, mut moment) = ([0.0; N * N], [0.0; N]);
    for s in seen {
        let row = basis(s.position);
        for i in 0..N {
            moment[i] += row[i] * s.left;
            for k in 0..N {
                normal[N * i + k] += row[i] * row[k];
            }
        }
    }
    match cholesky::factor(&mut normal, N) {
        Some(()) => cholesky::solve(&normal, &mut moment),
        None => moment = [0.0; N],
    }
    let curve = |position| -> f64 {
        basis(position)
            .iter()
            .zip(&moment)
            .map(|(a, b)| a * b)
            .sum()
    };
    let level = |s: &Seen| Seen {
        left: s.left - curve(s.position),
        ..*s
    };
    seen.iter().map(level).collect()
}

/// Chebyshev polynomials over a range, at a position.
fn chebyshev(position: f64, [low, high]: [f64; 2]) -> [f64; SLOW + 1] {
    let place = (2.0 * position - low - high) / (high - low);
    let angle = place.clamp(-1.0, 1.0).acos();
    std::array::from_fn(|k| (k as f64 * angle).cos())
}

impl Binned {
    fn new(seen: &[Seen], folds: usize, [low, high]: [f64; 2]) -> Self {
        let bins = (PERIODS[1] * BINS) as usize;
        let width = (high - low) / bins as f64;
        let position: Vec<f64> = (0..bins).map(|b| low + (b as f64 + 0.5) * width).collect();
        let slow = position.iter().map(|&q| chebyshev(q, [low, high]));
        let mut made = Self {
            slow: slow.collect(),
            position,
            count: Array2::zeros((folds, bins)),
            sum: Array2::zeros((folds, bins)),
            squares: vec![0.0; folds],
        };
        for s in seen {
            let bin = (((s.position - low) / width) as usize).min(bins - 1);
            made.count[[s.fold, bin]] += 1.0;
            made.sum[[s.fold, bin]] += s.left;
            made.squares[s.fold] += s.left * s.left;
        }
        made
    }

    /// Columns of a wave of one order in each bin.
    fn columns(&self, order: f64) -> impl Iterator<Item = [f64; COLUMNS]> {
        let each = self.position.iter().zip(&self.slow);
        each.map(move |(q, slow)| {
            let (sin, cos) = (order * q).sin_cos();
            std::array::from_fn(|k| match k {
                0 => cos,
                1 => sin,
                _ => slow[k - 2],
            })
        })
    }

    /// Sums of products for one order, by fold.
    fn products(&self, order: f64) -> Vec<Products> {
        self.with_moments(order, &self.normals(order))
    }

    /// Sums of products of the columns with each other, by fold; they do not depend on the residual.
    fn normals(&self, order: f64) -> Vec<[f64; COLUMNS * COLUMNS]> {
        let columns: Vec<[f64; COLUMNS]> = self.columns(order).collect();
        let of = |count: ArrayView1<f64>| {
            let mut normal = [0.0; COLUMNS * COLUMNS];
            for (column, &n) in columns.iter().zip(count).filter(|(_, n)| **n > 0.0) {
                for i in 0..COLUMNS {
                    for k in 0..=i {
                        normal[COLUMNS * i + k] += n * column[i] * column[k];
                    }
                }
            }
            for i in 0..COLUMNS {
                for k in 0..i {
                    normal[COLUMNS * k + i] = normal[COLUMNS * i + k];
                }
            }
            normal
        };
        self.count.rows().into_iter().map(of).collect()
    }

    /// Sums of products of the columns of one order, these binned ones with the residual included, by fold.
    fn with_moments(&self, order: f64, normals: &[[f64; COLUMNS * COLUMNS]]) -> Vec<Products> {
        let columns: Vec<[f64; COLUMNS]> = self.columns(order).collect();
        let of = |(sum, normal): (ArrayView1<f64>, &[f64; COLUMNS * COLUMNS])| {
            let mut moment = [0.0; COLUMNS];
            for (column, &s) in columns.iter().zip(sum).filter(|(_, s)| **s != 0.0) {
                moment.iter_mut().zip(column).for_each(|(m, c)| *m += c * s);
            }
            (*normal, moment)
        };
        self.sum.rows().into_iter().zip(normals).map(of).collect()
    }

    /// Squared error of each fold after removal of the wave fitted to the other folds.
    fn left(&self, line: &[Products]) -> Vec<f64> {
        let change = |fold: usize| {
            let others = line.iter().enumerate().filter(|(f, _)| *f != fold);
            let x = solved(sum(others.map(|(_, p)| p)));
            let (normal, moment) = &line[fold];
            let mut square = self.squares[fold];
            for i in 0..COLUMNS {
                square -= 2.0 * x[i] * moment[i];
                for k in 0..COLUMNS {
                    square += x[i] * x[k] * normal[COLUMNS * i + k];
                }
            }
            square
        };
        (0..line.len()).map(change).collect()
    }

    /// Order near another one at which a wave removes most error.
    fn refined(&self, mut order: f64, period: f64) -> f64 {
        for finer in [STEPS * 4.0, STEPS * 16.0, STEPS * 64.0] {
            let near = (-4..=4).map(|k| order + period * f64::from(k) / finer);
            let left = |o: f64| self.left(&self.products(o)).iter().sum::<f64>();
            let best = near
                .map(|o| (left(o), o))
                .min_by(|a, b| a.0.total_cmp(&b.0));
            order = best.map_or(order, |(_, o)| o);
        }
        order
    }

    /// Sums with some waves removed.
    fn without(&self, orders: impl Iterator<Item = f64>) -> Self {
        let mut rest = self.clone();
        orders.for_each(|order| rest.remove(order));
        rest
    }

    /// Removes the wave fitted to all folds.
    fn remove(&mut self, order: f64) {
        let line = self.products(order);
        self.squares = self.left(&line);
        let x = solved(sum(line.iter()));
        let wave: Vec<f64> = self
            .columns(order)
            .map(|column| column.iter().zip(&x).map(|(c, x)| c * x).sum())
            .collect();
        for (bin, wave) in wave.into_iter().enumerate() {
            for fold in 0..self.count.nrows() {
                self.sum[[fold, bin]] -= self.count[[fold, bin]] * wave;
            }
        }
    }
}

fn sum<'a>(of: impl Iterator<Item = &'a Products>) -> Products {
    let (mut normal, mut moment) = ([0.0; COLUMNS * COLUMNS], [0.0; COLUMNS]);
    for (n, m) in of {
        normal.iter_mut().zip(n).for_each(|(a, b)| *a += b);
        moment.iter_mut().zip(m).for_each(|(a, b)| *a += b);
    }
    (normal, moment)
}

/// Least-squares coefficients of the columns; zeros where the columns are linearly dependent.
fn solved((mut normal, mut moment): Products) -> [f64; COLUMNS] {
    match cholesky::factor(&mut normal, COLUMNS) {
        Some(()) => cholesky::solve(&normal, &mut moment),
        None => moment = [0.0; COLUMNS],
    }
    moment
}

/// Sum of squares that a wave fitted to some folds explains on them.
fn explained<'a>(folds: impl Iterator<Item = &'a Products>) -> f64 {
    let all = sum(folds);
    let moment = all.1;
    solved(all).iter().zip(moment).map(|(x, m)| x * m).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    fn samples(torque: impl Fn(f64) -> f64) -> Vec<Seen> {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        (0..30_000)
            .map(|k| {
                let position = 2.0 * (0.0137 * k as f64).sin();
                Seen {
                    position,
                    left: torque(position) + rng.random_range(-1.0..1.0),
                    fold: k / 5000,
                }
            })
            .collect()
    }

    #[test]
    fn two_waves_are_found_and_no_third() {
        let found = orders(
            &samples(|q| 0.5 * (12.3 * q + 0.7).sin() + 0.2 * (33.2 * q + 2.0).cos()),
            300.0,
        );
        assert_eq!(found.len(), 2, "{found:?}");
        let waves = samples(|q| (33.2 * q).cos());
        assert_eq!(orders(&waves, 30.0), Vec::<f64>::new());
        assert!(
            (found[0] - 12.3).abs() < 0.02 && (found[1] - 33.2).abs() < 0.05,
            "{found:?}"
        );
    }

    #[test]
    fn noise_and_slow_curves_have_none() {
        assert_eq!(orders(&samples(|_| 0.0), 300.0), Vec::<f64>::new());
        assert_eq!(orders(&samples(|q| 0.5 * q), 300.0), Vec::<f64>::new());
        assert_eq!(orders(&[], 300.0), Vec::<f64>::new());
    }
}
