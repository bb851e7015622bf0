//! A recording on the clocks that the analysis uses: the fine grid of its motion, the recorded
//! stamps, and the thinned rows that are fitted.

use crate::algebra::folds::{Fold, folds};
use crate::motion::scene::Scale;
use crate::motion::sensed::Sensed;
use crate::settings::{LadderSettings, MotionSettings};
use datasets::prepare::{PrepareError, PrepareReport};
use datasets::{PrepareOptions, Prepared, Recording, prepare, repeats};
use model::preparation::cutoff;
use ndarray::{Array1, Array2, ArrayView1, Axis};
use physics::effects::EarlySign;
use signal::Motion;
use signal::filter::{filtfilt, filtfilt_each};
use signal::sos::{Section, butterworth};
use std::ops::Range;

/// Rate of the rows that are fitted, Hz: effects but ripple show below a third of it, and ripple
/// is searched on the recorded samples.
const ANALYSIS_RATE: f64 = 62.5;
/// Cut-off of the low-pass before thinning, relative to the rate of the rows.
const ANALYSIS_CUTOFF: f64 = 0.4;

/// A prepared recording with torque.
#[derive(Clone)]
pub struct Frame {
    prepared: Prepared,
    wide: Option<Motion>,
    sensed: Option<Sensed>,
    /// Recorded torque at the recorded stamps, shape (samples, joints).
    pub tau: Array2<f64>,
    /// Rows that are fitted, by trajectory.
    pub rows: Vec<Range<usize>>,
    folds: Vec<Fold>,
    labels: Vec<String>,
    repeats: Vec<(usize, usize)>,
    lowpass: Option<Vec<Section>>,
    stride: usize,
}

impl Frame {
    /// Prepares a recording and its torque.
    ///
    /// # Errors
    /// As [`prepare()`].
    pub fn new(
        recording: &Recording,
        tau: Array2<f64>,
        options: &PrepareOptions,
    ) -> Result<Self, PrepareError> {
        let prepared = prepare(recording, options)?;
        let rate = prepared.report.rate_hz;
        let stride = ((rate / ANALYSIS_RATE).round() as usize).max(1);
        let band = ANALYSIS_CUTOFF * rate / stride as f64;
        let wide = wide(recording, &prepared, options, band)?;
        let cutoff = prepared.report.cutoff_hz;
        let sensed = Sensed::new(recording, &prepared.fine, options, cutoff, band)?;
        // A recording that was low-passed before it was stored is fitted as it is.
        let lowpass = (stride > 1)
            .then(|| butterworth(4, band, rate).ok())
            .flatten();
        let mut rows = Vec::new();
        let mut start = 0;
        for s in &prepared.at_samples.segments {
            let n = s.len().div_ceil(stride);
            rows.push(start..start + n);
            start += n;
        }
        let gap = cutoff::gap(&PrepareOptions {
            cutoff_hz: prepared.report.cutoff_hz,
            ..*options
        });
        Ok(Self {
            folds: folds(recording, &rows, stride, gap),
            prepared,
            wide,
            sensed,
            tau,
            rows,
            labels: recording
                .trajectories
                .iter()
                .map(|t| t.label.clone())
                .collect(),
            repeats: repeats::find(recording),
            lowpass,
            stride,
        })
    }

    /// Recording as prepared, from which the frame is made.
    pub fn prepared(&self) -> &Prepared {
        &self.prepared
    }

    /// Folds of the fitted rows: each is left out as a whole. They are trajectories of one motion, or blocks of
    /// time where there are few motions.
    pub fn folds(&self) -> &[Fold] {
        &self.folds
    }

    /// Pairs of trajectories that execute one motion, each with the next one of it.
    pub fn repeats(&self) -> &[(usize, usize)] {
        &self.repeats
    }

    /// Label of a trajectory, by index.
    pub fn label(&self, trajectory: usize) -> &str {
        self.labels.get(trajectory).map_or("", String::as_str)
    }

