//! Motion that comes round: averages over its periods, the series of its harmonics, and smoothed torque.

use crate::{Recording, Trajectory, repeats};
use ndarray::Array2;
use signal::harmonics::{Harmonics, HarmonicsError};
use signal::loess::{Loess, LoessError};
use std::ops::Range;

/// Reasons why periods cannot be taken.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PeriodError {
    /// Period that is not a whole number of samples.
    #[error(
        "{file}: a period of {period} s is {samples:.2} samples; runs are averaged sample by sample, so it has to be a whole number"
    )]
    Samples {
        /// Name of the recording with that period.
        file: String,
        /// Period as given, s.
        period: f64,
        /// Period in samples, no whole number.
        samples: f64,
    },
    /// A trajectory of less than one period.
    #[error("{file}, trajectory {label:?}: {seconds:.2} s are less than a period of {period} s")]
    Short {
        /// Name of the recording with the short trajectory.
        file: String,
        /// Label of the trajectory.
        label: String,
        /// Length of the recording, s.
        seconds: f64,
        /// Period as given, s.
        period: f64,
    },
    /// Error of the harmonic series.
    #[error(transparent)]
    Harmonics(#[from] HarmonicsError),
    /// Error of the Loess smoother.
    #[error(transparent)]
    Loess(#[from] LoessError),
}

/// A recording of one run for each motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Averaged {
    /// Recording of the averages.
    pub recording: Recording,
    /// Number of runs that were averaged for each motion.
    pub runs: Vec<usize>,
    /// Deviation of one run's position from the average of all, per joint, rad or m; none where no motion has two runs.
    pub position: Option<Vec<f64>>,
    /// Deviation of one run's torque from the average of all, per joint, N·m or N; none where no motion has two runs.
    pub torque: Option<Vec<f64>>,
}

/// Averages the runs of each motion, sample by sample: x̄(k) = Σ x_s(k)/S (UR5 paper, eq. 13, there with eight
/// runs; COMAU paper, section 3.4, with 25). The variance Σ (x_s(k) − x̄(k))²/(S − 1) over all k is that of the
/// noise where the motion repeats. Runs are the whole periods of `period` seconds within each trajectory, where
/// one is given, and trajectories that repeat a motion ([`repeats::find`]). Samples at the same time since the
/// start of their runs are averaged; a run that lost such a sample does not count in that average, and the
/// others stay where they are. An incomplete last period is not used.
///
/// # Errors
/// A period that is no whole number of samples, or a trajectory of less than one.
pub fn average(recording: &Recording, period: Option<f64>) -> Result<Averaged, PeriodError> {
    let motions = motions(recording, period)?;
    let runs: Vec<usize> = motions.iter().map(|m| m.runs).collect();
    let samples: Vec<&[usize]> = motions
        .iter()
        .flat_map(|m| m.samples.iter().map(Vec::as_slice))
        .collect();
    let mean = |table: &Array2<f64>| {
        let mut out = Array2::zeros((samples.len(), table.ncols()));
        for (mut mean, rows) in out.rows_mut().into_iter().zip(&samples) {
            for row in *rows {
                mean += &table.row(*row);
            }
            mean.mapv_inplace(|v| v / rows.len() as f64);
        }
        out
    };
    let freedom: usize = samples.iter().map(|rows| rows.len() - 1).sum();
    let deviation = |table: &Array2<f64>, mean: &Array2<f64>| {
        (freedom > 0).then(|| {
            let mut squares = vec![0.0; table.ncols()];
            for (mean, rows) in mean.rows().into_iter().zip(&samples) {
                for row in rows.iter().map(|row| table.row(*row)) {
                    for (sum, (x, m)) in squares.iter_mut().zip(row.iter().zip(&mean)) {
                        *sum += (x - m) * (x - m);
                    }
                }
            }
            let of = |sum: &f64| (sum / freedom as f64).sqrt();
            squares.iter().map(of).collect::<Vec<f64>>()
        })
    };
    // The stamps are those of each motion's first run.
    let time = samples.iter().map(|rows| recording.time[rows[0]]).collect();
    let mut first = 0;
    let trajectories = motions.iter().map(|motion| {
        let range = first..first + motion.samples.len();
        first = range.end;
        Trajectory {
            label: motion.label.clone(),
            range,
        }
    });
    let averaged = recording.map_tables(time, trajectories.collect(), mean);
    let torque = recording.tau.as_ref().zip(averaged.tau.as_ref());
    Ok(Averaged {
        position: deviation(&recording.q, &averaged.q),
        torque: torque.and_then(|(all, mean)| deviation(all, mean)),
        recording: averaged,
        runs,
    })
}

