//! Preprocessing: from a recording to smooth motion with derivatives.
//!
//! Per trajectory and joint: resample the recorded stamps to a uniform grid, low-pass with zero phase
//! ([`signal::smoother`]), put a quintic spline through the result and take its derivatives. Nothing crosses a
//! break. The docs of [`cutoff`] explain the choice of the cut-off, those of [`fuse`] the use of a recorded
//! velocity.

pub mod cutoff;
mod error;
pub mod fuse;
mod options;
mod report;

pub use error::PrepareError;
pub use options::{Derivatives, PrepareOptions};
pub use report::{PrepareReport, Source};

use crate::Recording;
use cutoff::NoiseFloor;
use ndarray::Array2;
use options::SLOW_HZ;
use signal::spline::Spline;
use signal::{Motion, filter, resample, smoother, sos};
use std::ops::Range;

/// Largest number of points of the fine grid per sample: that of a recording of 0.1 Hz at 100 Hz.
const MOST_POINTS: f64 = 1000.0;

/// Smooth motion of a recording, on a fine uniform grid and at the recorded stamps.
#[derive(Clone, Debug)]
pub struct Prepared {
    /// Motion on a uniform grid per trajectory, at least about `fine_hz`. Non-smooth columns
    /// (sign, hysteresis) are built here.
    pub fine: Motion,
    /// Motion at the recorded stamps: row i belongs to row i of the recording.
    pub at_samples: Motion,
    /// Report of the preparation.
    pub report: PrepareReport,
    torque_sections: Vec<Vec<sos::Section>>,
    torque_delay: f64,
    /// Places of the stamps, less the torque's delay, on the fine grid, by trajectory.
    between: Vec<resample::Between>,
}

/// One trajectory: uniform grid and the grid's step.
struct Grid {
    rows: Range<usize>,
    coarse: Vec<f64>,
    fine: Vec<f64>,
}

/// Prepares a recording.
///
/// # Errors
/// A cut-off or a torque filter that does not fit the rate, stamps in another unit than s, trajectories too short for a
/// spline (the readers refuse those).
pub fn prepare(recording: &Recording, options: &PrepareOptions) -> Result<Prepared, PrepareError> {
    if !(options.fine_hz > 0.0 && options.fine_hz.is_finite()) {
        return Err(PrepareError::FineRate(options.fine_hz));
    }
    let step = recording.median_step();
    let rate_hz = 1.0 / step;
    // Ten percent of slack: a recording at about the fine rate is not doubled.
    let factor = if rate_hz > 0.9 * options.fine_hz {
        1
    } else {
        (options.fine_hz / rate_hz - 1e-3).ceil().max(1.0) as usize
    };
    let grids: Vec<Grid> = recording
        .trajectories
        .iter()
        .map(|t| {
            check_clock(&recording.time, t, step, factor)?;
            Ok(grid(&recording.time, t.range.clone(), step, factor))
        })
        .collect::<Result<_, PrepareError>>()?;
    let slow = rate_hz < SLOW_HZ;
    let fused = fuse_wanted(recording, options, slow);
    let jitter = jitter(recording, step);
    let band = cutoff::floor_band(jitter);

    let mut joints = Vec::with_capacity(recording.dof());
    for j in 0..recording.dof() {
        joints.push(uniform_joint(recording, &grids, j, fused, step, band)?);
    }
    let noise: Vec<NoiseFloor> = if slow {
        Vec::new()
    } else {
        joints.iter().map(|joint| joint.noise.clone()).collect()
    };
    let cutoff_hz = match (options.cutoff_hz, slow) {
        (Some(given), _) => Some(given),
        (None, true) => None,
        (None, false) => Some(cutoff::common(
            &joints.iter().map(|j| &j.cost).collect::<Vec<_>>(),
            rate_hz,
        )),
    };

    let (fine_rows, sample_rows) = (grids.iter().map(|g| g.fine.len()).sum(), recording.len());
    let mut fine = empty_motion(fine_rows, recording.dof());
    let mut at_samples = empty_motion(sample_rows, recording.dof());
    at_samples.time.clone_from(&recording.time);
    at_samples.segments = recording.segments();
    let mut start = 0;
    for g in &grids {
        fine.time.extend_from_slice(&g.fine);
        fine.segments.push(start..start + g.fine.len());
        start += g.fine.len();
    }
    let segments = fine.segments.clone();
    for (j, joint) in joints.iter().enumerate() {
        for ((g, values), segment) in grids.iter().zip(&joint.values).zip(&segments) {
            let smooth = match cutoff_hz {
                Some(hz) => smoother::low_pass(values, hz, rate_hz)?,
                None => values.clone(),
            };
            let label = || label_of(recording, g);
            let spline =
                Spline::quintic(&g.coarse, &smooth).map_err(|source| PrepareError::Spline {
                    label: label(),
                    source,
                })?;
            for (row, &t) in segment.clone().zip(&g.fine) {
                set(&mut fine, row, j, spline.at(t));
            }
            for row in g.rows.clone() {
                set(&mut at_samples, row, j, spline.at(recording.time[row]));
            }
        }
    }
    let (velocity, acceleration) = take_recorded(recording, options, &joints, &mut at_samples);
    let torque_sections = match recording.torque_filter {
        None => Vec::new(),
        Some(f) => fine
            .segments
            .iter()
            .map(|s| {
                let rate = (s.len() - 1) as f64 / (fine.time[s.end - 1] - fine.time[s.start]);
                sos::chebyshev1(f.order, f.ripple_db, f.cutoff_hz, rate)
            })
            .collect::<Result<_, _>>()
            .map_err(PrepareError::TorqueFilter)?,
    };
    let report = PrepareReport {
        rate_hz,
        fine_hz: rate_hz * factor as f64,
        jitter,
        cutoff_hz,
        cutoff_given: options.cutoff_hz.is_some(),
        velocity,
        acceleration,
        noise,
        torque_filter: recording.torque_filter,
    };
    let torque_delay = options.torque_delay;
    let segments = fine.segments.iter().zip(&at_samples.segments);
    let between = segments
        .map(|(f, s)| {
            let stamps = at_samples.time[s.clone()].iter();
            resample::Between::new(&fine.time[f.clone()], stamps.map(|t| t - torque_delay))
        })
        .collect();
    Ok(Prepared {
        fine,
        at_samples,
        report,
        torque_sections,
        torque_delay,
        between,
    })
}

