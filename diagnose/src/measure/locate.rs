//! Location of the gap: shares of the squared error on the held-out recording by joint and region.

use crate::catalogue::Unit;
use crate::schema::Place;
use crate::settings::Settings;
use crate::traces::order::Orders;
use datasets::metrics::deviations;
use ndarray::{Array1, Array2};
use signal::Motion;
use signal::spectrum::welch;

/// Number of bins of a coordinate.
const BINS: usize = 8;
/// Length of the spectrum's windows, s.
const WINDOW: f64 = 4.0;
/// Upper ends of the frequency bands, Hz; the last band reaches half the sampling rate.
const BANDS: [f64; 7] = [0.25, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0];

/// A region and the samples inside it.
struct Region {
    place: Place,
    inside: Vec<bool>,
    joint: usize,
}

/// Regions with the largest shares of the squared error: mean over joints of squared NRMSE. Each joint and
/// coordinate gives the region whose share exceeds its share of time most. For a band of frequency, the share
/// of time is its share of the band up to half the sampling rate. For an order of position, it is its share of
/// the orders that the recording resolves.
pub fn locate(
    gap: &Array2<f64>,
    tau: &Array2<f64>,
    load: &Array2<f64>,
    motion: &Motion,
    names: &[String],
    rate_hz: f64,
    settings: &Settings,
) -> Vec<Place> {
    let (least, most) = (settings.measure.said.region, settings.measure.said.regions);
    let deviation = deviations(tau.view(), motion.qd.view());
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
    // Share of the gap in every sample of every joint.
    let mut shares = gap * gap / total;
    for (mut column, w) in shares.columns_mut().into_iter().zip(&weight) {
        column *= *w;
    }
    let mut regions = Vec::new();
    let mut bands = Vec::new();
    for j in 0..gap.ncols() {
        let share = shares.column(j).to_owned();
        for (coordinate, unit, values) in coordinates(motion, load, j) {
            let Some(range) = region(&values, &share) else {
                continue;
            };
            let inside = |x: &f64| *x >= range[0] && *x <= range[1];
            let inside = values.iter().map(inside).collect();
            regions.push(filled(j, names, coordinate, unit, range, &share, inside));
        }
        for (sign, range) in [(1.0, [0.0, 1.0]), (-1.0, [-1.0, 0.0])] {
            let velocity = motion.qd.column(j);
            let inside = velocity.iter().map(|v| v * sign > 0.0).collect();
            regions.push(filled(
                j,
                names,
                "direction",
                Unit::Sign,
                range,
                &share,
                inside,
            ));
        }
        bands.extend(frequency(gap, motion, j, rate_hz, share.sum(), names));
        bands.extend(order(gap, motion, j, rate_hz, share.sum(), names));
    }
    regions.retain(|r| r.place.share_of_gap > least && r.place.share_of_time > 0.0);
    regions.sort_by(|a, b| b.place.share_of_gap.total_cmp(&a.place.share_of_gap));
    regions.truncate(most);
    let block = ((settings.ladder.stretch * rate_hz) as usize).max(1);
    let mut places: Vec<Place> = regions
        .into_iter()
        .map(|r| Place {
            share_interval: Some(interval(&shares, r.joint, &r.inside, block)),
            ..r.place
        })
        .collect();
    places.extend(bands.into_iter().filter(|p| p.share_of_gap > least));
    places.sort_by(|a, b| b.share_of_gap.total_cmp(&a.share_of_gap));
    places.truncate(most);
    places
}

