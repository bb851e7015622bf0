//! Columns of each joint's torque: rigid body and friction on a uniform grid.

use ::identify::base::{BaseParameters, Extra};
use datasets::Recording;
use datasets::check::moves;
use datasets::prepare::Prepared;
use ndarray::{Array2, Axis};
use physics::dynamics::{Workspace, inverse_dynamics, regressor};
use physics::robot::{PARAMETERS_PER_LINK, Robot};
use signal::delay::System;
use signal::{Motion, resample, smoother};
use std::ops::Range;

/// Least rate of the rows, Hz: motion and the effect of a delay lie far below half of it.
const RATE: f64 = 100.0;
/// Cut-off of the low-pass of motion, friction and torque, relative to the rows' rate and to the recording's.
/// All that passes is sampled well in both, and hardly any noise of q̈ passes. Where the preparation's cut-off
/// is lower, it applies to the torque as well.
const BAND: [f64; 2] = [0.15, 0.3];
/// Largest number of rows that are used: minutes of motion suffice.
const ROWS: usize = 12_000;

/// Assignment of a recording's columns to the joints, and sign of each position.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::preparation) struct Reading {
    /// Index of each joint's column, for position and torque alike.
    pub order: Vec<usize>,
    /// Whether each joint's position is taken with the opposite sign.
    pub turned: Vec<bool>,
}

impl Reading {
    /// Columns in their order, with their signs.
    pub fn plain(joints: usize) -> Self {
        Self {
            order: (0..joints).collect(),
            turned: vec![false; joints],
        }
    }

    /// Motion with its columns in this order and with these signs.
    fn motion(&self, motion: &Motion) -> Motion {
        let table = |t: &Array2<f64>| {
            let mut own = t.select(Axis(1), &self.order);
            for (mut column, turned) in own.columns_mut().into_iter().zip(&self.turned) {
                if *turned {
                    column.mapv_inplace(|v| -v);
                }
            }
            own
        };
        Motion {
            q: table(&motion.q),
            qd: table(&motion.qd),
            qdd: table(&motion.qdd),
            ..motion.clone()
        }
    }
}

/// Columns and torque of all joints, on common rows.
#[derive(Clone)]
pub(in crate::preparation) struct Systems {
    /// Base parameters of the robot with its rotors.
    pub base: BaseParameters,
    /// Columns by joint; none for a joint that never moves or whose torque keeps one value.
    pub joints: Vec<Option<Joint>>,
    /// Ranges of consecutive rows.
    pub segments: Vec<Range<usize>>,
    /// Time between the rows of each segment, s.
    pub steps: Vec<f64>,
}

/// Columns of one joint, low-passed like its torque.
#[derive(Clone)]
pub(in crate::preparation) struct Joint {
    /// Torque per standard parameter of the links, 10 N columns; empty where it is zero throughout.
    pub standard: Vec<Vec<f64>>,
    /// Torque of the robot as described, counterbalance included, N·m (N).
    pub rigid: Vec<f64>,
    /// Part of the described torque that comes from the last link, by root mean square.
    pub carried: f64,
    /// Acceleration of the joint, the column of rotor inertia.
    pub rotor: Vec<f64>,
    /// Columns of offset (the first) and friction on the joint.
    pub friction: Vec<Vec<f64>>,
    /// Recorded torque of the joint, low-passed, N·m (N).
    pub torque: Vec<f64>,
}

impl Systems {
    /// Systems of a recording; `prepared` is that recording prepared.
    pub fn new(robot: &Robot, recording: &Recording, prepared: &Prepared) -> Option<Self> {
        let plain = Reading::plain(robot.dof());
        Self::read(robot, recording, prepared, &plain, ROWS)
    }