impl Prepared {
    /// Rows of the fine grid that [`Self::to_samples`] needs for every `every`-th sample; all of them where a low-pass runs
    /// over them.
    pub fn rows_for(&self, every: usize) -> Vec<bool> {
        let mut needed = vec![!self.torque_sections.is_empty() || every < 2; self.fine.len()];
        for (f, s) in self.fine.segments.iter().zip(&self.at_samples.segments) {
            let time = &self.fine.time[f.clone()];
            for row in s.clone().filter(|r| r.is_multiple_of(every)) {
                let at = self.at_samples.time[row] - self.torque_delay;
                let right = time.partition_point(|&t| t <= at);
                let last = time.len() - 1;
                needed[f.start + right.saturating_sub(1).min(last)] = true;
                needed[f.start + right.min(last)] = true;
            }
        }
        needed
    }

    /// Takes a torque-like column from the fine grid to the recorded stamps: through the low-pass
    /// of the recorded torque where there is one, then linearly between the two fine points next
    /// to each stamp less the torque's delay. Never over a break: there its first or last value stays.
    ///
    /// # Panics
    /// If the column has not one entry per row of `fine`.
    pub fn to_samples(&self, column: &[f64]) -> Vec<f64> {
        let all = 0..self.fine.segments.len();
        self.to_samples_each(all, &[column]).swap_remove(0)
    }

    /// Takes several columns on some trajectories of the fine grid to the recorded stamps, each as [`Self::to_samples`]
    /// does; the low-pass filters them in one call.
    ///
    /// # Panics
    /// If a column has not one entry per row of these trajectories.
    pub fn to_samples_each(&self, trajectories: Range<usize>, columns: &[&[f64]]) -> Vec<Vec<f64>> {
        let fine = &self.fine.segments[trajectories.clone()];
        let start = fine.first().map_or(0, |s| s.start);
        let rows = fine.last().map_or(0, |s| s.end) - start;
        let whole = columns.iter().all(|c| c.len() == rows);
        assert!(whole, "one entry per row of the fine grid");
        let mut out = vec![Vec::new(); columns.len()];
        for k in trajectories {
            let own = &self.fine.segments[k];
            let parts = columns
                .iter()
                .map(|c| &c[own.start - start..own.end - start]);
            let parts: Vec<&[f64]> = parts.collect();
            let between = &self.between[k];
            let Some(sections) = self.torque_sections.get(k) else {
                let each = out.iter_mut().zip(parts);
                each.for_each(|(out, part)| out.extend(between.of(part)));
                continue;
            };
            for (out, part) in out.iter_mut().zip(filter::filtfilt_each(sections, &parts)) {
                out.extend(between.of(&part));
            }
        }
        out
    }
}

fn empty_motion(rows: usize, dof: usize) -> Motion {
    let table = || Array2::zeros((rows, dof));
    Motion {
        time: Vec::new(),
        segments: Vec::new(),
        q: table(),
        qd: table(),
        qdd: table(),
    }
}

fn set(motion: &mut Motion, row: usize, joint: usize, [q, qd, qdd]: [f64; 3]) {
    motion.q[(row, joint)] = q;
    motion.qd[(row, joint)] = qd;
    motion.qdd[(row, joint)] = qdd;
}

fn label_of(recording: &Recording, grid: &Grid) -> String {
    let of = |t: &&crate::Trajectory| t.range == grid.rows;
    recording
        .trajectories
        .iter()
        .find(of)
        .map_or_else(String::new, |t| t.label.clone())
}

