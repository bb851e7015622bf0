//! What a gear's departure from its motor says of its flanks: a spring on either side of a gap, fitted to the motor's torque.
//!
//! The motor carries its own friction and inertia and, through the gear, the link:
//! τ = K·d + K₃·d³ + (D + E·|d|)·ḋ + friction between the teeth + friction and inertia of the motor, d the departure beyond the
//! flanks. All but the flanks' places is linear; they are found by Gauss–Newton steps from several starts. No rigid body is asked, but for
//! the part of the joint's own link that may turn with the motor, which is held near none.

use signal::cholesky;
use signal::correlation::correlation_time;
use signal::quantile::{median, quantile};
use std::ops::Range;

/// Parts of the departure's range that the gap is at first, none last: a spring.
const STARTS: [f64; 4] = [0.1, 0.3, 0.6, 0.85];
/// Most steps from a start.
const STEPS: usize = 14;
/// Radii over which friction between the teeth turns, relative to the deflection's root mean square.
const TEETH: [f64; 2] = [0.1, 0.3];
/// Deviation of the part of the own link's torque that turns with the motor.
const OWN: f64 = 0.1;
/// Length of a block that knows nothing of the next one, s.
const BLOCK: f64 = 3.0;
/// Residuals beyond so many deviations are outliers.
const OUTLIER: f64 = 8.0;
/// Part by which laws that the equation does not have shift a stiffness, and a gap: chosen on seeds 9101 and 9102 of the project's own
/// simulator.
const LAWS: [f64; 2] = [0.04, 0.02];
/// Gain from which a gap is one, nats.
const SEEN: f64 = 10.0;
/// Part of the departure's root mean square below which a gap is a law of the spring that is not quite right.
const LEAST_GAP: f64 = 0.1;

/// Columns that depend on the departure alone.
const GEAR: usize = 4 + TEETH.len();

/// One joint on the fitted rows.
#[derive(Clone, Debug)]
pub(super) struct Rows {
    /// Departure of the link, rad, and its rate.
    pub departure: Vec<f64>,
    pub rate: Vec<f64>,
    /// Velocity, its softened sign, and acceleration of the motor, and ones.
    pub motor: [Vec<f64>; 4],
    /// Torque that the joint's own link alone needs.
    pub own: Vec<f64>,
    /// Measured torque; rows without weight are left out.
    pub torque: Vec<f64>,
    pub counts: Vec<bool>,
    /// Trajectories.
    pub trajectories: Vec<Range<usize>>,
    /// Rows per second.
    pub rate_hz: f64,
}

/// Flanks of a gear.
#[derive(Clone, Copy, Debug)]
pub(super) struct Flanks {
    /// Where they stand, rad; the same where there is no gap.
    pub at: [f64; 2],
    /// Stiffness where they begin, N·m/rad, and its deviation.
    pub stiffness: [f64; 2],
    /// Half of the gap and its deviation; none of a spring.
    pub half_gap: Option<[f64; 2]>,
    /// Inertia that turns with the motor, kg·m².
    pub inertia: f64,
    /// Part of the squared torque beyond what the motor itself takes that the gear accounts for.
    pub explained: f64,
    /// Root mean square of the departure between the flanks and beyond them.
    pub parts: [f64; 2],
}

/// A fit with the flanks in one place.
struct Fit {
    at: [f64; 2],
    coefficients: Vec<f64>,
    residual: Vec<f64>,
    square: f64,
}

impl Rows {
    fn beyond(&self, at: [f64; 2]) -> Vec<f64> {
        let depth = |x: &f64| (x - at[0]).min(0.0) + (x - at[1]).max(0.0);
        self.departure.iter().map(depth).collect()
    }