    /// Systems with another assignment of the columns, and about `most` rows.
    pub fn read(
        robot: &Robot,
        recording: &Recording,
        prepared: &Prepared,
        reading: &Reading,
        most: usize,
    ) -> Option<Self> {
        let tau = recording.tau.as_ref()?.select(Axis(1), &reading.order);
        let n = robot.dof();
        let grids = Grids::new(recording, prepared, most)?;
        let motion = &reading.motion(&prepared.fine);
        let width = PARAMETERS_PER_LINK * n;
        let moves: Vec<bool> = reading.order.iter().map(|&j| moves(recording, j)).collect();
        let rows = grids.rows();
        let mut standard = vec![vec![vec![0.0; rows]; width]; n];
        let mut rigid = vec![vec![0.0; rows]; n];
        let (mut y, mut torque) = (vec![0.0; n * width], vec![0.0; n]);
        let mut workspace = Workspace::new(robot);
        let states = [&motion.q, &motion.qd, &motion.qdd].map(|table| {
            let columns = table.columns().into_iter();
            columns
                .map(|c| grids.motion(&c.to_vec()))
                .collect::<Vec<_>>()
        });
        for row in 0..rows {
            // What derivation makes of a joint at rest is noise.
            let of = |state: usize| -> Vec<f64> {
                let joints =
                    (0..n).map(|j| (state == 0 || moves[j]).then_some(states[state][j][row]));
                joints.map(Option::unwrap_or_default).collect()
            };
            let [q, qd, qdd] = [0, 1, 2].map(of);
            regressor(robot, &mut workspace, &q, &qd, &qdd, &mut y);
            inverse_dynamics(robot, &mut workspace, &q, &qd, &qdd, &mut torque);
            for p in robot.passive() {
                torque[p.joint()] += p.torque(q[p.joint()]);
            }
            for j in 0..n {
                rigid[j][row] = torque[j];
                for (column, value) in standard[j].iter_mut().zip(&y[j * width..]) {
                    column[row] = *value;
                }
            }
        }
        let joints = standard
            .into_iter()
            .zip(rigid)
            .enumerate()
            .map(|(j, (standard, rigid))| {
                let measured = tau.column(j).to_vec();
                let dead = measured.iter().all(|t| *t == measured[0]);
                if !moves[j] || dead {
                    return None;
                }
                let fine = |table: &ndarray::Array2<f64>| table.column(j).to_vec();
                let qd = fine(&motion.qd);
                let shows = |c: &Vec<f64>| c.iter().any(|v| v.abs() > 1e-9);
                let carried = carried(&standard, &rigid, &robot.parameters());
                let columns = standard.into_iter();
                Some(Joint {
                    carried,
                    standard: columns
                        .map(|c| if shows(&c) { c } else { Vec::new() })
                        .collect(),
                    rigid,
                    rotor: states[2][j].clone(),
                    friction: friction(&fine(&motion.q), &qd, &motion.segments)
                        .iter()
                        .map(|c| grids.thinned(c))
                        .collect(),
                    torque: grids.torque(recording, prepared, &measured)?,
                })
            })
            .collect();
        Some(Self {
            base: BaseParameters::of_robot(robot, &[Extra::RotorInertia]),
            joints,
            segments: grids.segments.clone(),
            steps: grids.steps.clone(),
        })
    }

    /// Systems with offset, viscous and Coulomb friction alone.
    pub fn with_plain_friction(&self) -> Self {
        let mut plain = self.clone();
        for joint in plain.joints.iter_mut().flatten() {
            joint.friction.truncate(PLAIN);
        }
        plain
    }

    /// Least-squares system of one joint's torque: base parameters, friction and offset.
    pub fn system(&self, joint: &Joint, index: usize) -> System {
        let rigid = joint.standard.len();
        let mut columns: Vec<Vec<f64>> = self
            .base
            .independent()
            .iter()
            .filter(|&&c| c < rigid && !joint.standard[c].is_empty())
            .map(|&c| joint.standard[c].clone())
            .collect();
        if self.base.independent().contains(&(rigid + index)) {
            columns.push(joint.rotor.clone());
        }
        columns.extend(joint.friction.iter().cloned());
        System {
            columns,
            target: joint.torque.clone(),
            segments: self.segments.clone(),
            steps: self.steps.clone(),
        }
    }
}