/// Runs of one motion, to be averaged.
struct Motion {
    label: String,
    /// Number of runs of the motion.
    runs: usize,
    /// For each sample of the first run its row, followed by the rows of the other runs at the same time since their
    /// start.
    samples: Vec<Vec<usize>>,
}

impl Motion {
    /// Adds a run of these rows, which begins at `start`; rows further than `apart` from every sample of the
    /// first run are left out.
    fn take(&mut self, time: &[f64], rows: Range<usize>, start: f64, apart: f64) {
        self.runs += 1;
        let origin = time[self.samples[0][0]];
        for sample in &mut self.samples {
            let at = start + time[sample[0]] - origin;
            let after = rows.start + time[rows.clone()].partition_point(|t| *t < at);
            let nearest = [after.wrapping_sub(1), after]
                .into_iter()
                .filter(|row| rows.contains(row))
                .map(|row| ((time[row] - at).abs(), row))
                .min_by(|a, b| a.0.total_cmp(&b.0));
            sample.extend(nearest.filter(|(gap, _)| *gap < apart).map(|(_, row)| row));
        }
    }
}

fn motions(recording: &Recording, period: Option<f64>) -> Result<Vec<Motion>, PeriodError> {
    if let Some(period) = period {
        whole(recording, period)?;
    }
    let (time, half) = (&recording.time, 0.5 * recording.median_step());
    let pairs = repeats::find(recording);
    let mut motions: Vec<Motion> = Vec::new();
    let mut place: Vec<usize> = Vec::new();
    for (index, trajectory) in recording.trajectories.iter().enumerate() {
        let range = trajectory.range.clone();
        let start = time[range.start];
        let seconds = time[range.end - 1] - start + 2.0 * half;
        // A period is a whole number of samples to a hundredth of one.
        let runs = period.map_or(1, |length| ((seconds + 0.5 * half) / length) as usize);
        if let (0, Some(period)) = (runs, period) {
            return Err(PeriodError::Short {
                file: recording.source.clone(),
                label: trajectory.label.clone(),
                seconds,
                period,
            });
        }
        let begin = |run: usize| start + run as f64 * period.unwrap_or(seconds);
        let row = |run: usize| {
            let before = |t: &f64| period.is_none() || *t < begin(run) - half;
            match run {
                0 => range.start,
                _ => range.start + time[range.clone()].partition_point(before),
            }
        };
        // The trajectory before that this one repeats.
        let earlier = pairs.iter().find(|(_, later)| *later == index);
        let known = earlier.map(|(earlier, _)| place[*earlier]);
        place.push(known.unwrap_or(motions.len()));
        if known.is_none() {
            motions.push(Motion {
                label: trajectory.label.clone(),
                runs: 1,
                samples: (row(0)..row(1)).map(|row| vec![row]).collect(),
            });
        }
        for run in usize::from(known.is_none())..runs {
            motions[place[index]].take(time, row(run)..row(run + 1), begin(run), half);
        }
    }
    Ok(motions)
}