    /// All columns with the flanks in one place, own link last.
    fn columns(&self, at: [f64; 2]) -> Vec<Vec<f64>> {
        let depth = self.beyond(at);
        let square = depth.iter().map(|d| d * d).sum::<f64>() / depth.len() as f64;
        let spread = square.sqrt().max(1e-12);
        let both = |f: &dyn Fn(f64, f64) -> f64| -> Vec<f64> {
            depth
                .iter()
                .zip(&self.rate)
                .map(|(d, v)| f(*d, *v))
                .collect()
        };
        let touching = |d: f64| if d == 0.0 { 0.0 } else { 1.0 };
        let mut all = vec![
            depth.clone(),
            both(&|d, _| d.powi(3) / (spread * spread)),
            both(&|d, v| touching(d) * v),
            both(&|d, v| d.abs() / spread * v),
        ];
        all.extend(TEETH.map(|radius| self.stop(&depth, radius * spread)));
        all.extend(self.motor.iter().cloned());
        all.push(self.own.clone());
        all
    }

    /// A spring that slips beyond a radius (Prandtl), from −1 to 1.
    fn stop(&self, depth: &[f64], radius: f64) -> Vec<f64> {
        let mut out = vec![0.0; depth.len()];
        for rows in &self.trajectories {
            let mut state = 0.0;
            for i in rows.clone() {
                if i > rows.start {
                    state = (state + depth[i] - depth[i - 1]).clamp(-radius, radius);
                }
                out[i] = state / radius;
            }
        }
        out
    }

    /// Products of some columns and the torque over some rows.
    fn products(&self, columns: &[Vec<f64>], rows: &[usize]) -> Products {
        let n = columns.len();
        let mut own = Products::new(n);
        let mut row = vec![0.0; n];
        for &i in rows.iter().filter(|&&i| self.counts[i]) {
            row.iter_mut().zip(columns).for_each(|(x, c)| *x = c[i]);
            for a in 0..n {
                for b in 0..=a {
                    own.gram[a * n + b] += row[a] * row[b];
                }
                own.right[a] += row[a] * self.torque[i];
            }
        }
        own
    }

    /// Rows cut into blocks.
    fn blocks(&self) -> Vec<Vec<usize>> {
        let length = (BLOCK * self.rate_hz).max(1.0);
        let cut = |rows: &Range<usize>| {
            let (start, all) = (rows.start, rows.len());
            let n = ((all as f64 / length).round() as usize).max(1);
            (0..n).map(move |k| (start + k * all / n..start + (k + 1) * all / n).collect())
        };
        self.trajectories.iter().flat_map(cut).collect()
    }

    /// Fit with the flanks in one place; `tie` is how firmly the own link's part is held at none.
    fn fit(&self, at: [f64; 2], tie: f64) -> Option<Fit> {
        let columns = self.columns(at);
        let all: Vec<usize> = (0..self.torque.len()).collect();
        let coefficients = self
            .products(&columns, &all)
            .solve((columns.len() - 1, tie))?;
        let residual: Vec<f64> = all
            .iter()
            .map(|&i| {
                let each = columns.iter().zip(&coefficients);
                self.torque[i] - each.map(|(c, b)| c[i] * b).sum::<f64>()
            })
            .collect();
        let counted = residual.iter().zip(&self.counts).filter(|r| *r.1);
        let count = self.counts.iter().filter(|c| **c).count().max(1) as f64;
        let square = counted.map(|r| r.0 * r.0).sum::<f64>() / count;
        Some(Fit {
            at,
            coefficients,
            residual,
            square,
        })
    }

    /// Columns by which the torque changes with the places of both flanks, to first order.
    fn moved(&self, fit: &Fit) -> [Vec<f64>; 2] {
        let k = fit.coefficients[0];
        let inside = |beyond: &dyn Fn(f64) -> bool| -> Vec<f64> {
            let one = |x: &f64| if beyond(*x) { -k } else { 0.0 };
            self.departure.iter().map(one).collect()
        };
        [inside(&|x| x < fit.at[0]), inside(&|x| x > fit.at[1])]
    }

