//! Columns of a written file and their order.

use crate::{Group, Recording, TorqueFilter, Trajectory};
use ndarray::Array2;

/// A file's content, whatever the format.
pub(super) struct Table<'a> {
    pub trajectories: &'a [Trajectory],
    pub time: &'a [f64],
    /// Name of each group of columns with its values, shape (samples, joints).
    pub groups: Vec<(&'static str, &'a Array2<f64>)>,
    pub torque_filter: Option<TorqueFilter>,
}

impl<'a> Table<'a> {
    /// The tables of a recording in the order in which they are written.
    pub fn of(recording: &'a Recording) -> Self {
        let of = |group| match group {
            Group::Q => Some(&recording.q),
            Group::Ql => recording.ql.as_ref(),
            Group::Qd => recording.qd.as_ref(),
            Group::Qdd => recording.qdd.as_ref(),
            Group::Tau => recording.tau.as_ref(),
            Group::QRef => recording.q_ref.as_ref(),
            Group::QdRef => recording.qd_ref.as_ref(),
            Group::TauFf => recording.tau_ff.as_ref(),
            Group::Temp => recording.temp.as_ref(),
        };
        Self {
            trajectories: &recording.trajectories,
            time: &recording.time,
            groups: Group::ALL
                .into_iter()
                .filter_map(|g| Some((g.name(), of(g)?)))
                .collect(),
            torque_filter: recording.torque_filter,
        }
    }

    /// Names of the columns, trajectory and time first.
    pub fn header(&self) -> Vec<String> {
        let joints = self
            .groups
            .iter()
            .flat_map(|(name, table)| (1..=table.ncols()).map(move |j| format!("{name}{j}")));
        ["trajectory".to_owned(), "time".to_owned()]
            .into_iter()
            .chain(joints)
            .collect()
    }
}