/// Coordinates of one joint at the samples, with their units.
fn coordinates(
    motion: &Motion,
    load: &Array2<f64>,
    joint: usize,
) -> [(&'static str, Unit, Array1<f64>); 6] {
    let start = motion.time.first().copied().unwrap_or(0.0);
    [
        (
            "velocity",
            Unit::RadPerSecond,
            motion.qd.column(joint).to_owned(),
        ),
        ("position", Unit::Rad, motion.q.column(joint).to_owned()),
        (
            "acceleration",
            Unit::RadPerSecond2,
            motion.qdd.column(joint).to_owned(),
        ),
        ("load", Unit::NewtonMetre, load.column(joint).to_owned()),
        (
            "time",
            Unit::Second,
            motion.time.iter().map(|t| t - start).collect(),
        ),
        (
            "reversal_distance",
            Unit::Rad,
            since_reversal(motion, joint),
        ),
    ]
}

fn filled(
    joint: usize,
    names: &[String],
    coordinate: &'static str,
    unit: Unit,
    range: [f64; 2],
    share: &Array1<f64>,
    inside: Vec<bool>,
) -> Region {
    Region {
        place: place(
            &names[joint],
            (coordinate, unit),
            range,
            sums(share, &|i| inside[i]),
        ),
        inside,
        joint,
    }
}

/// A place with its share of the gap and of time.
fn place(
    joint: &str,
    (coordinate, unit): (&'static str, Unit),
    range: [f64; 2],
    (share_of_gap, share_of_time): (f64, f64),
) -> Place {
    Place {
        joint: joint.to_owned(),
        coordinate,
        range,
        unit,
        share_of_gap,
        share_interval: None,
        share_of_time,
    }
}

/// Contiguous bins of a coordinate with the most error for their time.
fn region(values: &Array1<f64>, share: &Array1<f64>) -> Option<[f64; 2]> {
    let mut sorted: Vec<f64> = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let edge = |b: usize| sorted[b * (sorted.len() - 1) / BINS];
    let all = share.sum();
    if edge(BINS) - edge(0) < 1e-9 || all <= 0.0 {
        return None;
    }
    let mut best: Option<([f64; 2], f64)> = None;
    for from in 0..BINS {
        for to in from + 1..=BINS {
            let (low, high) = (edge(from), edge(to));
            let (s, t) = sums(share, &|i| values[i] >= low && values[i] <= high);
            let excess = s / all - t;
            if best.as_ref().is_none_or(|(_, most)| excess > *most) {
                best = Some(([low, high], excess));
            }
        }
    }
    best.map(|b| b.0)
}

fn sums(share: &Array1<f64>, inside: &dyn Fn(usize) -> bool) -> (f64, f64) {
    let (s, n) = (0..share.len())
        .filter(|&i| inside(i))
        .fold((0.0, 0usize), |(s, n), i| (s + share[i], n + 1));
    (s, n as f64 / share.len().max(1) as f64)
}

/// 90 % interval of a region's share by bootstrap over stretches of time.
fn interval(shares: &Array2<f64>, joint: usize, inside: &[bool], block: usize) -> [f64; 2] {
    let rows = shares.nrows();
    let blocks: Vec<(f64, f64)> = (0..rows.div_ceil(block))
        .map(|b| {
            let own = b * block..((b + 1) * block).min(rows);
            let part = own.clone().filter(|&i| inside[i]);
            let all = own.map(|i| shares.row(i).sum()).sum::<f64>();
            (part.map(|i| shares[[i, joint]]).sum::<f64>(), all)
        })
        .collect();
    signal::bootstrap::ratio(&blocks).1
}

/// Band of frequency with the most error of a joint for its width. `share` is the joint's share of the gap.
fn frequency(
    gap: &Array2<f64>,
    motion: &Motion,
    joint: usize,
    rate_hz: f64,
    share: f64,
    names: &[String],
) -> Option<Place> {
    let half = 0.5 * rate_hz;
    let mut edges = vec![0.0];
    edges.extend(BANDS.into_iter().filter(|b| *b < half));
    edges.push(half);
    let mut power = vec![0.0; edges.len() - 1];
    let window = (WINDOW * rate_hz) as usize;
    for s in motion.segments.iter().filter(|s| s.len() >= window.max(8)) {
        let x: Vec<f64> = s.clone().map(|i| gap[[i, joint]]).collect();
        let spectrum = welch(&x, rate_hz, window);
        for (f, d) in spectrum.frequency.iter().zip(&spectrum.density) {
            let band = edges[1..].partition_point(|e| e < f).min(power.len() - 1);
            power[band] += d * s.len() as f64;
        }
    }
    let all: f64 = power.iter().sum();
    if all <= 0.0 {
        return None;
    }
    let excess = |b: usize| power[b] / all - (edges[b + 1] - edges[b]) / half;
    let best = (0..power.len()).max_by(|&a, &b| excess(a).total_cmp(&excess(b)))?;
    let [low, high] = [edges[best], edges[best + 1]];
    let shares = (share * power[best] / all, (high - low) / half);
    Some(place(
        &names[joint],
        ("frequency", Unit::Hertz),
        [low, high],
        shares,
    ))
}

/// Order of position with the most error of a joint. `share` is the joint's share of the gap.
fn order(
    gap: &Array2<f64>,
    motion: &Motion,
    joint: usize,
    rate_hz: f64,
    share: f64,
    names: &[String],
) -> Option<Place> {
    let r = gap.column(joint);
    let qd = motion.qd.column(joint);
    let speed = (qd.dot(&qd) / qd.len().max(1) as f64).sqrt();
    let orders = Orders::new(r, motion.q.column(joint), speed, rate_hz)?;
    let (k, gain) = orders.strongest()?;
    let half = 0.5 * orders.resolution();
    let [least, most] = orders.span;
    let shares = (
        share * (gain / r.dot(&r)).clamp(0.0, 1.0),
        (2.0 * half / (most - least)).min(1.0),
    );
    Some(place(
        &names[joint],
        ("order", Unit::PerRad),
        [k - half, k + half],
        shares,
    ))
}

/// Distance travelled since the joint's last reversal, rad (m), within each trajectory.
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Ten seconds at 100 Hz; the error sits where the velocity is above 0.5 and swings at 3 Hz.
    #[test]
    fn finds_the_speed_and_the_band() {
        let n = 1000;
        let t = |i: usize| 0.01 * i as f64;
        let table = |f: &dyn Fn(f64) -> f64| Array2::from_shape_fn((n, 1), |(i, _)| f(t(i)));
        let speed = |t: f64| (0.9 * t).cos();
        let motion = Motion {
            time: (0..n).map(t).collect(),
            q: table(&|t| (0.9 * t).sin() / 0.9),
            qd: table(&speed),
            qdd: table(&|t| -0.9 * (0.9 * t).sin()),
            segments: std::iter::once(0..n).collect(),
        };
        let wave = |t: f64| (std::f64::consts::TAU * 3.0 * t).sin();
        let gap = table(&|t| if speed(t) > 0.5 { wave(t) } else { 0.0 });
        let tau = table(&|t| 5.0 * (1.7 * t).sin());
        let names = ["j".to_owned()];
        let settings = Settings::default();
        let places = locate(&gap, &tau, &tau, &motion, &names, 100.0, &settings);
        let of = |c: &str| places.iter().find(|p| p.coordinate == c).unwrap();
        let velocity = of("velocity");
        assert!(
            velocity.range[0] > 0.3 && velocity.share_of_gap > 0.95,
            "{velocity:?}"
        );
        let [low, high] = velocity.share_interval.unwrap();
        assert!(low <= velocity.share_of_gap && velocity.share_of_gap <= high);
        assert_eq!(of("frequency").range, [2.0, 5.0]);
        assert!(of("frequency").share_of_gap > 0.8, "{:?}", of("frequency"));
    }
}