    /// The best places of the flanks from a start.
    fn settle(&self, start: [f64; 2], tie: f64) -> Option<Fit> {
        let mut best = self.fit(start, tie)?;
        let all: Vec<usize> = (0..self.torque.len()).collect();
        for _ in 0..STEPS {
            let mut columns = self.columns(best.at);
            let n = columns.len();
            columns.extend(self.moved(&best));
            let solution = self.products(&columns, &all).solve((n - 1, tie));
            let Some(solution) = solution else {
                break;
            };
            let better = [1.0, 0.4, 0.1].into_iter().find_map(|part| {
                let (a, b) = (
                    best.at[0] + part * solution[n],
                    best.at[1] + part * solution[n + 1],
                );
                let fit = self.fit([a.min(b), b.max(a)], tie)?;
                (fit.square < best.square).then_some(fit)
            });
            match better {
                Some(fit) if fit.square < (1.0 - 1e-5) * best.square => best = fit,
                Some(fit) => return Some(fit),
                None => break,
            }
        }
        Some(best)
    }

    /// Deviations of stiffness and half gap: the larger of what blocks left out and the posterior say.
    fn deviations(&self, fit: &Fit, tie: f64, gap: bool, memory: f64) -> Option<[f64; 2]> {
        let mut columns = self.columns(fit.at);
        let n = columns.len();
        if gap {
            columns.extend(self.moved(fit));
        }
        let blocks: Vec<Products> = self
            .blocks()
            .iter()
            .map(|rows| self.products(&columns, rows))
            .collect();
        let mut whole = Products::new(columns.len());
        blocks.iter().for_each(|b| whole.add(b, 1.0));
        let asked = |x: &[f64]| {
            let half = if gap { 0.5 * (x[n + 1] - x[n]) } else { 0.0 };
            [x[0], half]
        };
        let without: Vec<[f64; 2]> = blocks
            .iter()
            .filter_map(|b| {
                let mut rest = whole.clone();
                rest.add(b, -1.0);
                rest.solve((n - 1, tie)).map(|x| asked(&x))
            })
            .collect();
        let count = without.len() as f64;
        if count < 3.0 {
            return None;
        }
        let left_out = [0, 1].map(|k| {
            let mean = without.iter().map(|x| x[k]).sum::<f64>() / count;
            let square = without.iter().map(|x| (x[k] - mean).powi(2)).sum::<f64>();
            ((count - 1.0) / count * square).sqrt()
        });
        let posterior = whole.variance((n - 1, tie), 0)? * fit.square * memory;
        Some([left_out[0].max(posterior.sqrt()), left_out[1]])
    }

    /// Leaves out rows that a fit misses by far.
    fn without_outliers(&mut self, fit: &Fit) {
        let size = median(fit.residual.iter().map(|r| r.abs()).collect()).unwrap_or(0.0);
        let most = OUTLIER * 1.48 * size;
        for (counts, r) in self.counts.iter_mut().zip(&fit.residual) {
            *counts &= r.abs() <= most;
        }
    }
}

