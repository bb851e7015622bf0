//! Delay of a signal behind a linear combination of others, y(t) ≈ X(t − d) β, with its deviation.
//!
//! The columns are shifted, never the target: interpolating a noisy target between its samples takes noise away, and
//! a search over d would find that. Columns are smooth; they go through a cubic B-spline (Unser 1999), whose shift by any
//! d is exact. At each d the coefficients β are fitted anew. The deviation comes from leaving blocks of time
//! out (block jackknife): it holds for residuals that are correlated within a block, and for models that are not exact.

use std::ops::Range;

/// Columns and target on uniform grids, segment by segment.
#[derive(Clone, Debug, Default)]
pub struct System {
    /// Columns, each over all rows.
    pub columns: Vec<Vec<f64>>,
    /// Target over all rows.
    pub target: Vec<f64>,
    /// Rows that follow each other.
    pub segments: Vec<Range<usize>>,
    /// Time between the rows of each segment, s.
    pub steps: Vec<f64>,
}

/// Where to look.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Search {
    /// Smallest and largest delay, s. A minimum at either end is none.
    pub range: [f64; 2],
    /// Distance of the delays tried before the best is refined, s.
    pub spacing: f64,
    /// Shortest block of the jackknife, s.
    pub block: f64,
}

impl Search {
    /// The delays tried before the best is refined, ends included.
    fn tries(&self) -> impl Iterator<Item = f64> + use<> {
        let [low, high] = self.range;
        let count = ((high - low) / self.spacing).ceil().max(1.0) as usize;
        (0..=count).map(move |k| low + k as f64 * (high - low) / count as f64)
    }
}

impl Default for Search {
    fn default() -> Self {
        Self {
            range: [-0.06, 0.2],
            spacing: 0.01,
            block: 1.0,
        }
    }
}

/// A delay with everything needed to judge it.
#[derive(Clone, Debug, PartialEq)]
pub struct Delay {
    /// Target behind columns, s.
    pub delay: f64,
    /// Its standard deviation, s.
    pub std: f64,
    /// Number of blocks behind `std`.
    pub blocks: usize,
    /// Coefficients at that delay.
    pub coefficients: Vec<f64>,
    /// Residual sum of squares at that delay over that without delay.
    pub left: f64,
    /// Σ of the squared change of the fitted target with the delay, that no coefficient can imitate, over the residual sum
    /// of squares, 1/s².
    pub information: f64,
}

impl Delay {
    /// Interval of 95 %: Student's quantile of the number of blocks.
    pub fn interval(&self) -> [f64; 2] {
        let half = student_975(self.blocks.saturating_sub(1)) * self.std;
        [self.delay - half, self.delay + half]
    }
}

/// The value that Student's t with `dof` degrees of freedom exceeds with a chance of 2.5 % (Cornish and Fisher's
/// expansion, exact below four).
pub fn student_975(dof: usize) -> f64 {
    match dof {
        0 => f64::INFINITY,
        1 => 12.706,
        2 => 4.303,
        3 => 3.182,
        _ => {
            let (z, n) = (1.959_963_985_f64, dof as f64);
            let g1 = (z.powi(3) + z) / 4.0;
            let g2 = (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / 96.0;
            let g3 = (3.0 * z.powi(7) + 19.0 * z.powi(5) + 17.0 * z.powi(3) - 15.0 * z) / 384.0;
            z + g1 / n + g2 / (n * n) + g3 / n.powi(3)
        }
    }
}

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

/// Products of columns (with the target last) over some rows.
type Products = Vec<f64>;

/// A system whose columns can be shifted.
struct Shifted<'a> {
    system: &'a System,
    splines: Vec<Vec<f64>>,
    /// Rows at which every shift of the search stays within its segment, with the segment's step.
    rows: Vec<(Range<usize>, f64)>,
}

impl<'a> Shifted<'a> {
    fn new(system: &'a System, search: &Search) -> Option<Self> {
        let mut rows = Vec::new();
        for (segment, &step) in system.segments.iter().zip(&system.steps) {
            let before = (search.range[1].max(0.0) / step).ceil() as usize + 2;
            let after = (-search.range[0].min(0.0) / step).ceil() as usize + 2;
            if segment.len() > before + after {
                rows.push((segment.start + before..segment.end - after, step));
            }
        }
        let count: usize = rows.iter().map(|(r, _)| r.len()).sum();
        if count < 3 * (system.columns.len() + 1) {
            return None;
        }
        let spline = |column: &Vec<f64>| -> Vec<f64> {
            let mut out = vec![0.0; column.len()];
            for s in &system.segments {
                out[s.clone()].copy_from_slice(&b_spline(&column[s.clone()]));
            }
            out
        };
        Some(Self {
            system,
            splines: system.columns.iter().map(spline).collect(),
            rows,
        })
    }

