//! Flanks of a gear from the link's departure from its motor: a spring on either side of a gap, fitted to the motor's torque.
//!
//! The motor carries its own friction and inertia and, through the gear, the link: τ = K·d + K₃·d³ + (D +
//! E·|d|)·ḋ + friction between the teeth + friction and inertia of the motor, d the departure beyond the
//! flanks. All but the flanks' places is linear; they are found by Gauss–Newton steps from several starts. No
//! rigid-body model is used, except for the part of the joint's own link that may turn with the motor, which is
//! tied to zero.

mod products;
mod rows;
mod sides;

use crate::algebra::folds::jackknife;
use products::Products;
use rows::{EXPLAINS, LAWS, SURE, rms};
use signal::correlation::correlation_time;
use signal::quantile::{median, quantile};

pub(super) use rows::{Flanks, Rows};

/// Initial gaps, relative to the departure's range. Last a start without gap is tried: a spring.
const STARTS: [f64; 4] = [0.1, 0.3, 0.6, 0.85];
/// Largest number of steps of the fit from one start.
const STEPS: usize = 14;
/// Radii over which friction between the teeth reverses, relative to the deflection's root mean square.
const TEETH: [f64; 2] = [0.1, 0.3];
/// Prior deviation of the part of the own link's torque that turns with the motor.
const OWN: f64 = 0.1;
/// Factor on that prior's precision where the rotor is taken to be balanced.
const BALANCED: f64 = 1e8;
/// Residual, in deviations, beyond which a row is an outlier.
const OUTLIER: f64 = 8.0;
/// Gain from which a gap is accepted, nats.
const SEEN: f64 = 10.0;
/// Least gap, relative to the departure's root mean square. A smaller one is an error of the spring's law.
const LEAST_GAP: f64 = 0.1;

/// Number of columns that depend on the departure alone.
const GEAR: usize = 4 + TEETH.len();

