//! Resonance: a narrow peak in the spectrum of the residual, while the arm moves or rings at standstill.
//!
//! The spectrum is Welch's over windows of the recorded samples; a peak stands out of the median of its surroundings by
//! more than the highest of as many bins of noise would once in `chance` recordings (a sum of K windows of noise is
//! gamma distributed). In motion a peak that the predicted torque has as well is the motion's own line.

use crate::catalogue::effect::Effect;
use crate::input::frames::Frames;
use crate::ladder::rungs::Free;
use crate::motion::frame::Frame;
use crate::motion::scene::Scene;
use crate::schema::Resonance;
use crate::search::find::{Columns, Findings, gap};
use crate::settings::ResonanceSettings;
use crate::simulator::NominalModel;
use ndarray::{Array2, ArrayView1};
use signal::quantile::median;
use signal::resample::{linear, uniform_grid};
use signal::spectrum::{Spectrum, welch};
use std::ops::Range;

/// Shortest and longest window of the spectrum, s.
const WINDOW: (f64, f64) = (1.5, 8.0);
/// Fewest windows, without overlap, in the longest motion.
const FEWEST: f64 = 4.0;
/// Lower end of the search, in periods per window, and upper end, Hz; above it lies electrical hum.
const SEARCHED: (f64, f64) = (4.0, 40.0);
/// Largest frequency of the search, relative to the sampling rate.
const RATE_SHARE: f64 = 0.4;
/// Surroundings of a frequency for the median density: up to this factor above and below it.
const AROUND: f64 = 1.6;

/// A peak in the spectrum of one joint.
struct Peak {
    joint: usize,
    frequency: f64,
    width: f64,
    rms: f64,
    at_rest: bool,
}

/// Residual of re-identified parameters and ripple on the fitted recording, at the recorded samples, shape
/// (samples, joints). Other causes are left out of that fit: friction, play or a delay could have absorbed a
/// resonance. Ripple is fitted since it has a place of its own in the report.
pub fn standing_out(model: &NominalModel, frames: &Frames, found: &Findings) -> Array2<f64> {
    let ripple: Vec<usize> = (0..found.accepted.len())
        .filter(|&c| found.candidate(c).effect == Effect::TorqueRipple)
        .collect();
    let frame = &frames.data;
    let scene = Scene::new(&found.session.present, frames.passage(), &frames.scale);
    let fit = found.refit(model, &frames.scale, &ripple, Free::All);
    let columns = Columns::new(&found.dictionary, &scene, frame, &fit.variables);
    let gap = gap(model, frame, &frames.scale);
    &gap - &columns.torque(gap.dim(), &fit.variables, fit.beta())
}

/// Resonances in `residual`, at the recorded samples, shape (samples, joints), lowest frequency first.
pub fn resonances(
    frame: &Frame,
    residual: &Array2<f64>,
    names: &[String],
    settings: &ResonanceSettings,
) -> Vec<Resonance> {
    let s = settings;
    let motion = frame.samples();
    let still = |i: usize| motion.qd.row(i).iter().all(|v| v.abs() < s.standing);
    let rests: Vec<Range<usize>> = motion
        .segments
        .iter()
        .flat_map(|s| stretches(s.clone(), &still))
        .collect();
    let predicted = &frame.tau - residual;
    let mut peaks = Vec::new();
    for j in 0..residual.ncols() {
        for (at_rest, parts) in [(false, &motion.segments), (true, &rests)] {
            let windows = |t: &Array2<f64>| windows(frame, t.column(j), parts, at_rest);
            let left = windows(residual);
            let Some(mean) = mean(&left) else { continue };
            let own = prominence(&mean, left.len());
            let each: Vec<Vec<f64>> = left.iter().map(|w| prominence(w, 1)).collect();
            let lines = match at_rest {
                false => mean_of(&windows(&predicted)),
                true => None,
            };
            let chance = gamma_quantile(left.len(), s.chance * own.len() as f64);
            let most = own.len().saturating_sub(1);
            for k in (1..most).filter(|&k| own[k] > s.stands_out.max(chance)) {
                let near = |x: &[f64]| x[k - 1..=k + 1].iter().copied().fold(0.0, f64::max);
                let highest = own[k] >= own[k - 1] && own[k] > own[k + 1];
                let motions = lines.as_ref().is_some_and(|l| near(l) > s.motion * own[k]);
                let showing = each.iter().filter(|w| near(w) > s.window * s.stands_out);
                let lasting = showing.count() as f64 > s.lasting * each.len() as f64;
                if highest && !motions && lasting {
                    let found = peak(&mean, &own, k, j, at_rest);
                    peaks.extend(Some(found).filter(|p| p.width < s.narrow * p.frequency));
                }
            }
        }
    }
    together(peaks, names, s.same)
}

