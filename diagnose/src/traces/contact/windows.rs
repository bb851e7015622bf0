//! Windows of time with the mean residual of each joint, in motion and at rest.

use crate::motion::frame::Frame;
use crate::motion::standing::{Judged, State};
use ndarray::Array2;
use std::ops::Range;

/// Length of a window of the residual, s.
pub(super) const WINDOW: f64 = 0.12;

/// Windows of all trajectories, one after another, with each joint's mean residual.
pub(super) struct Windows {
    /// Range of the recorded samples of each window.
    pub samples: Vec<Range<usize>>,
    /// Mean residual, N·m (N), shape (windows, joints); none where the joint reverses or stops in the window.
    pub mean: Array2<Option<f64>>,
    /// Whether the joint stands throughout the window, shape (windows, joints).
    pub standing: Array2<bool>,
}

impl Windows {
    /// Typical magnitude of a joint's window means, in motion or at rest, N·m (N): robust standard deviation, at least
    /// `least`.
    pub fn usual(&self, joint: usize, standing: bool, least: f64) -> f64 {
        let of = |w: usize| self.mean[[w, joint]].filter(|_| self.standing[[w, joint]] == standing);
        let mut size: Vec<f64> = (0..self.samples.len())
            .filter_map(|w| Some(of(w)?.abs()))
            .collect();
        size.sort_by(f64::total_cmp);
        let middle = size.get(size.len() / 2).copied().unwrap_or(0.0);
        (1.4826 * middle).max(least).max(1e-9)
    }
}

/// Whether window `b` follows `a` without a break between trajectories.
pub(super) fn adjacent(samples: &[Range<usize>], a: usize, b: usize) -> bool {
    a <= b && (a..b).all(|w| samples[w].end == samples[w + 1].start)
}

/// Windows of a residual. Joints in motion have means only with `moving`.
pub(super) fn windows(frame: &Frame, left: &Judged, moving: bool) -> Windows {
    let length = ((WINDOW * frame.report().rate_hz).round() as usize).max(2);
    let samples: Vec<Range<usize>> = frame
        .samples()
        .segments
        .iter()
        .flat_map(|s| {
            (0..s.len() / length).map(move |w| s.start + w * length..s.start + (w + 1) * length)
        })
        .collect();
    let all =
        |w: usize, j: usize, state: State| samples[w].clone().all(|i| left.state[[i, j]] == state);
    let shape = (samples.len(), frame.dof());
    let standing = Array2::from_shape_fn(shape, |(w, j)| all(w, j, State::Standing));
    // Windows with a reversal are left out, as friction makes their residual.
    let qd = &frame.samples().qd;
    let mean = Array2::from_shape_fn(shape, |(w, j)| {
        let turns = || {
            samples[w]
                .clone()
                .any(|i| qd[[i, j]] * qd[[samples[w].start, j]] <= 0.0)
        };
        let seen = standing[[w, j]] || moving && all(w, j, State::Moving) && !turns();
        seen.then(|| {
            samples[w]
                .clone()
                .map(|i| left.departure[[i, j]])
                .sum::<f64>()
                / length as f64
        })
    });
    Windows {
        samples,
        mean,
        standing,
    }
}

/// Whether each sample is in one of the windows with the largest residuals, which a force from outside may have made.
/// They are the part `part` of all windows outside `skipped`, by residual relative to each joint's typical level.
pub fn suspected(frame: &Frame, left: &Judged, skipped: &[bool], part: f64) -> Vec<bool> {
    let windows = windows(frame, left, true);
    let levels: Vec<f64> = (0..frame.dof())
        .map(|j| windows.usual(j, false, 0.0))
        .collect();
    let energy = |w: usize| -> f64 {
        let each = levels.iter().enumerate();
        each.filter_map(|(j, level)| Some((windows.mean[[w, j]]? / level).powi(2)))
            .sum()
    };
    let rest =
        (0..windows.samples.len()).filter(|&w| !windows.samples[w].clone().any(|i| skipped[i]));
    let mut order: Vec<(usize, f64)> = rest.map(|w| (w, energy(w))).collect();
    order.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    let most = (part * order.len() as f64) as usize;
    let mut out = vec![false; frame.tau.nrows()];
    for &(w, _) in order.iter().take(most) {
        out[windows.samples[w].clone()].fill(true);
    }
    out
}