/// Part of a described torque that comes from the last link, by root mean square.
fn carried(standard: &[Vec<f64>], rigid: &[f64], parameters: &[f64]) -> f64 {
    let first = parameters.len().saturating_sub(PARAMETERS_PER_LINK);
    let last = |row: usize| -> f64 {
        let own = standard[first..].iter().zip(&parameters[first..]);
        own.map(|(column, p)| column[row] * p).sum()
    };
    let (mut own, mut all) = (0.0, 0.0);
    for (row, whole) in rigid.iter().enumerate() {
        own += last(row).powi(2);
        all += whole * whole;
    }
    if all > 0.0 { (own / all).sqrt() } else { 1.0 }
}

/// Number of columns of offset, viscous and Coulomb friction, the first ones.
const PLAIN: usize = 3;
/// Velocities at which friction departs from viscous and Coulomb, relative to the top speed.
const BENDS: [f64; 2] = [0.05, 0.3];
/// Displacements over which friction builds up after a reversal, relative to the range.
const WAYS: [f64; 2] = [0.001, 0.01];

/// Columns of a joint's offset and friction: viscous, Coulomb, odd functions of speed that bend at low speed,
/// and friction that builds up after a reversal. The last looks like a delay of Coulomb friction. With it in
/// the fit the delay is determined by smooth torque and not by reversals.
fn friction(q: &[f64], qd: &[f64], segments: &[Range<usize>]) -> Vec<Vec<f64>> {
    let top = qd.iter().fold(f64::MIN_POSITIVE, |m, v| v.abs().max(m));
    let low = q.iter().copied().fold(f64::INFINITY, f64::min);
    let range = q.iter().fold(0.0_f64, |m, q| m.max(q - low));
    let mut columns = vec![
        vec![1.0; qd.len()],
        qd.to_vec(),
        qd.iter().map(|&v| Extra::Coulomb.value(v, 0.0)).collect(),
    ];
    for bend in BENDS {
        let of = |v: &f64| {
            let x = v / (bend * top);
            x / (1.0 + x * x)
        };
        columns.push(qd.iter().map(of).collect());
    }
    for way in WAYS {
        columns.push(built_up(q, qd, segments, way * range));
    }
    columns
}

/// Deficit of Coulomb friction after a reversal: sign(q̇) minus the state of a bristle that bends over the
/// displacement `way` (Dahl); zero where the joint starts.
fn built_up(q: &[f64], qd: &[f64], segments: &[Range<usize>], way: f64) -> Vec<f64> {
    let mut out = vec![0.0; q.len()];
    for s in segments {
        let mut bent = 0.0;
        let mut last: Option<f64> = None;
        for row in s.clone() {
            let sign = Extra::Coulomb.value(qd[row], 0.0);
            let gone = last.map_or(0.0, |l| (q[row] - l).abs());
            bent = if last.is_none() {
                sign
            } else {
                sign + (bent - sign) * (-gone / way.max(f64::MIN_POSITIVE)).exp()
            };
            last = Some(q[row]);
            out[row] = sign - bent;
        }
    }
    out
}

/// Rows of the systems on the prepared motion: every `stride`-th sample of its fine grid.
struct Grids {
    /// Indices of the trajectories that are used.
    trajectories: Vec<usize>,
    /// Ranges of these trajectories on the fine grid.
    fine: Vec<Range<usize>>,
    /// Number of fine samples from row to row.
    stride: usize,
    /// Rate of the rows, Hz.
    rate_hz: f64,
    /// Cut-off of the low-pass of motion and torque, Hz.
    cutoff_hz: f64,
    /// Whether the prepared motion is already low-passed at or below the cut-off of the rows.
    motion_is_smooth: bool,
    /// Range of the rows of each trajectory.
    segments: Vec<Range<usize>>,
    /// Time between the rows of each trajectory, s.
    steps: Vec<f64>,
}

