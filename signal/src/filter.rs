//! Running a cascade of sections over a signal: causally, or forwards and backwards.

use crate::sos::Section;

/// A causal filter with its state, for samples that arrive one by one.
///
/// Transposed direct form II. The first sample sets the steady state, so that a constant input
/// gives a constant output from the start.
#[derive(Clone, Debug)]
pub struct Causal {
    sections: Vec<Section>,
    state: Vec<[f64; 2]>,
    started: bool,
}

impl Causal {
    /// A filter that has seen nothing yet.
    pub fn new(sections: &[Section]) -> Self {
        Self {
            sections: sections.to_vec(),
            state: vec![[0.0; 2]; sections.len()],
            started: false,
        }
    }

    /// Takes one sample and returns the filtered one.
    pub fn step(&mut self, x: f64) -> f64 {
        if !self.started {
            self.started = true;
            self.state = steady_state(&self.sections, x);
        }
        self.sections
            .iter()
            .zip(&mut self.state)
            .fold(x, |x, (s, z)| advance(s, z, x))
    }
}

/// One sample through one section.
#[inline]
fn advance(s: &Section, z: &mut [f64; 2], x: f64) -> f64 {
    let y = s.b[0] * x + z[0];
    z[0] = s.b[1] * x - s.a[0] * y + z[1];
    z[1] = s.b[2] * x - s.a[1] * y;
    y
}

/// State of every section after an endless constant input `level` (`scipy.signal.sosfilt_zi`).
fn steady_state(sections: &[Section], level: f64) -> Vec<[f64; 2]> {
    let mut level = level;
    sections
        .iter()
        .map(|s| {
            let x = level;
            level *= s.dc_gain();
            [level - s.b[0] * x, s.b[2] * x - s.a[1] * level]
        })
        .collect()
}

/// Filters causally from rest in the steady state of the first sample.
pub fn filter(sections: &[Section], x: &[f64]) -> Vec<f64> {
    let mut causal = Causal::new(sections);
    x.iter().map(|&v| causal.step(v)).collect()
}

/// Samples of padding that [`filtfilt`] puts on each side (SciPy's default).
///
/// A signal must be longer than this for the padding to be complete.
pub fn padding(sections: &[Section]) -> usize {
    let first_order = sections
        .iter()
        .filter(|s| s.b[2] == 0.0 && s.a[1] == 0.0)
        .count();
    3 * (2 * sections.len() + 1 - first_order)
}

/// Zero-phase filtering: forwards, then backwards, as `scipy.signal.sosfiltfilt`.
///
/// The signal is extended oddly about its end points (2x₀ − x_k) by [`padding`] samples, and both
/// passes start in the steady state. A signal that is not longer than the padding is extended
/// by all it has.
pub fn filtfilt(sections: &[Section], x: &[f64]) -> Vec<f64> {
    let (Some(&first), Some(&last)) = (x.first(), x.last()) else {
        return Vec::new();
    };
    let n = x.len();
    let pad = padding(sections).min(n - 1);
    let mut y: Vec<f64> = Vec::with_capacity(n + 2 * pad);
    y.extend((1..=pad).rev().map(|k| 2.0 * first - x[k]));
    y.extend_from_slice(x);
    y.extend((1..=pad).map(|k| 2.0 * last - x[n - 1 - k]));
    run(sections, &mut y);
    y.reverse();
    run(sections, &mut y);
    y.reverse();
    y.truncate(n + pad);
    y.drain(..pad);
    y
}

/// One causal pass in place, section by section.
fn run(sections: &[Section], y: &mut [f64]) {
    let Some(&first) = y.first() else { return };
    let states = steady_state(sections, first);
    for (s, mut z) in sections.iter().zip(states) {
        for v in y.iter_mut() {
            *v = advance(s, &mut z, *v);
        }
    }
}