/// Maximal runs of samples that satisfy a condition.
fn stretches(range: Range<usize>, holds: &dyn Fn(usize) -> bool) -> Vec<Range<usize>> {
    let mut out: Vec<Range<usize>> = Vec::new();
    for i in range.filter(|&i| holds(i)) {
        match out.last_mut() {
            Some(last) if last.end == i => last.end = i + 1,
            _ => out.push(i..i + 1),
        }
    }
    out
}

/// Spectra of windows that overlap by half, up to the highest searched frequency and its surroundings. None
/// where no stretch holds a window.
fn windows(
    frame: &Frame,
    x: ArrayView1<f64>,
    parts: &[Range<usize>],
    at_rest: bool,
) -> Vec<Spectrum> {
    let (time, rate) = (&frame.samples().time, frame.report().rate_hz);
    let seconds = |p: &&Range<usize>| time[p.end - 1] - time[p.start];
    let longest = parts.iter().map(|p| seconds(&p)).fold(0.0, f64::max);
    let length = (longest / if at_rest { 1.0 } else { FEWEST }).clamp(WINDOW.0, WINDOW.1);
    let n = (length * rate).floor() as usize;
    let most = SEARCHED.1.min(RATE_SHARE * rate) * AROUND;
    let mut out = Vec::new();
    for part in parts.iter().filter(|p| seconds(p) >= length * 0.999) {
        let own: Vec<f64> = part.clone().map(|i| x[i]).collect();
        let at = uniform_grid(time[part.start], time[part.end - 1], 1.0 / rate);
        let even = linear(&time[part.clone()], &own, &at);
        let last = even.len().saturating_sub(n);
        for start in (0..=last)
            .step_by((n / 2).max(1))
            .filter(|s| s + n <= even.len())
        {
            let mut s = welch(&straightened(even[start..start + n].to_vec()), rate, n);
            let keep = s.frequency.iter().filter(|f| **f <= most).count();
            s.frequency.truncate(keep);
            s.density.truncate(keep);
            out.push(s);
        }
    }
    out
}

/// Mean spectrum of windows of equal length.
fn mean(windows: &[Spectrum]) -> Option<Spectrum> {
    let first = windows.first()?;
    let n = windows.len() as f64;
    let at = |k: usize| windows.iter().map(|w| w.density[k]).sum::<f64>() / n;
    Some(Spectrum {
        frequency: first.frequency.clone(),
        density: (0..first.density.len()).map(at).collect(),
    })
}

/// Prominence in the mean spectrum of some windows.
fn mean_of(windows: &[Spectrum]) -> Option<Vec<f64>> {
    mean(windows).map(|m| prominence(&m, windows.len()))
}

/// The signal without its linear trend.
fn straightened(mut x: Vec<f64>) -> Vec<f64> {
    let n = x.len() as f64;
    let middle = 0.5 * (n - 1.0);
    let spread = n * (n * n - 1.0) / 12.0;
    let mean = x.iter().sum::<f64>() / n;
    let slope = x
        .iter()
        .enumerate()
        .map(|(i, v)| (i as f64 - middle) * v)
        .sum::<f64>()
        / spread.max(1e-300);
    for (i, v) in x.iter_mut().enumerate() {
        *v -= mean + slope * (i as f64 - middle);
    }
    x
}

/// Prominence: density over the median of its surroundings, without a window's main lobe. Zero outside the searched frequencies.
fn prominence(spectrum: &Spectrum, windows: usize) -> Vec<f64> {
    const LOBE: usize = 3;
    let (f, d) = (&spectrum.frequency, &spectrum.density);
    let step = f.get(1).copied().unwrap_or(1.0);
    let most = f.last().copied().unwrap_or(0.0) / AROUND;
    // The median of a gamma distribution over its mean (Wilson and Hilferty).
    let middle = (1.0 - 1.0 / (9.0 * independent(windows))).powi(3);
    (0..f.len())
        .map(|k| {
            if f[k] < SEARCHED.0 * step || f[k] > most {
                return 0.0;
            }
            let near = |i: &usize| {
                i.abs_diff(k) > LOBE && f[*i] >= f[k] / AROUND && f[*i] <= f[k] * AROUND
            };
            let around = (1..f.len()).filter(near).map(|i| d[i]).collect();
            median(around).map_or(0.0, |m| d[k] * middle / m.max(1e-300))
        })
        .collect()
}