impl Grids {
    /// Rows of a recording, about `most` of them; none where its rate is unknown.
    fn new(recording: &Recording, prepared: &Prepared, most: usize) -> Option<Self> {
        let fine_hz = prepared.report.fine_hz;
        let stride = ((fine_hz / RATE).floor() as usize).max(1);
        let rate_hz = fine_hz / stride as f64;
        let band_hz = (BAND[0] * rate_hz).min(BAND[1] / recording.median_step());
        let prepared_hz = prepared.report.cutoff_hz.unwrap_or(f64::INFINITY);
        let cutoff_hz = band_hz.min(prepared_hz);
        let (trajectories, fine) = evenly(&prepared.fine.segments, most * stride);
        let (mut segments, mut steps, mut start) = (Vec::new(), Vec::new(), 0);
        for s in &fine {
            let rows = s.len().div_ceil(stride);
            segments.push(start..start + rows);
            let time = &prepared.fine.time;
            let step = (time[s.end - 1] - time[s.start]) / (s.len().max(2) - 1) as f64;
            steps.push(step * stride as f64);
            start += rows;
        }
        (rate_hz.is_finite() && cutoff_hz > 0.0).then_some(Self {
            trajectories,
            fine,
            stride,
            rate_hz,
            cutoff_hz,
            motion_is_smooth: prepared_hz <= band_hz,
            segments,
            steps,
        })
    }

    /// Number of rows.
    fn rows(&self) -> usize {
        self.segments.last().map_or(0, |s| s.end)
    }

    /// Values low-passed at the cut-off of the rows; `rate_hz` is their rate.
    fn low_passed(&self, x: &[f64], rate_hz: f64) -> Vec<f64> {
        // The cut-off is below half of either rate by construction.
        smoother::low_pass(x, self.cutoff_hz, rate_hz).unwrap_or_else(|_| x.to_vec())
    }

    /// Positions or their derivatives on the rows, low-passed where necessary.
    fn motion(&self, column: &[f64]) -> Vec<f64> {
        if !self.motion_is_smooth {
            return self.thinned(column);
        }
        let parts = self.fine.iter();
        parts
            .flat_map(|s| column[s.clone()].iter().step_by(self.stride).copied())
            .collect()
    }

    /// Column of the fine motion, low-passed, on the rows.
    fn thinned(&self, column: &[f64]) -> Vec<f64> {
        let parts = self.fine.iter();
        parts
            .flat_map(|s| {
                let smooth = self.low_passed(&column[s.clone()], self.rate_hz * self.stride as f64);
                smooth.into_iter().step_by(self.stride)
            })
            .collect()
    }

    /// Recorded torque on the fine grid, low-passed, on the rows.
    fn torque(&self, recording: &Recording, prepared: &Prepared, tau: &[f64]) -> Option<Vec<f64>> {
        let mut rows = Vec::with_capacity(self.rows());
        for (&t, s) in self.trajectories.iter().zip(&self.fine) {
            let range = recording.trajectories[t].range.clone();
            let (time, values) = (&recording.time[range.clone()], &tau[range]);
            let fine = resample::cubic(time, values, &prepared.fine.time[s.clone()]).ok()?;
            let smooth = self.low_passed(&fine, self.rate_hz * self.stride as f64);
            rows.extend(smooth.into_iter().step_by(self.stride));
        }
        Some(rows)
    }
}

/// Some stretches, evenly spread, with about `most` samples in all, and their indices; of a longer stretch its beginning.
fn evenly(stretches: &[Range<usize>], most: usize) -> (Vec<usize>, Vec<Range<usize>>) {
    let all: usize = stretches.iter().map(Range::len).sum();
    let every = all.div_ceil(most).clamp(1, stretches.len().max(1));
    let kept = (0..stretches.len()).step_by(every);
    let share = most.div_ceil(stretches.len().div_ceil(every).max(1));
    let of = |k: usize| {
        let s = &stretches[k];
        let end = if all <= most {
            s.end
        } else {
            s.end.min(s.start + share)
        };
        s.start..end
    };
    (kept.clone().collect(), kept.map(of).collect())
}