/// Whether a period is a whole number of samples.
fn whole(recording: &Recording, period: f64) -> Result<(), PeriodError> {
    let samples = period / recording.median_step();
    let each = samples.round();
    if samples.is_finite() && each >= 2.0 && (samples - each).abs() < 0.01 {
        return Ok(());
    }
    Err(PeriodError::Samples {
        file: recording.source.clone(),
        period,
        samples,
    })
}

/// Position, velocity and acceleration of every trajectory as the series of `harmonics` harmonics of its period (none: its own
/// length) nearest to the recorded positions: derivatives without differences of noise (COMAU paper, section 3.3).
///
/// # Errors
/// A trajectory that does not tell such a series.
pub fn as_series(
    recording: &Recording,
    period: Option<f64>,
    harmonics: usize,
) -> Result<Recording, PeriodError> {
    let step = recording.median_step();
    let mut made = recording.clone();
    let shape = recording.q.raw_dim();
    let (mut qd, mut qdd) = (Array2::zeros(shape), Array2::zeros(shape));
    for range in recording.segments() {
        let time = &recording.time[range.clone()];
        let period = period.unwrap_or(range.len() as f64 * step);
        for j in 0..recording.dof() {
            let q: Vec<f64> = range.clone().map(|row| recording.q[(row, j)]).collect();
            let series = Harmonics::fit(time, &q, period, harmonics)?;
            for (row, t) in range.clone().zip(time) {
                let at = (row, j);
                [made.q[at], qd[at], qdd[at]] = series.at(*t);
            }
        }
    }
    (made.qd, made.qdd) = (Some(qd), Some(qdd));
    Ok(made)
}