    /// Values (and, with `slope`, derivatives by time) of all columns at the rows less `delay`, row by row.
    fn columns(&self, delay: f64, slope: bool) -> Vec<f64> {
        let p = self.splines.len();
        let mut out = vec![0.0; p * self.rows.iter().map(|(r, _)| r.len()).sum::<usize>()];
        let mut at = 0;
        for (rows, step) in &self.rows {
            let place = -delay / step;
            let (whole, part) = (place.floor() as isize, place - place.floor());
            let w = if slope {
                slopes(part).map(|w| w / step)
            } else {
                weights(part)
            };
            for row in rows.clone() {
                let first = (row as isize + whole - 1) as usize;
                for (value, c) in out[at..at + p].iter_mut().zip(&self.splines) {
                    let c = &c[first..first + 4];
                    *value = w[0] * c[0] + w[1] * c[1] + w[2] * c[2] + w[3] * c[3];
                }
                at += p;
            }
        }
        out
    }

    fn target(&self) -> impl Iterator<Item = f64> + '_ {
        let rows = self.rows.iter().flat_map(|(r, _)| r.clone());
        rows.map(|row| self.system.target[row])
    }

    /// Residual sum of squares at a delay.
    fn error(&self, delay: f64) -> f64 {
        let p = self.splines.len();
        let x = self.columns(delay, false);
        let mut sums = vec![0.0; (p + 1) * (p + 1)];
        for (row, y) in x.chunks(p).zip(self.target()) {
            add_row(&mut sums, row, y);
        }
        fitted(&sums, p).1
    }

    /// The delay with its deviation: one Gauss–Newton step about it with each block left out.
    fn judged(&self, delay: f64, shortest: f64) -> Option<Delay> {
        let p = self.splines.len();
        let x = self.columns(delay, false);
        let slope = self.columns(delay, true);
        let mut sums = vec![0.0; (p + 1) * (p + 1)];
        for (row, y) in x.chunks(p).zip(self.target()) {
            add_row(&mut sums, row, y);
        }
        let (coefficients, left) = fitted(&sums, p);
        // ∂(Xβ)/∂d beside the columns.
        let lines: Vec<(Vec<f64>, f64)> = x
            .chunks(p)
            .zip(slope.chunks(p))
            .zip(self.target())
            .map(|((row, slope), y)| {
                let change = -dot(slope, &coefficients);
                let line: Vec<f64> = row.iter().copied().chain([change]).collect();
                (line, y)
            })
            .collect();
        let residual: Vec<f64> = lines
            .iter()
            .map(|(line, y)| y - dot(&line[..p], &coefficients))
            .collect();
        let score: Vec<f64> = residual
            .iter()
            .zip(&lines)
            .map(|(e, (l, _))| e * l[p])
            .collect();
        let mut blocks = Vec::new();
        let mut start = 0;
        for (rows, step) in &self.rows {
            let own = start..start + rows.len();
            let time = correlation_time(&[&residual[own.clone()], &score[own.clone()]]) * step;
            let size = shortest.max(4.0 * time) / step;
            // Eight blocks at least, however correlated: then the quantile is what is wide.
            let most = (rows.len() as f64 / (size.max(1.0))).round().max(1.0) as usize;
            let count = if self.rows.len() < 8 {
                most.max(8usize.div_ceil(self.rows.len()))
            } else {
                most
            };
            for k in 0..count {
                let cut = |k: usize| own.start + k * rows.len() / count;
                blocks.push(cut(k)..cut(k + 1));
            }
            start = own.end;
        }
        let of = |rows: Range<usize>| -> Products {
            let mut sums = vec![0.0; (p + 2) * (p + 2)];
            for (line, y) in &lines[rows] {
                add_row(&mut sums, line, *y);
            }
            sums
        };
        let parts: Vec<Products> = blocks.into_iter().map(of).collect();
        let mut whole = vec![0.0; (p + 2) * (p + 2)];
        for part in &parts {
            whole.iter_mut().zip(part).for_each(|(w, v)| *w += v);
        }
        let (_, with) = fitted(&whole, p + 1);
        let own = own_part(&whole, p + 1);
        let size = whole[p * (p + 2) + p];
        if own.is_nan() || own <= 1e-9 * size || size <= 0.0 {
            return None;
        }
        let steps: Vec<f64> = parts
            .iter()
            .map(|part| {
                let rest: Products = whole.iter().zip(part).map(|(w, v)| w - v).collect();
                fitted(&rest, p + 1).0[p]
            })
            .collect();
        let n = steps.len() as f64;
        let mean = steps.iter().sum::<f64>() / n;
        let spread: f64 = steps.iter().map(|s| (s - mean).powi(2)).sum();
        let std = ((n - 1.0) / n * spread).sqrt();
        let without = self.error(0.0);
        (std.is_finite() && with.is_finite()).then_some(Delay {
            delay,
            std,
            blocks: steps.len(),
            coefficients,
            left: left / without.max(f64::MIN_POSITIVE),
            information: own / left.max(f64::MIN_POSITIVE),
        })
    }
}

/// Adds the products of one row to the upper triangle.
fn add_row(sums: &mut [f64], row: &[f64], y: f64) {
    let p = row.len();
    for i in 0..p {
        let line = &mut sums[i * (p + 1) + i..(i + 1) * (p + 1)];
        for (sum, v) in line.iter_mut().zip(row[i..].iter().chain([&y])) {
            *sum += row[i] * v;
        }
    }
    sums[p * (p + 1) + p] += y * y;
}

