//! Stages of a torque channel on the way to the log.

use super::fault::Fault;
use super::sheet::DataSheet;
use datasets::Recording;
use plant::random::log_uniform;
use rand::RngExt;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use signal::filter::filtfilt;
use signal::sos::{butterworth, chebyshev1};

/// Passes the torque of a recording through a channel with a fault; returns the joints that it concerns. A torque that
/// is `exact` gets neither noise nor steps.
pub fn pass(
    fault: Fault,
    recording: &mut Recording,
    sheet: &[DataSheet],
    exact: bool,
    rng: &mut ChaCha8Rng,
) -> Vec<usize> {
    let n = recording.dof();
    let joints = concerned(fault, n, rng);
    let whole = fault == Fault::Saturated && rng.random_bool(0.5);
    let calibrated = rng.random_bool(0.5);
    let biased = rng.random_bool(0.5);
    let filter = Kernel::draw(recording, rng);
    let sheet_of = |j: usize| match fault {
        Fault::Current => 1.0 / (sheet[j].gear_ratio * sheet[j].torque_constant),
        Fault::Motor => 1.0 / sheet[j].gear_ratio,
        Fault::Percent => 100.0 / sheet[j].rated,
        _ => 1.0,
    };
    let parts = recording.segments();
    let time = recording.time.clone();
    for j in 0..n {
        let Some(tau) = recording.tau.as_mut() else {
            break;
        };
        let mut values = tau.column(j).to_vec();
        let size = deviation(&values);
        let own = joints.contains(&j);
        let sensed = !exact && (fault != Fault::Dead || !own);
        if !exact {
            let gain = if calibrated {
                1.0
            } else {
                log_uniform(rng, 0.9, 1.12)
            };
            let offset = if biased {
                rng.random_range(-0.05..0.05) * size
            } else {
                0.0
            };
            values.iter_mut().for_each(|v| *v = gain * *v + offset);
        }
        if fault == Fault::Dead && own {
            die(&mut values, &time, size, rng);
        }
        let limit = if fault == Fault::Saturated && own {
            limit_of(&values, rng)
        } else {
            f64::INFINITY
        };
        // A drive's limit cuts the torque before its sensor sees it, a converter's behind it.
        if !whole {
            values.iter_mut().for_each(|v| *v = v.clamp(-limit, limit));
        }
        if sensed {
            let noise =
                size * log_uniform(rng, 0.004, 0.04) * if limit.is_finite() { 0.4 } else { 1.0 };
            for v in &mut values {
                let z: f64 = StandardNormal.sample(rng);
                *v += noise * z;
            }
        }
        if whole {
            values.iter_mut().for_each(|v| *v = v.clamp(-limit, limit));
        }
        let scale = sheet_of(j)
            * if fault == Fault::Sign && own {
                -1.0
            } else {
                1.0
            };
        values.iter_mut().for_each(|v| *v *= scale);
        let step = match fault {
            Fault::Quantised => size * log_uniform(rng, 0.15, 0.6),
            Fault::Percent => [0.1, 1.0][rng.random_range(0..2)],
            _ => size * scale.abs() * log_uniform(rng, 0.002, 0.04),
        };
        if sensed {
            values
                .iter_mut()
                .for_each(|v| *v = (*v / step).round() * step);
        }
        if fault == Fault::Absolute {
            values.iter_mut().for_each(|v| *v = v.abs());
        }
        if fault == Fault::Filtered {
            for part in &parts {
                let passed = filter.pass(&values[part.clone()]);
                values[part.clone()].copy_from_slice(&passed);
            }
        }
        for (to, v) in tau.column_mut(j).iter_mut().zip(values) {
            *to = v;
        }
    }
    joints
}

/// The joints that a fault is of.
fn concerned(fault: Fault, n: usize, rng: &mut ChaCha8Rng) -> Vec<usize> {
    let mut all: Vec<usize> = (0..n).collect();
    if !fault.by_joint() || (fault != Fault::Dead && rng.random_bool(0.3)) {
        return all;
    }
    let count = rng.random_range(1..=2.min(n - 1));
    all.shuffle(rng);
    all.truncate(count);
    all.sort_unstable();
    all
}

/// A limit that a twentieth to a fifth of the samples lie beyond.
fn limit_of(values: &[f64], rng: &mut ChaCha8Rng) -> f64 {
    let mut sizes: Vec<f64> = values.iter().map(|v| v.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    sizes[(rng.random_range(0.8..0.95) * sizes.len() as f64) as usize]
}

/// Takes the signal away: one value throughout, the converter's last bit, or one value from some time on.
fn die(values: &mut [f64], time: &[f64], size: f64, rng: &mut ChaCha8Rng) {
    match rng.random_range(0..4) {
        0 => values.fill(0.0),
        1 => values.fill(size * rng.random_range(-1.0..1.0)),
        2 => {
            let bit = size * log_uniform(rng, 1e-4, 1e-2);
            for v in values.iter_mut() {
                let z: f64 = StandardNormal.sample(rng);
                *v = bit * z.round();
            }
        }
        _ => {
            let from = rng.random_range(0.3..0.7) * time[time.len() - 1];
            let mut last = 0.0;
            for (v, t) in values.iter_mut().zip(time) {
                if *t < from {
                    last = *v;
                } else {
                    *v = last;
                }
            }
        }
    }
}

/// A low-pass forwards and backwards: a maker's filter or a window that slides.
enum Kernel {
    Sections(Vec<signal::sos::Section>),
    /// Weights of a symmetric window.
    Window(Vec<f64>),
}

impl Kernel {
    fn draw(recording: &Recording, rng: &mut ChaCha8Rng) -> Self {
        let rate = 1.0 / recording.median_step();
        let corner = log_uniform(rng, 1.5, (0.12 * rate).min(10.0));
        let order = rng.random_range(3..7);
        let sections = match rng.random_range(0..3) {
            0 => butterworth(order, corner, rate),
            1 => chebyshev1(order, rng.random_range(0.05..0.5), corner, rate),
            _ => {
                let half = (rate / corner).round() as i32;
                let weight = |k: i32| {
                    let x = f64::from(k) / f64::from(half);
                    (-8.0 * x * x).exp()
                };
                let all: Vec<f64> = (-half..=half).map(weight).collect();
                let sum: f64 = all.iter().sum();
                return Self::Window(all.into_iter().map(|w| w / sum).collect());
            }
        };
        Self::Sections(sections.unwrap_or_default())
    }

    fn pass(&self, x: &[f64]) -> Vec<f64> {
        match self {
            Self::Sections(sections) => filtfilt(sections, x),
            Self::Window(weights) => {
                let (half, last) = (weights.len() / 2, x.len() as isize - 1);
                let at = |k: usize| {
                    let from = k as isize - half as isize;
                    let own = weights.iter().zip(from..);
                    own.map(|(w, i)| w * x[i.clamp(0, last) as usize]).sum()
                };
                (0..x.len()).map(at).collect()
            }
        }
    }
}

fn deviation(values: &[f64]) -> f64 {
    let count = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / count;
    (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / count).sqrt()
}