/// Torque of every trajectory behind robust local regression of degree 2 over `span` samples with five robust passes (UR5 paper,
/// section IV-C: RLOESS of the motor currents, whose span it does not state).
///
/// # Errors
/// A span that does not fit a trajectory.
pub fn smooth_torque(recording: &Recording, span: usize) -> Result<Recording, PeriodError> {
    let mut made = recording.clone();
    let loess = Loess {
        span,
        degree: 2,
        robust: 5,
    };
    if let Some(tau) = &mut made.tau {
        for range in recording.segments() {
            let time = &recording.time[range.clone()];
            for mut column in tau.columns_mut() {
                let raw: Vec<f64> = range.clone().map(|row| column[row]).collect();
                let smooth = loess.smooth(time, &raw)?;
                for (row, value) in range.clone().zip(smooth) {
                    column[row] = value;
                }
            }
        }
    }
    Ok(made)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// Two runs of a period of four samples and a rest: means, and variances with one degree of freedom, by hand.
    #[test]
    fn by_hand() {
        let q = vec![1.0, 2.0, 3.0, 4.0, 3.0, 2.0, 1.0, 4.0, 9.0];
        let tau = Array2::from_shape_vec((9, 1), vec![2.0; 9]).unwrap();
        let time = (0..9).map(|k| 0.5 * f64::from(k)).collect();
        let q = Array2::from_shape_vec((9, 1), q).unwrap();
        let recording = Recording::new("test", time, q, Some(tau));
        let averaged = average(&recording, Some(2.0)).unwrap();
        assert_eq!(averaged.runs, [2]);
        assert_eq!(
            averaged.recording.q.as_slice().unwrap(),
            [2.0, 2.0, 2.0, 4.0]
        );
        assert_eq!(averaged.recording.time, [0.0, 0.5, 1.0, 1.5]);
        // Squares 1 + 1 + 1 + 1 over four degrees of freedom.
        assert_eq!(averaged.position, Some(vec![1.0]));
        assert_eq!(averaged.torque, Some(vec![0.0]));
        averaged.recording.validate().unwrap();
        assert!(matches!(
            average(&recording, Some(0.7)),
            Err(PeriodError::Samples { .. })
        ));
        assert!(matches!(
            average(&recording, Some(20.0)),
            Err(PeriodError::Short { .. })
        ));
    }

    /// One of three runs lost a sample: its later ones stay with those of the others.
    #[test]
    fn a_lost_sample_shifts_nothing() {
        let kept: Vec<u32> = (0..120).filter(|k| *k != 50).collect();
        let time: Vec<f64> = kept.iter().map(|k| 0.01 * f64::from(*k)).collect();
        let wave = |t: f64| (TAU * t / 0.4).sin();
        let q = Array2::from_shape_fn((119, 1), |(k, _)| wave(time[k]));
        let recording = Recording::new("test", time, q, None);
        let averaged = average(&recording, Some(0.4)).unwrap();
        assert_eq!(averaged.runs, [3]);
        assert_eq!(averaged.recording.len(), 40);
        for (t, q) in averaged.recording.time.iter().zip(&averaged.recording.q) {
            assert!((q - wave(*t)).abs() < 1e-12, "{t}: {q}");
        }
        assert!(averaged.position.unwrap()[0] < 1e-12);
    }

    /// Three trajectories, the last of which repeats the first: two motions, and half the difference of the two is the deviation over √2.
    #[test]
    fn trajectories_that_repeat_are_runs() {
        let wave = |k: usize| (0.1 * (k % 60) as f64).sin();
        let other = |k: usize| (0.17 * (k % 60) as f64).cos();
        let q = Array2::from_shape_fn((180, 1), |(k, _)| match k / 60 {
            0 => wave(k),
            1 => other(k),
            _ => wave(k) + 0.002,
        });
        let time = (0..180).map(|k| 0.01 * f64::from(k)).collect();
        let mut recording = Recording::new("test", time, q, None);
        recording.trajectories = (0..3)
            .map(|k| Trajectory {
                label: k.to_string(),
                range: 60 * k..60 * (k + 1),
            })
            .collect();
        let averaged = average(&recording, None).unwrap();
        assert_eq!(averaged.runs, [2, 1]);
        averaged.recording.validate().unwrap();
        assert!((averaged.recording.q[(7, 0)] - wave(7) - 0.001).abs() < 1e-12);
        let deviation = averaged.position.unwrap()[0];
        assert!(
            (deviation - 0.002 / 2f64.sqrt()).abs() < 1e-12,
            "{deviation}"
        );
    }

    #[test]
    fn a_series_has_its_derivatives() {
        let w = TAU / 2.0;
        let time: Vec<f64> = (0..200).map(|k| 0.01 * f64::from(k)).collect();
        let q = Array2::from_shape_fn((200, 1), |(k, _)| (w * time[k]).sin() + 0.2);
        let recording = Recording::new("test", time.clone(), q, None);
        let made = as_series(&recording, None, 3).unwrap();
        let (qd, qdd) = (made.qd.unwrap(), made.qdd.unwrap());
        for (k, t) in time.iter().enumerate() {
            assert!((qd[(k, 0)] - w * (w * t).cos()).abs() < 1e-9);
            assert!((qdd[(k, 0)] + w * w * (w * t).sin()).abs() < 1e-9);
        }
    }

    #[test]
    fn an_outlier_of_torque_goes() {
        let time: Vec<f64> = (0..60).map(|k| 0.01 * f64::from(k)).collect();
        // What a torque has besides, by which the residual of an outlier is judged.
        let noise = |k: usize| 1e-3 * (7.0 * k as f64).sin();
        let of = |(k, _): (usize, usize)| (3.0 * time[k]).sin() + noise(k);
        let mut tau = Array2::from_shape_fn((60, 1), of);
        tau[(30, 0)] += 50.0;
        let recording = Recording::new("test", time, Array2::zeros((60, 1)), Some(tau));
        let smooth = smooth_torque(&recording, 11).unwrap().tau.unwrap();
        assert!(
            (smooth[(30, 0)] - 0.9_f64.sin()).abs() < 1e-2,
            "{}",
            smooth[(30, 0)]
        );
        assert!(smooth_torque(&recording, 2).is_err());
    }
}