/// Number of independent windows among windows that overlap by half.
fn independent(windows: usize) -> f64 {
    (0.75 * windows as f64).max(1.0)
}

/// Value that the mean of K exponential variables of mean one exceeds once in `times`, by the tail
/// e^{−Kx} Σ_{i<K} (Kx)^i/i!, K rounded down.
fn gamma_quantile(windows: usize, times: f64) -> f64 {
    let shape = independent(windows).floor() as u32;
    let tail = |x: f64| {
        let y = f64::from(shape) * x;
        let (mut term, mut sum) = (1.0, 1.0);
        for i in 1..shape {
            term *= y / f64::from(i);
            sum += term;
        }
        sum.ln() - y
    };
    let (mut low, mut high) = (1.0, 100.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if tail(middle) > -times.ln() {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

fn peak(spectrum: &Spectrum, own: &[f64], k: usize, joint: usize, at_rest: bool) -> Peak {
    let (f, d) = (&spectrum.frequency, &spectrum.density);
    let step = f[1] - f[0];
    let floor = d[k] / own[k];
    let half = floor + 0.5 * (d[k] - floor);
    let edge = |next: &dyn Fn(usize) -> Option<usize>| {
        let mut at = k;
        while let Some(i) = next(at) {
            if d[i] < half {
                let part = (d[at] - half) / (d[at] - d[i]).max(1e-300);
                return f[at] + part * (f[i] - f[at]);
            }
            at = i;
        }
        f[at]
    };
    let low = edge(&|i| i.checked_sub(1));
    let high = edge(&|i| Some(i + 1).filter(|i| *i < d.len()));
    // Centre of the parabola through the logarithms of the highest three.
    let [a, b, c] = [k - 1, k, k + 1].map(|i| d[i].max(1e-300).ln());
    let shift = 0.5 * (a - c) / (a - 2.0 * b + c).min(-1e-12);
    let inside = (0..d.len()).filter(|&i| f[i] >= low - step && f[i] <= high + step);
    let power: f64 = inside.map(|i| (d[i] - floor).max(0.0) * step).sum();
    Peak {
        joint,
        frequency: f[k] + shift.clamp(-0.5, 0.5) * step,
        width: high - low,
        rms: power.sqrt(),
        at_rest,
    }
}

/// Peaks of all joints merged into resonances where their frequencies differ by at most `same`, relative.
fn together(mut peaks: Vec<Peak>, names: &[String], same: f64) -> Vec<Resonance> {
    peaks.sort_by(|a, b| a.frequency.total_cmp(&b.frequency));
    let mut groups: Vec<Vec<Peak>> = Vec::new();
    for p in peaks {
        match groups.last_mut() {
            Some(g) if p.frequency - g[0].frequency <= same * p.frequency + 0.5 * g[0].width => {
                g.push(p);
            }
            _ => groups.push(vec![p]),
        }
    }
    let one = |group: Vec<Peak>| {
        let power: f64 = group.iter().map(|p| p.rms * p.rms).sum();
        let mean = |of: &dyn Fn(&Peak) -> f64| {
            group.iter().map(|p| p.rms * p.rms * of(p)).sum::<f64>() / power.max(1e-300)
        };
        let shows = |j: &usize| group.iter().any(|p| p.joint == *j);
        let joints: Vec<usize> = (0..names.len()).filter(shows).collect();
        let rms = |j: &usize| {
            let own = group.iter().filter(|p| p.joint == *j);
            own.map(|p| p.rms).fold(0.0, f64::max)
        };
        Resonance {
            frequency: mean(&|p| p.frequency),
            width: mean(&|p| p.width),
            rms: joints.iter().map(rms).collect(),
            joints: joints.iter().map(|&j| names[j].clone()).collect(),
            in_motion: group.iter().any(|p| !p.at_rest),
            at_rest: group.iter().any(|p| p.at_rest),
        }
    };
    groups.into_iter().map(one).collect()
}

#[cfg(test)]
mod tests;
