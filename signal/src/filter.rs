//! Running a cascade of sections over a signal: causally, or forwards and backwards.

use crate::sos::Section;

/// A causal filter with its state, for samples that arrive one by one.
///
/// Transposed direct form II. The first sample sets the steady state, so that a constant input
/// gives a constant output from the start.
#[derive(Clone, Debug)]
pub struct Causal {
    sections: Vec<Section>,
    state: Vec<[[f64; 1]; 2]>,
    started: bool,
}

impl Causal {
    /// A filter that has seen nothing yet.
    pub fn new(sections: &[Section]) -> Self {
        Self {
            sections: sections.to_vec(),
            state: vec![[[0.0]; 2]; sections.len()],
            started: false,
        }
    }

    /// Takes one sample and returns the filtered one.
    pub fn step(&mut self, x: f64) -> f64 {
        if !self.started {
            self.started = true;
            let steady = steady_state(&self.sections, x);
            self.state = steady.into_iter().map(|z| z.map(|z| [z])).collect();
        }
        let each = self.sections.iter().zip(&mut self.state);
        let [y] = each.fold([x], |x, (s, z)| advance(s, z, x));
        y
    }
}

/// One sample of each of N signals through one section.
#[inline]
fn advance<const N: usize>(s: &Section, z: &mut [[f64; N]; 2], x: [f64; N]) -> [f64; N] {
    let y = std::array::from_fn(|k| s.b[0] * x[k] + z[0][k]);
    // In this order the next sample waits for one product and one difference.
    z[0] = std::array::from_fn(|k| (s.b[1] * x[k] + z[1][k]) - s.a[0] * y[k]);
    z[1] = std::array::from_fn(|k| s.b[2] * x[k] - s.a[1] * y[k]);
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
    let [y] = both_ways(sections, [x]);
    y
}

/// Filters several signals of one length like [`filtfilt`], four at a time, which hides latencies. Results
/// equal those of single signals to the bit.
///
/// # Panics
/// When the signals differ in length.
pub fn filtfilt_each(sections: &[Section], signals: &[&[f64]]) -> Vec<Vec<f64>> {
    let (fours, rest) = signals.as_chunks::<4>();
    let fours = fours.iter().flat_map(|x| both_ways(sections, *x));
    fours
        .chain(rest.iter().map(|x| filtfilt(sections, x)))
        .collect()
}

/// N signals of one length, forwards and backwards.
fn both_ways<const N: usize>(sections: &[Section], x: [&[f64]; N]) -> [Vec<f64>; N] {
    let n = x[0].len();
    assert!(x.iter().all(|x| x.len() == n), "signals of one length");
    if n == 0 {
        return [const { Vec::new() }; N];
    }
    let pad = padding(sections).min(n - 1);
    let before = (1..=pad).rev().map(|k| x.map(|x| 2.0 * x[0] - x[k]));
    let after = (1..=pad).map(|k| x.map(|x| 2.0 * x[n - 1] - x[n - 1 - k]));
    let mut y: Vec<[f64; N]> = Vec::with_capacity(n + 2 * pad);
    y.extend(before);
    y.extend((0..n).map(|i| x.map(|x| x[i])));
    y.extend(after);
    run(sections, &mut y);
    y.reverse();
    run(sections, &mut y);
    std::array::from_fn(|k| y[pad..pad + n].iter().rev().map(|y| y[k]).collect())
}

/// One causal pass in place. All sections take a sample before the next one comes: so they run in parallel,
/// where separate passes would each wait for their own previous sample.
fn run<const N: usize>(sections: &[Section], y: &mut [[f64; N]]) {
    let Some(&first) = y.first() else { return };
    let steady = first.map(|level| steady_state(sections, level));
    let state = |i: usize| [0, 1].map(|z| std::array::from_fn(|k| steady[k][i][z]));
    let mut states: Vec<[[f64; N]; 2]> = (0..sections.len()).map(state).collect();
    for y in y {
        for (s, z) in sections.iter().zip(&mut states) {
            *y = advance(s, z, *y);
        }
    }
}
