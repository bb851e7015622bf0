//! What was commanded and recorded of one joint.

use crate::DecoupledError;
use crate::reference::{Fourier, State};
use datasets::Recording;
use datasets::periods::average;
use faer::Mat;
use identify::least_squares::{Accumulator, SolveOptions, solve};
use ndarray::Array2;
use signal::{filter, sos};
use std::f64::consts::TAU;
use std::path::Path;

/// The COMAU paper's rate and filter.
const PUBLISHED_HZ: f64 = 200.0;
const CUTOFF_HZ: f64 = 80.0;
const RIPPLE_DB: f64 = 0.2;

/// One joint's run at a constant rate.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// Where it came from.
    pub source: String,
    /// Time between samples, s.
    pub step: f64,
    /// What was commanded at each sample: free of noise.
    pub reference: Vec<State>,
    /// The reference's period, s.
    pub period: f64,
    /// Recorded position, rad.
    pub q: Vec<f64>,
    /// Recorded torque, N·m.
    pub tau: Vec<f64>,
}

impl Run {
    /// Number of samples.
    pub fn len(&self) -> usize {
        self.q.len()
    }

    /// Whether it has no sample.
    pub fn is_empty(&self) -> bool {
        self.q.is_empty()
    }

    /// Largest commanded speed, rad/s.
    pub fn speed(&self) -> f64 {
        self.reference.iter().fold(0.0, |m, r| m.max(r[1].abs()))
    }

    /// The run as a recording of one joint: `q1`, `tau1`, `q_ref1`, `qd_ref1`.
    pub fn recording(&self) -> Recording {
        let column = |values: Vec<f64>| {
            let rows = values.len();
            Array2::from_shape_fn((rows, 1), |(k, _)| values[k])
        };
        let of = |place: usize| column(self.reference.iter().map(|r| r[place]).collect());
        let time = (0..self.len()).map(|k| k as f64 * self.step).collect();
        Recording {
            q_ref: Some(of(0)),
            qd_ref: Some(of(1)),
            ..Recording::new(
                &self.source,
                time,
                column(self.q.clone()),
                Some(column(self.tau.clone())),
            )
        }
    }

    /// As the COMAU paper takes its recordings (section 3.4): averaged over the periods, through a Chebyshev low-pass of order 8 at
    /// 80 Hz, forwards and backwards, and thinned to 200 Hz. Beside it how far one period's position and torque are from the average
    /// (rad and N·m; none for a single period). The ripple is not stated: 0.2 dB, of which slow motion keeps its size.
    ///
    /// # Errors
    /// A period that is no whole number of samples, or samples slower than the filter.
    pub fn as_published(&self) -> Result<(Self, Option<[f64; 2]>), DecoupledError> {
        let averaged = average(&self.recording(), Some(self.period))?;
        let every = (1.0 / (PUBLISHED_HZ * self.step)).round().max(1.0) as usize;
        let sections = sos::chebyshev1(8, RIPPLE_DB, CUTOFF_HZ, 1.0 / self.step)?;
        // At rest an even order is at the bottom of its ripple.
        let gain: f64 = sections.iter().map(sos::Section::dc_gain).product();
        let thinned = |table: &Array2<f64>| -> Vec<f64> {
            // Three periods in a row: the filter's ends are outside the middle one.
            let n = table.nrows();
            let thrice: Vec<f64> = (0..3 * n).map(|k| table[(k % n, 0)]).collect();
            let smooth = filter::filtfilt(&sections, &thrice);
            (n..2 * n)
                .step_by(every)
                .map(|k| smooth[k] / gain.powi(2))
                .collect()
        };
        let q = thinned(&averaged.recording.q);
        let run = Self {
            source: self.source.clone(),
            step: self.step * every as f64,
            reference: (0..q.len()).map(|k| self.reference[k * every]).collect(),
            period: self.period,
            tau: averaged
                .recording
                .tau
                .as_ref()
                .map_or_else(Vec::new, thinned),
            q,
        };
        let noise = averaged.position.zip(averaged.torque);
        Ok((run, noise.map(|(q, tau)| [q[0], tau[0]])))
    }

    /// Reads one axis (from 1) of a recording whose commanded position is a Fourier series.
    ///
    /// # Errors
    /// No torque or commanded position, no such axis, another reference than such a series, fewer samples than one period.
    pub fn periodic(
        path: &Path,
        axis: usize,
        fundamental_hz: f64,
        harmonics: usize,
    ) -> Result<Self, DecoupledError> {
        let read = Read::of(path, axis)?;
        let period = 1.0 / fundamental_hz;
        let seconds = read.q.len() as f64 * read.step;
        if seconds < 0.999 * period {
            return Err(read.wrong(format!(
                "{seconds:.1} s are less than one period of {fundamental_hz} Hz; record whole periods, or give --fundamental-hz"
            )));
        }
        let series = fitted(&read.reference, read.step, fundamental_hz, harmonics)?;
        let reference: Vec<State> = (0..read.q.len())
            .map(|k| series.at(k as f64 * read.step))
            .collect();
        let range = |values: &[f64]| {
            let low = values.iter().fold(f64::INFINITY, |m, v| m.min(*v));
            values.iter().fold(f64::NEG_INFINITY, |m, v| m.max(*v)) - low
        };
        let worst = reference
            .iter()
            .zip(&read.reference)
            .fold(0.0_f64, |m, (r, q)| m.max((r[0] - q).abs()));
        let span = range(&read.reference);
        if !(span > 0.0 && worst < 1e-3 * span) {
            return Err(read.wrong(format!(
                "q_ref{axis} is no Fourier series of {harmonics} harmonics of {fundamental_hz} Hz: it is off by up to {worst:.3e} rad of \
                 a span of {span:.3e}; give --fundamental-hz and --harmonics"
            )));
        }
        Ok(Self {
            source: read.source,
            step: read.step,
            reference,
            period,
            q: read.q,
            tau: read.tau,
        })
    }

