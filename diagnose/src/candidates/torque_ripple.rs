//! `torque_ripple`: torque periodic in the joint's position (cogging, gear meshing). The orders come from the
//! periodogram over position of what a first fit leaves, on unfiltered torque at the recorded rate: a low-pass
//! would remove the ripple of a fast joint. Orders need not be whole.
//! Confounders: none at high orders; below a few cycles per range, gravity and counterbalance.

use super::{Bound, Candidate, Column, Quantity};
use crate::cholesky::Cholesky;
use crate::effect::Effect;
use ndarray::{Array1, Array2};

/// Fewest cycles over the recorded range.
const FEWEST_CYCLES: f64 = 2.5;
/// Most cycles over the recorded range.
const MOST_CYCLES: f64 = 320.0;
/// Most lines of one joint.
const LINES: usize = 3;

const NAMES: [(&str, &str); LINES] = [
    ("sine_1", "cosine_1"),
    ("sine_2", "cosine_2"),
    ("sine_3", "cosine_3"),
];

/// Candidates of a joint with one, two and three lines.
pub fn candidates(joint: usize, orders: &[f64]) -> Vec<Candidate> {
    let columns: Vec<(Column, Column)> = orders
        .iter()
        .map(|&k| {
            (
                Column::own(joint, move |s| {
                    s.motion.q.column(joint).mapv(|q| (k * q).sin())
                }),
                Column::own(joint, move |s| {
                    s.motion.q.column(joint).mapv(|q| (k * q).cos())
                }),
            )
        })
        .collect();
    (1..=orders.len().min(LINES))
        .map(|n| {
            let mut c = Candidate {
                effect: Effect::TorqueRipple,
                joints: vec![joint],
                driver: None,
                columns: Vec::new(),
                bounds: vec![Bound::Free; 2 * n],
                quantities: Vec::new(),
                shape: orders[..n].iter().map(|&k| ("order", k, "1/rad")).collect(),
                evidence: 0.0,
            };
            for ((sin, cos), (s, k)) in columns[..n].iter().zip(NAMES) {
                c.columns.extend([sin.clone(), cos.clone()]);
                c.quantities.push(Quantity::plain(s, "N·m", Some(joint)));
                c.quantities.push(Quantity::plain(k, "N·m", Some(joint)));
            }
            c
        })
        .collect()
}

/// The strongest orders (1/rad) in `residual` over position `q`, both at the recorded samples; `rate` in Hz, `speed`
/// the joint's root mean square velocity.
pub fn orders(residual: &Array1<f64>, q: &Array1<f64>, speed: f64, rate: f64) -> Vec<f64> {
    let (low, high) = q
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &x| {
            (a.min(x), b.max(x))
        });
    let range = high - low;
    if range < 1e-4 {
        return Vec::new();
    }
    let tau = std::f64::consts::TAU;
    let least = FEWEST_CYCLES * tau / range;
    // At the joint's usual speed a line has to lie below a third of the rate.
    let most = (MOST_CYCLES * tau / range).min(0.33 * tau * rate / speed);
    if most <= least {
        return Vec::new();
    }
    // Eight bins per period of the highest order; the lines are found on sums over bins.
    let bins = ((range * most / tau * 8.0).ceil() as usize).max(16);
    let (mut sum, mut count) = (vec![0.0; bins], vec![0.0; bins]);
    for (&x, &r) in q.iter().zip(residual) {
        let b = (((x - low) / range * bins as f64) as usize).min(bins - 1);
        sum[b] += r;
        count[b] += 1.0;
    }
    let place = |b: usize| low + (b as f64 + 0.5) * range / bins as f64;
    remove_trend(&mut sum, &count);
    let step = 0.5 * std::f64::consts::PI / range;
    let n = ((most - least) / step) as usize;
    let refine = |sum: &[f64], mut k: f64| {
        let gain = |k: f64| line(sum, &count, &place, k).2;
        for width in [step / 2.0, step / 8.0, step / 32.0] {
            let around = (-3..=3).map(|i| k + width * f64::from(i) / 2.0);
            k = around
                .max_by(|a, b| gain(*a).total_cmp(&gain(*b)))
                .unwrap_or(k);
        }
        k
    };
    let take = |sum: &mut [f64], (k, s, c): (f64, f64, f64), sign: f64| {
        for (b, (sum, n)) in sum.iter_mut().zip(&count).enumerate() {
            let x = place(b);
            *sum -= sign * n * (s * (k * x).sin() + c * (k * x).cos());
        }
    };
    let fitted = |sum: &[f64], k: f64| {
        let (s, c, _) = line(sum, &count, &place, k);
        (k, s, c)
    };
    let mut found: Vec<(f64, f64, f64)> = Vec::new();
    for _ in 0..LINES {
        let gain = |i: &usize| line(&sum, &count, &place, least + *i as f64 * step).2;
        let Some((best, _)) = (0..n)
            .map(|i| (i, gain(&i)))
            .max_by(|a, b| a.1.total_cmp(&b.1))
        else {
            break;
        };
        let new = fitted(&sum, refine(&sum, least + best as f64 * step));
        take(&mut sum, new, 1.0);
        found.push(new);
        // Uneven coverage makes the lines lean on each other: each is fitted again without the rest.
        for l in (0..found.len()).chain(0..found.len()) {
            take(&mut sum, found[l], -1.0);
            found[l] = fitted(&sum, refine(&sum, found[l].0));
            take(&mut sum, found[l], 1.0);
        }
    }
    found.into_iter().map(|(k, _, _)| k).collect()
}

/// Takes a polynomial of degree four over the range out of the sums: slow torques of position leak into low orders.
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
    let c = Cholesky::new(a).solve(y.view());
    for (b, (s, n)) in sum.iter_mut().zip(count).enumerate() {
        *s -= n * powers(b).iter().zip(&c).map(|(p, c)| p * c).sum::<f64>();
    }
}

/// Least-squares sine and cosine of one order, and the squared error that they remove.
fn line(sum: &[f64], count: &[f64], place: &dyn Fn(usize) -> f64, k: f64) -> (f64, f64, f64) {
    let (mut ss, mut sc, mut cc, mut sy, mut cy) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for (b, (&y, &n)) in sum.iter().zip(count).enumerate() {
        let (s, c) = (k * place(b)).sin_cos();
        ss += n * s * s;
        sc += n * s * c;
        cc += n * c * c;
        sy += s * y;
        cy += c * y;
    }
    let det = ss * cc - sc * sc;
    if det <= 1e-9 * ss * cc {
        return (0.0, 0.0, 0.0);
    }
    let (s, c) = ((cc * sy - sc * cy) / det, (ss * cy - sc * sy) / det);
    (s, c, s * sy + c * cy)
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
        let found = orders(&r, &q, 0.5, 250.0);
        assert!(
            (found[0] - 20.7).abs() < 0.1 && found.iter().any(|k| (k - 74.39).abs() < 0.1),
            "{found:?}"
        );
    }
}