/// The flanks that the rows show; none where they show none.
pub(super) fn flanks(mut rows: Rows) -> Option<Flanks> {
    let n = rows.departure.len();
    if n < 20 * (GEAR + 7) {
        return None;
    }
    let middle = rows.departure.iter().sum::<f64>() / n as f64;
    let free = rows.fit([middle; 2], 0.0)?;
    rows.without_outliers(&free);
    let memory = correlation_time(&[&free.residual]);
    // As many squares as the own link's part is worth.
    let tie = free.square * memory / (OWN * OWN);
    let spring = rows.fit([middle; 2], tie)?;
    let ends = [0.01, 0.99].map(|p| quantile(rows.departure.clone(), p).unwrap_or(middle));
    let (centre, range) = (0.5 * (ends[0] + ends[1]), 0.5 * (ends[1] - ends[0]));
    let from = |part: f64| rows.settle([centre - part * range, centre + part * range], tie);
    let settled = STARTS.into_iter().filter_map(from);
    let gap = settled.min_by(|a, b| a.square.total_cmp(&b.square))?;
    let independent = rows.counts.iter().filter(|c| **c).count() as f64 / memory;
    let gain = 0.5 * independent * (spring.square / gap.square).ln();
    let departs = rms(rows.departure.iter().map(|x| x - middle));
    let half = 0.5 * (gap.at[1] - gap.at[0]);
    let has_gap = gain > SEEN && half > LEAST_GAP * departs;
    let fit = if has_gap { gap } else { spring };
    let [stiffness_std, half_std] = rows.deviations(&fit, tie, has_gap, memory)?;
    let stiffness = fit.coefficients[0];
    let [inertia, offset] = [2, 3].map(|k| fit.coefficients[GEAR + k]);
    let mut at = fit.at;
    if !has_gap && stiffness > 0.0 {
        // A spring carries nothing where a torque without bias says so.
        at = at.map(|x| x - offset / stiffness);
    }
    let depth = rows.beyond(fit.at);
    let between = rows.departure.iter().zip(&depth).map(|(x, d)| x - d);
    let between: Vec<f64> = between.collect();
    let mean = between.iter().sum::<f64>() / n as f64;
    let motor = rows.motor_alone(tie)?;
    let floor = |law: f64, value: f64, std: f64| std.hypot(law * value);
    Some(Flanks {
        at,
        stiffness: [stiffness, floor(LAWS[0], stiffness, stiffness_std)],
        half_gap: has_gap.then(|| [half, floor(LAWS[1], half, half_std)]),
        inertia,
        explained: 1.0 - fit.square / motor.max(f64::MIN_POSITIVE),
        parts: [
            rms(between.iter().map(|x| x - mean)),
            rms(depth.iter().copied()),
        ],
    })
}

impl Rows {
    /// Mean square that the motor's own friction and inertia leave.
    fn motor_alone(&self, tie: f64) -> Option<f64> {
        let still = Rows {
            departure: vec![0.0; self.departure.len()],
            rate: vec![0.0; self.rate.len()],
            ..self.clone()
        };
        still.fit([0.0; 2], tie).map(|f| f.square)
    }
}

fn rms(x: impl Iterator<Item = f64>) -> f64 {
    let (sum, n) = x.fold((0.0, 0usize), |(s, n), x| (s + x * x, n + 1));
    (sum / n.max(1) as f64).sqrt()
}

/// Sums of products.
#[derive(Clone)]
struct Products {
    gram: Vec<f64>,
    right: Vec<f64>,
}

impl Products {
    fn new(n: usize) -> Self {
        Self {
            gram: vec![0.0; n * n],
            right: vec![0.0; n],
        }
    }

    fn add(&mut self, other: &Self, factor: f64) {
        let sum = |a: &mut [f64], b: &[f64]| {
            a.iter_mut().zip(b).for_each(|(a, b)| *a += factor * b);
        };
        sum(&mut self.gram, &other.gram);
        sum(&mut self.right, &other.right);
    }

    /// Factor of the scaled system, one column held at none so firmly, and its scales; a column that is nothing, or a copy, is pinned.
    fn factor(&self, (held, tie): (usize, f64)) -> (Vec<f64>, Vec<f64>) {
        let n = self.right.len();
        let mut gram = self.gram.clone();
        gram[held * n + held] += tie;
        let scale: Vec<f64> = (0..n)
            .map(|i| gram[i * n + i].max(f64::MIN_POSITIVE).sqrt())
            .collect();
        for i in 0..n {
            for j in 0..n {
                gram[i * n + j] /= scale[i] * scale[j];
            }
            gram[i * n + i] += 1e-10;
        }
        cholesky::factor_above(&mut gram, n, 1e-12);
        (gram, scale)
    }

    fn solve(&self, tied: (usize, f64)) -> Option<Vec<f64>> {
        let (factor, scale) = self.factor(tied);
        let mut x: Vec<f64> = self.right.iter().zip(&scale).map(|(r, s)| r / s).collect();
        cholesky::solve(&factor, &mut x);
        x.iter_mut().zip(&scale).for_each(|(x, s)| *x /= s);
        x.iter().all(|x| x.is_finite()).then_some(x)
    }

