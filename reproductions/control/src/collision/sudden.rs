//! What of a torque from outside comes suddenly.

use std::collections::VecDeque;

/// Windows that the last one is held against.
const BEFORE: usize = 3;

/// Mean torque from outside over the last window, less the mean over whichever of the three windows before it is nearest to; nothing
/// where it lies between them.
///
/// Momentum balanced over a window tells the mean torque from outside in it without a filter's tail: with the observer's
/// ṙ = K (τ_ext − r) it is the mean of r plus its change over K times the window. What a model is wrong by changes with position,
/// speed and temperature, over tenths of a second and more, and goes out of the difference; a contact that begins between two
/// windows stands in it whole, against torque noise that both have averaged (the likelihood ratio of a step of unknown size in
/// white noise; Basseville and Nikiforov, "Detection of abrupt changes", 1993, section 2.4). A blow that is over, as friction gives at
/// a reversal, would stand in the difference to one window a second time with the other sign; of three windows, one is without it. A
/// push that lasts goes out after two windows: it is for the detector of the residual itself (a band for contacts and one for
/// collisions: Haddadin, De Luca and Albu-Schäffer, "Robot collisions: a survey", IEEE T-RO 33(6), 2017, section on monitoring
/// signals).
#[derive(Debug, Clone)]
pub struct Sudden {
    /// Samples of a window, and K times its length.
    samples: usize,
    turns: f64,
    /// Residuals of all windows and the sample before, oldest first.
    past: VecDeque<Vec<f64>>,
    value: Vec<f64>,
}

impl Sudden {
    /// For `dof` joints, an observer of gain `gain` in 1/s, windows of `window` seconds (at least a sample) and samples `dt` seconds
    /// apart.
    pub fn new(dof: usize, gain: f64, window: f64, dt: f64) -> Self {
        let samples = ((window / dt).round() as usize).max(1);
        Self {
            samples,
            turns: gain * samples as f64 * dt,
            past: VecDeque::with_capacity((BEFORE + 1) * samples + 2),
            value: vec![0.0; dof],
        }
    }

    /// Starts anew.
    pub fn reset(&mut self) {
        self.past.clear();
        self.value.fill(0.0);
    }

    /// The next sample's sudden part of every joint's observed `residual`, N·m or N; zero until all windows are full.
    pub fn step(&mut self, residual: &[f64]) -> &[f64] {
        let n = self.samples;
        let newest_row = (BEFORE + 1) * n;
        let mut newest = if self.past.len() > newest_row {
            self.past.pop_front().unwrap_or_default()
        } else {
            Vec::with_capacity(residual.len())
        };
        newest.clear();
        newest.extend_from_slice(residual);
        self.past.push_back(newest);
        if self.past.len() <= newest_row {
            return &self.value;
        }
        let past = &self.past;
        let mean = |last: usize, joint: usize| {
            let rows = past.range(last + 1 - n..=last);
            let change = past[last][joint] - past[last - n][joint];
            rows.map(|r| r[joint]).sum::<f64>() / n as f64 + change / self.turns
        };
        for (joint, value) in self.value.iter_mut().enumerate() {
            let last = mean(newest_row, joint);
            let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
            for window in 1..=BEFORE {
                let before = mean(window * n, joint);
                (low, high) = (low.min(before), high.max(before));
            }
            *value = last - last.clamp(low, high);
        }
        &self.value
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An observer of an exact model, 6 N·m from outside from sample 40 on: the difference rises along a line over a window of ten
    /// samples, is whole at its end, and gone after the second.
    #[test]
    fn a_step_stands_whole_between_two_windows() {
        let (gain, dt) = (80.0, 1e-3);
        let mut sudden = Sudden::new(1, gain, 0.01, dt);
        let mut r = 0.0;
        let seen: Vec<f64> = (0..80)
            .map(|k| {
                let outside = if k >= 40 { 6.0 } else { 0.0 };
                // As `Momentum` integrates it.
                r = (r + gain * dt * outside) / (1.0 + gain * dt);
                sudden.step(&[r])[0]
            })
            .collect();
        for (k, value) in seen.iter().enumerate() {
            let since = k as f64 - 39.0;
            let wanted = (0.6 * since).clamp(0.0, 6.0) - (0.6 * (since - 10.0)).clamp(0.0, 6.0);
            assert!((value - wanted).abs() < 1e-9, "{k}: {value} for {wanted}");
        }
        sudden.reset();
        assert_eq!(sudden.step(&[8.0])[0], 0.0);
    }

    /// A blow over one window and back: seen once.
    #[test]
    fn a_blow_has_no_echo() {
        let mut sudden = Sudden::new(1, 1e9, 0.01, 1e-3);
        let blow = |k: i32| if (50..60).contains(&k) { 4.0 } else { 1.0 };
        let seen: Vec<f64> = (0..100).map(|k| sudden.step(&[blow(k)])[0]).collect();
        assert!((seen[59] - 3.0).abs() < 1e-6);
        assert!(seen.iter().all(|v| *v > -1e-6), "{seen:?}");
    }

    /// A drift of 2 N·m a second is 0.02 N·m between windows of 10 ms, whatever its level.
    #[test]
    fn a_drift_goes_out() {
        let mut sudden = Sudden::new(1, 1e9, 0.01, 1e-3);
        let last = (0..50).map(|k| sudden.step(&[30.0 + 2e-3 * f64::from(k)])[0]);
        assert!((last.last().unwrap() - 0.02).abs() < 1e-6);
    }
}
