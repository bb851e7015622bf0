//! `torque_ripple`: torque periodic in the joint's position (cogging, gear meshing). The orders come from the
//! periodogram over position of what a first fit leaves, on unfiltered torque at the recorded rate: a low-pass
//! would remove the ripple of a fast joint. Orders need not be whole.
//! Confounders: none at high orders; below a few cycles per range, gravity and counterbalance.

use super::{Bound, Candidate, Column, Quantity};
use crate::effect::Effect;
use ndarray::Array1;

/// Fewest cycles over the recorded range.
const FEWEST_CYCLES: f64 = 2.5;
/// Most cycles over the recorded range.
const MOST_CYCLES: f64 = 320.0;
/// Most lines of one joint.
const LINES: usize = 3;

const NAMES: [(&str, &str); LINES] =
    [("sine_1", "cosine_1"), ("sine_2", "cosine_2"), ("sine_3", "cosine_3")];

/// Candidates of a joint with one, two and three lines.
pub fn candidates(joint: usize, orders: &[f64]) -> Vec<Candidate> {
    let columns: Vec<(Column, Column)> = orders
        .iter()
        .map(|&k| {
            (
                Column::own(joint, move |s| s.motion.q.column(joint).mapv(|q| (k * q).sin())),
                Column::own(joint, move |s| s.motion.q.column(joint).mapv(|q| (k * q).cos())),
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
    let (low, high) = q.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &x| (a.min(x), b.max(x)));
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
    let step = 0.5 * std::f64::consts::PI / range;
    let n = ((most - least) / step) as usize;
    let mut found = Vec::new();
    for _ in 0..LINES {
        let gain = |k: f64| line(&sum, &count, &place, k).2;
        let grid: Vec<f64> = (0..n).map(|i| gain(least + i as f64 * step)).collect();
        let Some(best) = (0..n).max_by(|&a, &b| grid[a].total_cmp(&grid[b])) else { break };
        let mut k = least + best as f64 * step;
        for width in [step / 2.0, step / 8.0, step / 32.0] {
            let around = (-3..=3).map(|i| k + width * f64::from(i) / 2.0);
            k = around.max_by(|a, b| gain(*a).total_cmp(&gain(*b))).unwrap_or(k);
        }
        let (s, c, _) = line(&sum, &count, &place, k);
        for b in 0..bins {
            let x = place(b);
            sum[b] -= count[b] * (s * (k * x).sin() + c * (k * x).cos());
        }
        found.push(k);
    }
    found
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
        let q: Array1<f64> = (0..20_000).map(|i| 1.3 * (f64::from(i) * 7e-4).sin()).collect();
        let r = q.mapv(|x| 0.8 * (20.7 * x + 0.3).sin() + 0.3 * (74.39 * x).cos() + 0.5 * x);
        let found = orders(&r, &q, 0.5, 250.0);
        assert!((found[0] - 20.7).abs() < 0.1 && found.iter().any(|k| (k - 74.39).abs() < 0.1), "{found:?}");
    }
}