    /// Variance of a coefficient for residuals of unit variance.
    fn variance(&self, tied: (usize, f64), of: usize) -> Option<f64> {
        let (factor, scale) = self.factor(tied);
        let mut x = vec![0.0; scale.len()];
        x[of] = 1.0;
        cholesky::solve(&factor, &mut x);
        Some(x[of] / (scale[of] * scale[of])).filter(|v| v.is_finite() && *v >= 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE: f64 = 62.5;

    /// A gear with a gap under a load of several frequencies, its motor with friction and inertia; the departure follows the load.
    fn rows(stiffness: f64, half: f64, zero: f64) -> Rows {
        let n = 4 * 900;
        let t = |i: usize| i as f64 / RATE;
        let of = |f: &dyn Fn(f64) -> f64| -> Vec<f64> { (0..n).map(|i| f(t(i))).collect() };
        let load = of(&|t| 8.0 * (1.1 * t).sin() + 5.0 * (3.7 * t).cos() + 2.0 * (0.3 * t).sin());
        let qd = of(&|t| 0.8 * (1.9 * t).cos() + 0.3 * (0.7 * t).sin());
        let qdd = of(&|t| -1.52 * (1.9 * t).sin() + 0.21 * (0.7 * t).cos());
        let sign: Vec<f64> = qd.iter().map(|v| (v / 0.01).tanh()).collect();
        let departure: Vec<f64> = load
            .iter()
            .map(|l| zero + l / stiffness + half * (l / 0.2).tanh())
            .collect();
        let rate = (0..n)
            .map(|i| {
                let (a, b) = (i.saturating_sub(1), (i + 1).min(n - 1));
                (departure[b] - departure[a]) * RATE / (b - a) as f64
            })
            .collect();
        let torque = (0..n)
            .map(|i| load[i] + 0.4 * qd[i] + 1.5 * sign[i] + 0.2 * qdd[i])
            .collect();
        Rows {
            departure,
            rate,
            motor: [qd, sign, qdd, vec![1.0; n]],
            own: of(&|t| (1.3 * t).sin()),
            torque,
            counts: vec![true; n],
            trajectories: (0..4).map(|k| k * 900..(k + 1) * 900).collect(),
            rate_hz: RATE,
        }
    }

    #[test]
    fn a_spring_is_a_spring_and_its_stiffness_lies_in_its_interval() {
        let found = flanks(rows(2000.0, 0.0, 0.01)).unwrap();
        let [stiffness, std] = found.stiffness;
        assert!((stiffness / 2000.0 - 1.0).abs() < 0.01, "{stiffness}");
        assert!(std < 0.06 * stiffness);
        assert!(found.half_gap.is_none());
        assert!((found.at[0] - 0.01).abs() < 1e-4 && found.at[0] == found.at[1]);
        assert!((found.inertia - 0.2).abs() < 0.01, "{}", found.inertia);
        assert!(found.explained > 0.99);
    }

    #[test]
    fn a_gap_is_told_from_its_wind_up() {
        let found = flanks(rows(5000.0, 0.004, -0.02)).unwrap();
        let [half, std] = found.half_gap.unwrap();
        assert!((half - 0.004).abs() < 2.0 * std, "{half} ± {std}");
        assert!((found.stiffness[0] / 5000.0 - 1.0).abs() < 0.05);
        let [between, beyond] = found.parts;
        assert!(between > beyond, "{between} {beyond}");
        let middle = 0.5 * (found.at[0] + found.at[1]);
        assert!((middle + 0.02).abs() < 2e-4, "{middle}");
    }

    #[test]
    fn a_departure_that_has_nothing_to_do_with_the_torque_explains_nothing() {
        let mut own = rows(2000.0, 0.0, 0.0);
        let mut state = 1u64;
        for x in &mut own.departure {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            *x = 1e-5 * ((state >> 40) as f64 / 16_777_216.0 - 0.5);
        }
        own.rate.fill(0.0);
        assert!(flanks(own).is_none_or(|f| f.explained < 0.05));
    }
}