    /// Recorded samples of some fitted rows of one trajectory.
    pub fn samples_of(&self, rows: Range<usize>) -> Range<usize> {
        let own = self.rows.iter().zip(&self.samples().segments);
        for (trajectory, samples) in own {
            if rows.start >= trajectory.start && rows.end <= trajectory.end {
                let at = |row: usize| samples.start + (row - trajectory.start) * self.stride;
                let end = if rows.end == trajectory.end {
                    samples.end
                } else {
                    at(rows.end)
                };
                return at(rows.start)..end;
            }
        }
        0..0
    }

    /// Motion of the recording on the fine grid.
    pub fn motion(&self) -> &Motion {
        &self.prepared.fine
    }

    /// Motion on the same grid in the whole band of the rows. The cut-off that suits the torque removes motion
    /// that drives a transmission.
    pub fn wide(&self) -> Option<&Motion> {
        self.wide.as_ref()
    }

    /// Signals of sensors beside the motors' encoders, where there were any.
    pub fn sensed(&self) -> Option<&Sensed> {
        self.sensed.as_ref()
    }

    /// Motion at the recorded stamps.
    pub fn samples(&self) -> &Motion {
        &self.prepared.at_samples
    }

    /// Report of the preparation.
    pub fn report(&self) -> &PrepareReport {
        &self.prepared.report
    }

    /// Number of rows that are fitted.
    pub fn len(&self) -> usize {
        self.rows.last().map_or(0, |r| r.end)
    }

    /// Whether the frame has no fitted row.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Number of joints of the robot.
    pub fn dof(&self) -> usize {
        self.tau.ncols()
    }

    /// Rate of the fitted rows, Hz.
    pub fn row_rate(&self) -> f64 {
        self.report().rate_hz / self.stride as f64
    }

    /// Whether the recording is too short for surrogates: it has fewer stretches than they need.
    pub fn is_short(&self, settings: &LadderSettings) -> bool {
        (self.len() as f64) < settings.fewest * settings.stretch * self.row_rate()
    }

    /// A torque at the recorded samples reduced to the fitted rows: low-passed within each trajectory, then thinned out.
    pub fn thin(&self, samples: &[f64]) -> Array1<f64> {
        let Some(lowpass) = &self.lowpass else {
            return Array1::from(samples.to_vec());
        };
        let mut out = Vec::with_capacity(self.len());
        for s in &self.samples().segments {
            out.extend(
                filtfilt(lowpass, &samples[s.clone()])
                    .into_iter()
                    .step_by(self.stride),
            );
        }
        Array1::from(out)
    }

    /// Values at the recorded samples picked for the fitted rows, without filtering.
    pub fn pick<T>(&self, at: impl Fn(usize) -> T) -> Vec<T> {
        self.samples()
            .segments
            .iter()
            .flat_map(|s| s.clone().step_by(self.stride))
            .map(at)
            .collect()
    }

    /// A column at the fine rate resampled to the recorded stamps, with the torque's filter.
    pub fn to_samples(&self, fine: &Array1<f64>) -> Vec<f64> {
        let whole = fine.as_standard_layout();
        let values = whole.as_slice().expect("a column in standard layout");
        self.prepared.to_samples(values)
    }

    /// Columns on the fine grid of some trajectories resampled to the recorded stamps, with the torque's filter.
    pub fn resample(&self, trajectories: Range<usize>, fine: &[&Array1<f64>]) -> Vec<Array1<f64>> {
        let fine: Vec<&[f64]> = fine
            .iter()
            .map(|c| c.as_slice().expect("a new column is in one piece"))
            .collect();
        let samples = self.prepared.to_samples_each(trajectories, &fine);
        samples.into_iter().map(Array1::from).collect()
    }