/// Fit with the flanks at given places.
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

    /// All columns with the flanks at the places `at`, own link last.
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

    /// Stop operator (Prandtl): a spring that slips beyond a radius, from −1 to 1.
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

    /// Sums of products of columns and the torque over some rows.
    fn torque_of(&self, columns: &[Vec<f64>], rows: &[usize]) -> Products {
        let columns: Vec<&Vec<f64>> = columns.iter().collect();
        self.products(&columns, &self.torque, rows)
    }

    /// Fit with the flanks at the places `at`; `tie` is the penalty that ties the own link's part to zero.
    fn fit(&self, at: [f64; 2], tie: f64) -> Option<Fit> {
        let columns = self.columns(at);
        let all: Vec<usize> = (0..self.torque.len()).collect();
        let own = columns.len() - 1;
        let coefficients = self.torque_of(&columns, &all).held((own, tie)).solve()?;
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

    /// Derivatives of the torque by the places of both flanks.
    fn moved(&self, fit: &Fit) -> [Vec<f64>; 2] {
        let k = fit.coefficients[0];
        let inside = |beyond: &dyn Fn(f64) -> bool| -> Vec<f64> {
            let one = |x: &f64| if beyond(*x) { -k } else { 0.0 };
            self.departure.iter().map(one).collect()
        };
        [inside(&|x| x < fit.at[0]), inside(&|x| x > fit.at[1])]
    }

    /// Fit with the best places of the flanks from a start.
    fn settle(&self, start: [f64; 2], tie: f64) -> Option<Fit> {
        let mut best = self.fit(start, tie)?;
        let all: Vec<usize> = (0..self.torque.len()).collect();
        for _ in 0..STEPS {
            let mut columns = self.columns(best.at);
            let n = columns.len();
            columns.extend(self.moved(&best));
            let solution = self.torque_of(&columns, &all).held((n - 1, tie)).solve();
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

    /// Standard deviations of stiffness and half gap: jackknife over blocks or posterior, whichever is larger.
    fn deviations(&self, fit: &Fit, tie: f64, gap: bool, memory: f64) -> Option<[f64; 2]> {
        let mut columns = self.columns(fit.at);
        let n = columns.len();
        if gap {
            columns.extend(self.moved(fit));
        }
        let blocks: Vec<Products> = self
            .blocks()
            .iter()
            .map(|rows| self.torque_of(&columns, rows))
            .collect();
        let mut whole = Products::new(columns.len());
        blocks.iter().for_each(|b| whole.add(b, 1.0));
        let whole = whole.held((n - 1, tie));
        let asked = |x: &[f64]| {
            let half = if gap { 0.5 * (x[n + 1] - x[n]) } else { 0.0 };
            [x[0], half]
        };
        let without: Vec<[f64; 2]> = blocks
            .iter()
            .filter_map(|b| {
                let mut rest = whole.clone();
                rest.add(b, -1.0);
                rest.solve().map(|x| asked(&x))
            })
            .collect();
        let [stiffness, half] = [0, 1].map(|k| {
            let each: Vec<f64> = without.iter().map(|x| x[k]).collect();
            jackknife(&each)
        });
        let posterior = whole.variance(0)? * fit.square * memory;
        Some([stiffness?.max(posterior.sqrt()), half?])
    }

    /// Leaves out rows with a residual beyond [`OUTLIER`] deviations.
    fn without_outliers(&mut self, fit: &Fit) {
        let size = median(fit.residual.iter().map(|r| r.abs()).collect()).unwrap_or(0.0);
        let most = OUTLIER * 1.48 * size;
        for (counts, r) in self.counts.iter_mut().zip(&fit.residual) {
            *counts &= r.abs() <= most;
        }
    }
}

/// Flanks from the rows; none where the rows show none. For flanks that are too stiff to deflect visibly, their
/// distance comes from the departure alone.
pub(super) fn flanks(mut rows: Rows) -> Option<Flanks> {
    if rows.departure.len() < 20 * (GEAR + 7) {
        return None;
    }
    let sure = |[value, std]: [f64; 2]| value > SURE * std;
    let seen = |found: &Flanks| {
        let gap = found.half_gap.is_some_and(sure);
        let gives = found.stiffness.is_some_and(|k| sure(k) || gap);
        gives && found.explained >= EXPLAINS
    };
    let by_torque = by_torque(&mut rows).filter(seen);
    match by_torque {
        // What stands on one side or the other is no spring, however the torque goes.
        Some(found) if found.half_gap.is_some_and(sure) => Some(found),
        found => sides::sides(&rows).or(found),
    }
}

/// Flanks from the fit of the motor's torque.
fn by_torque(rows: &mut Rows) -> Option<Flanks> {
    let n = rows.departure.len();
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
    let explained = rows.explained(fit.at)?;
    let floor = |law: f64, value: f64, std: f64| std.hypot(law * value);
    // A balanced rotor takes nothing of the link's torque with it. What is fitted of that is as like the spring's as other errors of the
    // law are, so that the truth may lie at either: the middle is said, and half of the way between them.
    let alone = rows.fit(fit.at, BALANCED * tie)?.coefficients[0];
    let (stiffness, way) = (0.5 * (stiffness + alone), 0.5 * (stiffness - alone));
    let stiffness_std = floor(LAWS[0], stiffness, stiffness_std.hypot(way));
    Some(Flanks {
        at,
        stiffness: (stiffness > 0.0).then_some([stiffness, stiffness_std]),
        half_gap: has_gap.then(|| [half, floor(LAWS[1], half, half_std)]),
        inertia,
        explained,
        parts: [
            rms(between.iter().map(|x| x - mean)),
            rms(depth.iter().copied()),
        ],
    })
}

impl Rows {
    /// Part of the squared torque that the gear explains, of that which the motor and a once-per-turn error of the encoder leave.
    fn explained(&self, at: [f64; 2]) -> Option<f64> {
        let columns = self.columns(at);
        let gear = &columns[..GEAR];
        let motor: Vec<&Vec<f64>> = self.motor.iter().chain(&self.turn).collect();
        let without = self.left(&motor)?;
        let with = self.left(&gear.iter().chain(motor).collect::<Vec<_>>())?;
        Some(1.0 - with / without.max(f64::MIN_POSITIVE))
    }
}

#[cfg(test)]
mod tests;
