//! The recording itself.

use crate::TorqueFilter;
use ndarray::{Array2, Axis, concatenate};
use std::ops::Range;

/// Least number of samples of a trajectory: the padding of the zero-phase filters needs 16 (order 4), the
/// quintic spline 6, and a cut-off cannot be judged on less.
pub const MIN_SAMPLES: usize = 20;

/// One trajectory of a recording: rows between two breaks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Trajectory {
    /// Label of the trajectory in the file; `"0"` in a file without labels. Two trajectories may carry the same label
    /// when it comes back later in the file or when the clock jumps inside it.
    pub label: String,
    /// Range of the recording's rows.
    pub range: Range<usize>,
}

/// Motion and torque of one robot, as recorded.
///
/// Tables have shape (samples, joints), in SI units, joints base first. Every value is finite and
/// `time` increases strictly within each trajectory: the readers refuse anything else, and
/// [`Recording::validate`] checks recordings made in code.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// Source of the recording, for messages: a path or the name of a simulation.
    pub source: String,
    /// Time stamp of each sample, s.
    pub time: Vec<f64>,
    /// Trajectories in row order; they cover all rows without gaps.
    pub trajectories: Vec<Trajectory>,
    /// Joint position (motor side divided by the gear ratio), rad or m.
    pub q: Array2<f64>,
    /// Joint position measured on the link side.
    pub ql: Option<Array2<f64>>,
    /// Recorded joint velocity, rad/s or m/s; `None` when it has to be derived.
    pub qd: Option<Array2<f64>>,
    /// Recorded joint acceleration, rad/s² or m/s²; `None` when it has to be derived.
    pub qdd: Option<Array2<f64>>,
    /// Measured joint torque in link-side units, N·m or N.
    pub tau: Option<Array2<f64>>,
    /// Commanded position, rad (m), samples × joints.
    pub q_ref: Option<Array2<f64>>,
    /// Commanded velocity, rad/s (m/s), samples × joints.
    pub qd_ref: Option<Array2<f64>>,
    /// Torque that the controller adds to its own law, N·m (N) at the joint, samples × joints.
    pub tau_ff: Option<Array2<f64>>,
    /// Joint temperature, °C, samples × joints.
    pub temp: Option<Array2<f64>>,
    /// Low-pass that `tau` went through before it was stored.
    pub torque_filter: Option<TorqueFilter>,
    /// Choices of the reader that the user should know.
    pub notes: Vec<String>,
}