    /// Columns on the fine grid of some trajectories reduced to their fitted rows; the low-pass filters them in one call.
    pub fn reduce(&self, trajectories: Range<usize>, fine: &[&Array1<f64>]) -> Vec<Array1<f64>> {
        let samples = self.resample(trajectories.clone(), fine);
        let Some(lowpass) = &self.lowpass else {
            return samples;
        };
        let segments = &self.samples().segments[trajectories];
        let start = segments.first().map_or(0, |s| s.start);
        let mut out = vec![Vec::new(); fine.len()];
        for s in segments {
            let own = s.start - start..s.end - start;
            let parts: Vec<&[f64]> = samples
                .iter()
                .map(|x| &x.as_slice().expect("a new column is in one piece")[own.clone()])
                .collect();
            for (out, y) in out.iter_mut().zip(filtfilt_each(lowpass, &parts)) {
                out.extend(y.into_iter().step_by(self.stride));
            }
        }
        out.into_iter().map(Array1::from).collect()
    }

    /// A table at the fine rate resampled to the recorded samples, shape (samples, joints).
    pub fn table_to_samples(&self, fine: &Array2<f64>) -> Array2<f64> {
        let mut out = Array2::zeros(self.tau.dim());
        for (j, column) in fine.columns().into_iter().enumerate() {
            out.column_mut(j)
                .assign(&Array1::from(self.to_samples(&column.to_owned())));
        }
        out
    }

    /// A table at the recorded samples reduced to the fitted rows, shape (rows, joints).
    pub fn table_thin(&self, samples: &Array2<f64>) -> Array2<f64> {
        let mut out = Array2::zeros((self.len(), samples.ncols()));
        for (j, column) in samples.columns().into_iter().enumerate() {
            out.column_mut(j).assign(&self.thin(&column.to_vec()));
        }
        out
    }

    /// Whether each row of each joint lies at a reversal, shape (rows, joints).
    pub fn reversals(&self, settings: &MotionSettings) -> Array2<bool> {
        self.slow(
            settings.reversal_speed,
            (settings.reversal_time * self.row_rate()).ceil() as usize,
        )
    }

    /// Rows slower than `speed`, rad/s (m/s), or crossing zero velocity, and `reach` rows on either side.
    fn slow(&self, speed: f64, reach: usize) -> Array2<bool> {
        let qd = self.samples().qd.select(Axis(0), &self.pick(|i| i));
        turning(&qd, &self.rows, speed, reach)
    }

    /// Whether each recorded sample lies at a reversal of a joint, as far as the low-pass smears it, shape (samples, joints).
    pub fn samples_at_reversals(&self, settings: &MotionSettings) -> Array2<bool> {
        let reach = (settings.reversal_time * self.report().rate_hz).ceil() as usize;
        let motion = self.samples();
        turning(&motion.qd, &motion.segments, settings.reversal_speed, reach)
    }

    /// Number of rows from each row to the nearest one in which the joint reverses or stands, shape (rows,
    /// joints). The trajectory's length where it does neither.
    pub fn rows_to_turns(&self, speed: f64) -> Array2<usize> {
        let turning = self.slow(speed, 0);
        let mut out = Array2::zeros(turning.dim());
        for (j, mut out) in out.columns_mut().into_iter().enumerate() {
            for range in &self.rows {
                let mut pass = |rows: &mut dyn Iterator<Item = usize>, first: bool| {
                    let mut far = range.len();
                    for i in rows {
                        far = if turning[[i, j]] { 0 } else { far + 1 };
                        out[i] = if first { far } else { far.min(out[i]) };
                    }
                };
                pass(&mut range.clone(), true);
                pass(&mut range.clone().rev(), false);
            }
        }
        out
    }

    /// Weights of the rows, shape (rows, joints).
    pub fn weights(&self, settings: &MotionSettings) -> Array2<f64> {
        // A slow recording shows every reversal whole, but what a standing joint holds depends on how it came there: that
        // error must not hide what is wrong in motion.
        let (speed, weight) = match &self.lowpass {
            None => (settings.reversal_speed, settings.standstill_weight),
            Some(_) => (settings.crossing_speed, settings.crossing_weight),
        };
        self.slow(speed, 0).mapv(|r| if r { weight } else { 1.0 })
    }