/// Refuses stamps whose grid would have more points than memory.
fn check_clock(
    time: &[f64],
    trajectory: &crate::Trajectory,
    step: f64,
    factor: usize,
) -> Result<(), PrepareError> {
    let own = &time[trajectory.range.clone()];
    let samples = own.len();
    let span = own.last().copied().unwrap_or(f64::NAN) - own.first().copied().unwrap_or(f64::NAN);
    if span / step * factor as f64 <= MOST_POINTS * samples as f64 {
        return Ok(());
    }
    let gaps = own.windows(2).map(|w| w[1] - w[0]);
    let (row, gap) = gaps
        .enumerate()
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .unwrap_or((0, f64::NAN));
    Err(PrepareError::Clock {
        label: trajectory.label.clone(),
        samples,
        span,
        step,
        gap,
        row: trajectory.range.start + row + 2,
    })
}

/// Uniform grids that begin and end exactly with the trajectory.
fn grid(time: &[f64], rows: Range<usize>, step: f64, factor: usize) -> Grid {
    let (first, last) = (time[rows.start], time[rows.end - 1]);
    let intervals = (((last - first) / step).round() as usize)
        .max(rows.len().min(6) - 1)
        .max(1);
    let points = |n: usize| -> Vec<f64> {
        (0..=n)
            .map(|k| first + (last - first) * k as f64 / n as f64)
            .collect()
    };
    Grid {
        coarse: points(intervals),
        fine: points(intervals * factor),
        rows,
    }
}

/// One joint on the coarse grids.
struct UniformJoint {
    values: Vec<Vec<f64>>,
    fused: bool,
    noise: NoiseFloor,
    cost: cutoff::Cost,
}

fn fuse_wanted(recording: &Recording, options: &PrepareOptions, slow: bool) -> bool {
    options.derivatives == Derivatives::Auto && !slow && recording.qd.is_some()
}

fn uniform_joint(
    recording: &Recording,
    grids: &[Grid],
    joint: usize,
    fuse: bool,
    step: f64,
    band: [f64; 2],
) -> Result<UniformJoint, PrepareError> {
    let onto_grid = |table: &Array2<f64>, g: &Grid| {
        let column: Vec<f64> = g.rows.clone().map(|r| table[(r, joint)]).collect();
        resample::cubic(&recording.time[g.rows.clone()], &column, &g.coarse).map_err(|source| {
            PrepareError::Spline {
                label: label_of(recording, g),
                source,
            }
        })
    };
    let position: Vec<Vec<f64>> = grids
        .iter()
        .map(|g| onto_grid(&recording.q, g))
        .collect::<Result<_, _>>()?;
    let (mut noise, cost) = cutoff::position_floor(&position, step, band);
    if let (Some(qd), true) = (&recording.qd, fuse) {
        let velocity: Vec<Vec<f64>> = grids
            .iter()
            .map(|g| onto_grid(qd, g))
            .collect::<Result<_, _>>()?;
        if let Some((values, density)) = fuse::fuse(&position, &velocity, step, &noise, band) {
            noise.velocity_density = Some(density);
            return Ok(UniformJoint {
                values,
                fused: true,
                noise,
                cost,
            });
        }
    }
    Ok(UniformJoint {
        values: position,
        fused: false,
        noise,
        cost,
    })
}

/// Overwrites derivatives at the samples by recorded ones where asked for; returns the source of each.
fn take_recorded(
    recording: &Recording,
    options: &PrepareOptions,
    joints: &[UniformJoint],
    at_samples: &mut Motion,
) -> (Vec<Source>, Source) {
    let as_recorded = options.derivatives == Derivatives::Recorded;
    let source = |recorded: bool, fused: bool| match (recorded, as_recorded, fused) {
        (true, true, _) => Source::Recorded,
        (_, _, true) => Source::Fused,
        (true, false, _) => Source::Replaced,
        (false, ..) => Source::Derived,
    };
    if let (Some(qd), true) = (&recording.qd, as_recorded) {
        at_samples.qd.assign(qd);
    }
    if let (Some(qdd), true) = (&recording.qdd, as_recorded) {
        at_samples.qdd.assign(qdd);
    }
    let velocity = joints
        .iter()
        .map(|j| source(recording.qd.is_some(), j.fused))
        .collect();
    (velocity, source(recording.qdd.is_some(), false))
}

fn jitter(recording: &Recording, step: f64) -> f64 {
    let steps = recording.trajectories.iter().flat_map(|t| {
        recording.time[t.range.clone()]
            .windows(2)
            .map(|w| w[1] - w[0])
    });
    let (mut sum, mut count) = (0.0, 0);
    for s in steps {
        sum += (s - step) * (s - step);
        count += 1;
    }
    (sum / f64::from(count.max(1))).sqrt() / step
}
