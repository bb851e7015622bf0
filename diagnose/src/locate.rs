//! Where the gap lies: shares of the squared held-out error by joint and region.

use crate::ladder::deviations;
use crate::report::Place;
use ndarray::{Array1, Array2};
use signal::Motion;

/// Most regions reported.
const MOST: usize = 16;
/// Bins of a coordinate.
const BINS: usize = 8;

/// Regions with the largest shares of the squared error, in mean over joints of squared NRMSE. Each joint and coordinate
/// gives its most overloaded region: the one whose share exceeds its share of time most.
pub fn locate(
    gap: &Array2<f64>,
    tau: &Array2<f64>,
    load: &Array2<f64>,
    motion: &Motion,
    names: &[String],
) -> Vec<Place> {
    let deviation = deviations(tau);
    let weight: Vec<f64> = deviation
        .iter()
        .map(|d| d.map_or(0.0, |d| 1.0 / (d * d)))
        .collect();
    let total: f64 = (0..gap.ncols())
        .map(|j| weight[j] * gap.column(j).dot(&gap.column(j)))
        .sum();
    if total <= 0.0 {
        return Vec::new();
    }
    let mut places = Vec::new();
    for j in 0..gap.ncols() {
        let share: Array1<f64> = gap.column(j).mapv(|g| weight[j] * g * g / total);
        let start = motion.time.first().copied().unwrap_or(0.0);
        let coordinates: [(&'static str, &'static str, Array1<f64>); 6] = [
            ("velocity", "rad/s", motion.qd.column(j).to_owned()),
            ("position", "rad", motion.q.column(j).to_owned()),
            ("acceleration", "rad/s²", motion.qdd.column(j).to_owned()),
            ("load", "N·m", load.column(j).to_owned()),
            ("time", "s", motion.time.iter().map(|t| t - start).collect()),
            ("reversal_distance", "rad", since_reversal(motion, j)),
        ];
        for (coordinate, unit, values) in coordinates {
            places.extend(region(&values, &share).map(|(range, s, t)| Place {
                joint: names[j].clone(),
                coordinate,
                range,
                unit,
                share_of_gap: s,
                share_of_time: t,
            }));
        }
        for (sign, range) in [(1.0, [0.0, 1.0]), (-1.0, [-1.0, 0.0])] {
            let inside = |i: usize| motion.qd[[i, j]] * sign > 0.0;
            let (s, t) = sums(&share, &inside);
            if t > 0.0 && s > 0.01 {
                places.push(Place {
                    joint: names[j].clone(),
                    coordinate: "direction",
                    range,
                    unit: "sign",
                    share_of_gap: s,
                    share_of_time: t,
                });
            }
        }
    }
    places.sort_by(|a, b| b.share_of_gap.total_cmp(&a.share_of_gap));
    places.truncate(MOST);
    places
}

/// The contiguous bins of a coordinate that hold most error for their time: range, share of error, share of time.
fn region(values: &Array1<f64>, share: &Array1<f64>) -> Option<([f64; 2], f64, f64)> {
    let mut sorted: Vec<f64> = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let edge = |b: usize| sorted[b * (sorted.len() - 1) / BINS];
    if edge(BINS) - edge(0) < 1e-9 {
        return None;
    }
    let mut best: Option<([f64; 2], f64, f64)> = None;
    let all = share.sum();
    for from in 0..BINS {
        for to in from + 1..=BINS {
            let (low, high) = (edge(from), edge(to));
            let (s, t) = sums(share, &|i| values[i] >= low && values[i] <= high);
            let excess = s / all - t;
            if best
                .as_ref()
                .is_none_or(|(_, bs, bt)| excess > bs / all - bt)
            {
                best = Some(([low, high], s, t));
            }
        }
    }
    best.filter(|(_, s, _)| *s > 0.005)
}

fn sums(share: &Array1<f64>, inside: &dyn Fn(usize) -> bool) -> (f64, f64) {
    let (s, n) = (0..share.len())
        .filter(|&i| inside(i))
        .fold((0.0, 0usize), |(s, n), i| (s + share[i], n + 1));
    (s, n as f64 / share.len().max(1) as f64)
}

/// Distance travelled since the joint last turned round, within each trajectory.
fn since_reversal(motion: &Motion, joint: usize) -> Array1<f64> {
    let mut out = Array1::zeros(motion.len());
    for s in &motion.segments {
        let mut travelled = 0.0;
        for i in s.start + 1..s.end {
            let (a, b) = (motion.q[[i - 1, joint]], motion.q[[i, joint]]);
            if motion.qd[[i, joint]] * motion.qd[[i - 1, joint]] < 0.0 {
                travelled = 0.0;
            }
            travelled += (b - a).abs();
            out[i] = travelled;
        }
    }
    out
}