    /// Sizes for the grids of shape parameters. `others` are recordings of the same session, `signs` each
    /// joint's sign of friction.
    pub fn scale(&self, others: &[&Frame], signs: &[EarlySign]) -> Scale {
        let m = self.samples();
        let rms = |x: ArrayView1<f64>| (x.dot(&x) / x.len().max(1) as f64).sqrt().max(1e-9);
        let spread = |x: ArrayView1<f64>| x.std(0.0).max(1e-9);
        let bounds = |x: &mut dyn Iterator<Item = f64>| {
            x.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| {
                (a.min(x), b.max(x))
            })
        };
        let frames = || std::iter::once(self).chain(others.iter().copied());
        let fine = &self.motion().time;
        Scale {
            softness: signs.iter().map(|s| s.velocity).collect(),
            lead: signs.iter().map(|s| s.lead).collect(),
            speed: m.qd.columns().into_iter().map(rms).collect(),
            range: m
                .q
                .columns()
                .into_iter()
                .map(|q| bounds(&mut q.iter().copied()))
                .collect(),
            torque: self.tau.columns().into_iter().map(spread).collect(),
            session: bounds(&mut frames().flat_map(|f| f.samples().time.iter().copied())),
            step: if fine.len() > 1 {
                fine[1] - fine[0]
            } else {
                0.01
            },
            channel: None,
            correlation_rows: None,
        }
    }
}

/// Samples at which a joint is slower than `speed` or its velocity crosses zero, and those within `reach` on
/// either side in the same stretch; shape of `qd`.
fn turning(qd: &Array2<f64>, stretches: &[Range<usize>], speed: f64, reach: usize) -> Array2<bool> {
    let mut out = Array2::from_elem(qd.dim(), false);
    for (j, qd) in qd.columns().into_iter().enumerate() {
        for range in stretches {
            for i in range.clone() {
                let crossed = i + 1 < range.end && qd[i] * qd[i + 1] < 0.0;
                if qd[i].abs() < speed || crossed {
                    let first = i.saturating_sub(reach).max(range.start);
                    (first..(i + reach + 1).min(range.end)).for_each(|k| out[[k, j]] = true);
                }
            }
        }
    }
    out
}

/// Motion in the band of the rows, where the motion's cut-off is below it; else none.
fn wide(
    recording: &Recording,
    prepared: &Prepared,
    options: &PrepareOptions,
    band: f64,
) -> Result<Option<Motion>, PrepareError> {
    let below = |own: f64| own < band;
    if !prepared.report.cutoff_hz.is_some_and(below) {
        return Ok(None);
    }
    let options = PrepareOptions {
        cutoff_hz: Some(band),
        ..*options
    };
    Ok(Some(prepare(recording, &options)?.fine))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_are_counted_from_on_both_sides() {
        // A joint turns round every second; another never does.
        let time: Vec<f64> = (0..=400).map(|i| 0.01 * f64::from(i)).collect();
        let q = Array2::from_shape_fn((401, 2), |(i, j)| match j {
            0 => 1.0 - (std::f64::consts::PI * time[i]).cos(),
            _ => time[i],
        });
        let tau = Array2::from_shape_fn((401, 2), |(i, _)| time[i].sin());
        let recording = Recording::new("r", time, q, Some(tau.clone()));
        let frame = Frame::new(&recording, tau, &PrepareOptions::low_passed(8.0)).unwrap();
        let rows = frame.rows_to_turns(0.05);
        let at = |s: f64| (s * frame.row_rate()).round() as usize;
        assert_eq!(rows[[at(1.0), 0]], 0);
        // The turn itself is one row.
        let near = [0.8, 1.2].map(|s| rows[[at(s), 0]] as f64 / frame.row_rate());
        assert!(
            near.iter()
                .all(|t| (t - 0.2).abs() < 1.5 / frame.row_rate()),
            "{near:?}"
        );
        assert!(rows.column(1).iter().all(|r| *r >= frame.len()));
    }
}