    /// Reads one axis (from 1) of a recording with commanded position and velocity; the acceleration is the difference of the
    /// latter, which is free of noise.
    ///
    /// # Errors
    /// No torque, commanded position or velocity, no such axis.
    pub fn commanded(path: &Path, axis: usize) -> Result<Self, DecoupledError> {
        let read = Read::of(path, axis)?;
        let Some(v) = &read.velocity else {
            return Err(read.wrong(format!(
                "has no qd_ref{axis}, the commanded velocity, which such a run needs"
            )));
        };
        let last = v.len() - 1;
        let reference = (0..v.len())
            .map(|k| {
                let (a, b) = (k.saturating_sub(1), (k + 1).min(last));
                let acceleration = (v[b] - v[a]) / (read.step * (b - a).max(1) as f64);
                [read.reference[k], v[k], acceleration]
            })
            .collect();
        let seconds = read.q.len() as f64 * read.step;
        Ok(Self {
            reference,
            period: seconds,
            source: read.source,
            step: read.step,
            q: read.q,
            tau: read.tau,
        })
    }
}

/// Columns of a file.
struct Read {
    source: String,
    step: f64,
    q: Vec<f64>,
    tau: Vec<f64>,
    reference: Vec<f64>,
    velocity: Option<Vec<f64>>,
}

impl Read {
    fn of(path: &Path, axis: usize) -> Result<Self, DecoupledError> {
        let options = datasets::ReadOptions {
            torque_needed: true,
            ..datasets::ReadOptions::default()
        };
        let recording = datasets::read(path, &options)?;
        let count = recording.dof();
        if axis == 0 || axis > count {
            return Err(DecoupledError::Axis { axis, count });
        }
        let column = |table: &Array2<f64>| table.column(axis - 1).to_vec();
        let read = Self {
            step: recording.median_step(),
            q: column(&recording.q),
            tau: recording.tau.as_ref().map(column).unwrap_or_default(),
            reference: recording.q_ref.as_ref().map(column).unwrap_or_default(),
            velocity: recording.qd_ref.as_ref().map(column),
            source: recording.source.clone(),
        };
        if read.reference.is_empty() {
            return Err(read.wrong(format!(
                "has no q_ref{axis}, the commanded position, from which a closed loop is told"
            )));
        }
        if recording.trajectories.len() != 1 {
            return Err(read.wrong("holds several trajectories; give one run".into()));
        }
        let even = recording
            .time
            .windows(2)
            .all(|w| ((w[1] - w[0]) / read.step - 1.0).abs() < 0.01);
        if !even || read.q.len() < 1000 {
            return Err(
                read.wrong("needs at least 1000 samples at a constant rate; resample it".into())
            );
        }
        Ok(read)
    }

    fn wrong(&self, problem: String) -> DecoupledError {
        DecoupledError::Recording {
            source_name: self.source.clone(),
            problem,
        }
    }
}

/// The series nearest to commanded positions.
fn fitted(
    positions: &[f64],
    step: f64,
    fundamental_hz: f64,
    harmonics: usize,
) -> Result<Fourier, DecoupledError> {
    let w = |k: usize| TAU * fundamental_hz * (k + 1) as f64;
    let mut rows = Accumulator::new(2 * harmonics + 1);
    for (i, q) in positions.iter().enumerate() {
        let t = i as f64 * step;
        let mut row = vec![1.0];
        for k in 0..harmonics {
            let (sin, cos) = (w(k) * t).sin_cos();
            row.extend([sin / w(k), -cos / w(k)]);
        }
        rows.push(&row, *q, 1.0)?;
    }
    let found = solve(&rows.finish()?, &SolveOptions::default())?.parameters;
    Ok(Fourier {
        fundamental_hz,
        centre: found[0],
        waves: found[1..].chunks(2).map(|w| [w[0], w[1]]).collect(),
    })
}

/// A column as a matrix.
pub(crate) fn column(values: &[f64]) -> Mat<f64> {
    Mat::from_fn(values.len(), 1, |k, _| values[k])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Four periods of 2 s at 1 kHz with alternating noise of 0.01 rad and 3 N·m: the average has none, and each period is that far from
    /// it, 0.01 √(4/3) with three degrees of freedom.
    #[test]
    fn averages_filters_and_thins() {
        let w = TAU / 2.0;
        let time: Vec<f64> = (0..8000).map(|k| 1e-3 * f64::from(k)).collect();
        let sign = |k: usize| {
            if (k / 2000).is_multiple_of(2) {
                1.0
            } else {
                -1.0
            }
        };
        let of = |size: f64| -> Vec<f64> {
            let each = time.iter().enumerate();
            each.map(|(k, t)| (w * t).sin() + size * sign(k)).collect()
        };
        let run = Run {
            source: "test".into(),
            step: 1e-3,
            reference: time.iter().map(|t| [(w * t).sin(), 0.0, 0.0]).collect(),
            period: 2.0,
            q: of(0.01),
            tau: of(3.0),
        };
        let (made, noise) = run.as_published().unwrap();
        assert_eq!((made.len(), made.step), (400, 5e-3));
        let [position, torque] = noise.unwrap();
        let part = (4.0_f64 / 3.0).sqrt();
        assert!((position - 0.01 * part).abs() < 1e-9 && (torque - 3.0 * part).abs() < 1e-6);
        for (q, r) in made.q.iter().zip(&made.reference) {
            assert!((q - r[0]).abs() < 2e-3, "{q} {}", r[0]);
        }
        let slow = Run { step: 1e-2, ..run };
        assert!(slow.as_published().is_err());
    }
}