/// Ridge of columns of unit norm: holds what the rows do not show.
const RIDGE: f64 = 1e-9;

/// Cholesky factor Rᵀ (by rows) of the scaled normal equations of the first `p` columns, with the scales.
fn factor(sums: &[f64], p: usize) -> (Vec<f64>, Vec<f64>) {
    let width = (sums.len() as f64).sqrt() as usize;
    let at = |i: usize, j: usize| sums[i.min(j) * width + i.max(j)];
    let scale: Vec<f64> = (0..p)
        .map(|i| if at(i, i) > 0.0 { at(i, i).sqrt() } else { 1.0 })
        .collect();
    let mut l = vec![0.0; p * p];
    for i in 0..p {
        for j in 0..=i {
            let dot: f64 = (0..j).map(|k| l[i * p + k] * l[j * p + k]).sum();
            let own = at(i, j) / (scale[i] * scale[j]);
            l[i * p + j] = if i == j {
                (own + RIDGE - dot).max(RIDGE).sqrt()
            } else {
                (own - dot) / l[j * p + j]
            };
        }
    }
    (l, scale)
}

/// Least squares of the last column by the others: coefficients and residual sum of squares.
fn fitted(sums: &[f64], p: usize) -> (Vec<f64>, f64) {
    let (l, scale) = factor(sums, p);
    let width = p + 1;
    let mut x: Vec<f64> = (0..p).map(|i| sums[i * width + p] / scale[i]).collect();
    for i in 0..p {
        let done: f64 = (0..i).map(|k| l[i * p + k] * x[k]).sum();
        x[i] = (x[i] - done) / l[i * p + i];
    }
    for i in (0..p).rev() {
        let done: f64 = (i + 1..p).map(|k| l[k * p + i] * x[k]).sum();
        x[i] = (x[i] - done) / l[i * p + i];
    }
    let x: Vec<f64> = x.iter().zip(&scale).map(|(x, s)| x / s).collect();
    let mut left = sums[p * width + p];
    for i in 0..p {
        left -= 2.0 * x[i] * sums[i * width + p];
        for j in 0..p {
            left += x[i] * x[j] * sums[i.min(j) * width + i.max(j)];
        }
    }
    (x, left.max(0.0))
}

/// Sum of squares of the last of the first `p` columns that the others leave.
fn own_part(sums: &[f64], p: usize) -> f64 {
    let (l, scale) = factor(sums, p);
    (l[p * p - 1] * scale[p - 1]).powi(2)
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Longest integrated correlation time of some signals, in samples: 1 + 2 Σ ρ_k up to the first ρ below 0.05.
pub fn correlation_time(signals: &[&[f64]]) -> f64 {
    let one = |x: &[f64]| {
        let n = x.len();
        let mean = x.iter().sum::<f64>() / n.max(1) as f64;
        let product = |k: usize| -> f64 {
            x.iter()
                .zip(&x[k..])
                .map(|(a, b)| (a - mean) * (b - mean))
                .sum()
        };
        let whole = product(0);
        let mut time = 1.0;
        if whole > 0.0 {
            for k in 1..n / 4 {
                let r = product(k) / whole;
                if r < 0.05 {
                    break;
                }
                time += 2.0 * r;
            }
        }
        time
    };
    signals.iter().map(|x| one(x)).fold(1.0, f64::max)
}

/// Weights of the four coefficients about a point a part `t` after the second of them.
fn weights(t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    [
        s * s * s / 6.0,
        (4.0 - 6.0 * t * t + 3.0 * t * t * t) / 6.0,
        (4.0 - 6.0 * s * s + 3.0 * s * s * s) / 6.0,
        t * t * t / 6.0,
    ]
}

/// Their derivatives by `t`.
fn slopes(t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    [
        -0.5 * s * s,
        -2.0 * t + 1.5 * t * t,
        2.0 * s - 1.5 * s * s,
        0.5 * t * t,
    ]
}

/// Coefficients of the cubic B-spline through a uniformly sampled signal, mirrored at its ends.
fn b_spline(x: &[f64]) -> Vec<f64> {
    let pole = 3.0_f64.sqrt() - 2.0;
    let n = x.len();
    if n < 2 {
        return x.to_vec();
    }
    let mut c: Vec<f64> = x.iter().map(|v| 6.0 * v).collect();
    // The pole's powers fall below the last digit after 30 samples.
    let mut power = 1.0;
    let mut first = 0.0;
    for v in c.iter().take(30) {
        first += power * v;
        power *= pole;
    }
    c[0] = first;
    for k in 1..n {
        c[k] += pole * c[k - 1];
    }
    c[n - 1] = pole / (pole * pole - 1.0) * (c[n - 1] + pole * c[n - 2]);
    for k in (0..n - 1).rev() {
        c[k] = pole * (c[k + 1] - c[k]);
    }
    c
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
