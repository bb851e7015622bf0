//! What is written, in which order.

use crate::{Group, Recording};
use ndarray::Array2;

/// The tables of a recording in the order in which they are written.
pub(super) fn tables(recording: &Recording) -> Vec<(Group, &Array2<f64>)> {
    let of = |group| match group {
        Group::Q => Some(&recording.q),
        Group::Ql => recording.ql.as_ref(),
        Group::Qd => recording.qd.as_ref(),
        Group::Qdd => recording.qdd.as_ref(),
        Group::Tau => recording.tau.as_ref(),
        Group::QRef => recording.q_ref.as_ref(),
        Group::QdRef => recording.qd_ref.as_ref(),
        Group::Temp => recording.temp.as_ref(),
    };
    Group::ALL
        .into_iter()
        .filter_map(|g| Some((g, of(g)?)))
        .collect()
}

/// Names of the columns, trajectory and time first.
pub(super) fn header(recording: &Recording) -> Vec<String> {
    let joints = tables(recording).into_iter().flat_map(|(group, table)| {
        (1..=table.ncols()).map(move |j| format!("{}{j}", group.name()))
    });
    ["trajectory".to_owned(), "time".to_owned()]
        .into_iter()
        .chain(joints)
        .collect()
}