/// Reasons why a recording made in code is invalid.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Invalid {
    /// A table has another shape than `q`.
    #[error("`{0}` does not have the shape (samples, joints) of `q` and `time`")]
    Shape(&'static str),
    /// The trajectories leave a gap, overlap or are empty.
    #[error("trajectory {0} does not start where the one before it ends, or is empty")]
    Trajectories(usize),
    /// Time does not increase within a trajectory.
    #[error("time does not increase at row {0}")]
    Time(usize),
    /// A value is NaN or infinite.
    #[error("`{0}` has a value that is not finite")]
    NotFinite(&'static str),
}

impl Recording {
    /// A recording of positions and torques alone, as one trajectory labelled `"0"`.
    pub fn new(source: &str, time: Vec<f64>, q: Array2<f64>, tau: Option<Array2<f64>>) -> Self {
        let rows = time.len();
        Self {
            source: source.to_owned(),
            time,
            trajectories: vec![Trajectory {
                label: "0".to_owned(),
                range: 0..rows,
            }],
            q,
            ql: None,
            qd: None,
            qdd: None,
            tau,
            q_ref: None,
            qd_ref: None,
            tau_ff: None,
            temp: None,
            torque_filter: None,
            notes: Vec::new(),
        }
    }

    /// Number of samples of the recording.
    pub fn len(&self) -> usize {
        self.time.len()
    }

    /// Whether the recording has no sample.
    pub fn is_empty(&self) -> bool {
        self.time.is_empty()
    }

    /// Number of joints of the recording.
    pub fn dof(&self) -> usize {
        self.q.ncols()
    }

    /// Row ranges of the trajectories, as [`signal::Motion::segments`] has them.
    pub fn segments(&self) -> Vec<Range<usize>> {
        self.trajectories.iter().map(|t| t.range.clone()).collect()
    }

    /// First row of each trajectory.
    pub fn starts(&self) -> Vec<usize> {
        self.trajectories.iter().map(|t| t.range.start).collect()
    }

    /// Median time step within trajectories in s; NaN when no trajectory has two samples.
    pub fn median_step(&self) -> f64 {
        let mut steps: Vec<f64> = self
            .trajectories
            .iter()
            .flat_map(|t| self.time[t.range.clone()].windows(2).map(|w| w[1] - w[0]))
            .collect();
        if steps.is_empty() {
            return f64::NAN;
        }
        let middle = steps.len() / 2;
        *steps.select_nth_unstable_by(middle, f64::total_cmp).1
    }

    /// The optional tables by name.
    pub(crate) fn optional_tables(&self) -> [(&'static str, &Option<Array2<f64>>); 8] {
        [
            ("ql", &self.ql),
            ("qd", &self.qd),
            ("qdd", &self.qdd),
            ("tau", &self.tau),
            ("q_ref", &self.q_ref),
            ("qd_ref", &self.qd_ref),
            ("tau_ff", &self.tau_ff),
            ("temp", &self.temp),
        ]
    }

    /// Checks shapes, trajectories, time and finiteness.
    ///
    /// # Errors
    /// The first thing found wrong.
    pub fn validate(&self) -> Result<(), Invalid> {
        let shape = (self.len(), self.dof());
        let tables = self.optional_tables();
        let present = tables
            .iter()
            .filter_map(|(name, table)| Some((*name, table.as_ref()?)));
        for (name, table) in std::iter::once(("q", &self.q)).chain(present) {
            if table.dim() != shape {
                return Err(Invalid::Shape(name));
            }
            if table.iter().any(|v| !v.is_finite()) {
                return Err(Invalid::NotFinite(name));
            }
        }
        if self.time.iter().any(|t| !t.is_finite()) {
            return Err(Invalid::NotFinite("time"));
        }
        let mut end = 0;
        for (i, t) in self.trajectories.iter().enumerate() {
            if t.range.start != end || t.range.is_empty() {
                return Err(Invalid::Trajectories(i));
            }
            end = t.range.end;
        }
        if end != self.len() {
            return Err(Invalid::Trajectories(self.trajectories.len()));
        }
        for t in &self.trajectories {
            for row in t.range.clone().skip(1) {
                if self.time[row] <= self.time[row - 1] {
                    return Err(Invalid::Time(row));
                }
            }
        }
        Ok(())
    }

    /// The recording with only these trajectories, in the order given.
    ///
    /// # Panics
    /// If an index is not below `trajectories.len()`.
    pub fn select(&self, trajectories: &[usize]) -> Self {
        let whole = |&i: &usize| (i, self.trajectories[i].range.clone());
        self.stretches(&trajectories.iter().map(whole).collect::<Vec<_>>())
    }

    /// The recording with only these rows of trajectories (index, rows of the recording), each stretch a trajectory
    /// of its own, in the order given.
    ///
    /// # Panics
    /// If an index is not below `trajectories.len()`, or a row not below `len()`.
    pub fn stretches(&self, stretches: &[(usize, Range<usize>)]) -> Self {
        let rows: Vec<usize> = stretches.iter().flat_map(|(_, r)| r.clone()).collect();
        let mut start = 0;
        let kept = stretches
            .iter()
            .map(|(i, rows)| {
                let range = start..start + rows.len();
                start = range.end;
                Trajectory {
                    label: self.trajectories[*i].label.clone(),
                    range,
                }
            })
            .collect();
        let time = rows.iter().map(|&r| self.time[r]).collect();
        self.map_tables(time, kept, |table| table.select(Axis(0), &rows))
    }

    /// The recording with each of its tables mapped, whose rows are then at `time` and in `trajectories`.
    pub(crate) fn map_tables(
        &self,
        time: Vec<f64>,
        trajectories: Vec<Trajectory>,
        map: impl Fn(&Array2<f64>) -> Array2<f64>,
    ) -> Self {
        let some = |table: &Option<Array2<f64>>| table.as_ref().map(&map);
        Self {
            source: self.source.clone(),
            time,
            trajectories,
            q: map(&self.q),
            ql: some(&self.ql),
            qd: some(&self.qd),
            qdd: some(&self.qdd),
            tau: some(&self.tau),
            q_ref: some(&self.q_ref),
            qd_ref: some(&self.qd_ref),
            tau_ff: some(&self.tau_ff),
            temp: some(&self.temp),
            torque_filter: self.torque_filter,
            notes: self.notes.clone(),
        }
    }

    /// Joins several recordings of one robot into one with all trajectories, in the order given. Optional
    /// tables that one of them lacks are left out; none for no recording.
    ///
    /// # Panics
    /// If their numbers of joints differ.
    pub fn joined(all: &[Self]) -> Option<Self> {
        let (first, others) = all.split_first()?;
        let mut out = first.clone();
        for next in others {
            let start = out.len();
            out.trajectories
                .extend(next.trajectories.iter().map(|t| Trajectory {
                    label: t.label.clone(),
                    range: start + t.range.start..start + t.range.end,
                }));
            out.time.extend_from_slice(&next.time);
            let both = |a: &Array2<f64>, b: &Array2<f64>| {
                concatenate(Axis(0), &[a.view(), b.view()])
                    .expect("recordings of one robot have the same joints")
            };
            let some = |a: &Option<Array2<f64>>, b: &Option<Array2<f64>>| {
                Some(both(a.as_ref()?, b.as_ref()?))
            };
            out.q = both(&out.q, &next.q);
            out.tau = some(&out.tau, &next.tau);
            out.qd = some(&out.qd, &next.qd);
            out.qdd = some(&out.qdd, &next.qdd);
            out.ql = some(&out.ql, &next.ql);
            out.q_ref = some(&out.q_ref, &next.q_ref);
            out.qd_ref = some(&out.qd_ref, &next.qd_ref);
            out.tau_ff = some(&out.tau_ff, &next.tau_ff);
            out.temp = some(&out.temp, &next.temp);
            out.source = format!("{}, {}", out.source, next.source);
        }
        Some(out)
    }

    /// Splits by trajectories: `(the others, the chosen ones)`, both in file order.
    pub fn split(&self, chosen: &[usize]) -> (Self, Self) {
        let (taken, rest): (Vec<usize>, Vec<usize>) =
            (0..self.trajectories.len()).partition(|i| chosen.contains(i));
        (self.select(&rest), self.select(&taken))
    }
}
