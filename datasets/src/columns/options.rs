//! Options of reading a recording.

use super::{ColumnMap, Group};
use crate::{DeclaredFilter, TorqueFilter};

/// Part of a file that holds both training and test data (the benchmark's .mat files).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Part {
    /// Training part, for `--data`.
    #[default]
    Train,
    /// Test part, for `--heldout` and `eval`.
    Test,
}

/// Options of reading a recording.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadOptions {
    /// Number of joints of the robot; `None` takes the number that the file has.
    pub dof: Option<usize>,
    /// Names of the robot's joints, base first: by them columns and the messages of bags are known. Empty where they are not known.
    pub joints: Vec<String>,
    /// Names of all moving joints of the description, in its order, where the robot is one chain of them.
    pub described: Vec<String>,
    /// Sampling rate of a table without time, Hz.
    pub rate_hz: Option<f64>,
    /// Part of a .mat file that is read.
    pub part: Part,
    /// Whether a recording without torque is refused. Prediction alone does without.
    pub torque_needed: bool,
    /// Names and units of the columns.
    pub columns: ColumnMap,
    /// Low-pass that recordings of this robot are declared to have been through.
    pub torque_filter: Option<DeclaredFilter>,
    /// Whether the joints are those of a stored model, which no option of a program chooses. Refusals then say so.
    pub stored_model: bool,
    /// The robot is the KR300 of the benchmark: its .mat files may be read.
    pub kr300: bool,
}

impl ReadOptions {
    /// Options for a robot with `dof` joints whose torque is needed.
    pub fn for_robot(dof: usize) -> Self {
        Self {
            dof: Some(dof),
            torque_needed: true,
            ..Self::default()
        }
    }

    /// Options for a planned motion that was not recorded yet, as [`crate::write_reference`] writes it. Its
    /// `q_ref1` … are read as positions, `qd_ref1` …, `qdd_ref1` … as velocities and accelerations.
    pub fn for_reference(dof: usize) -> Self {
        let names = [
            (Group::Q, "q_ref{}"),
            (Group::Qd, "qd_ref{}"),
            (Group::Qdd, "qdd_ref{}"),
            // Nothing else of such a file is read.
            (Group::QRef, "-{}"),
            (Group::QdRef, "-{}"),
            (Group::TauFf, "-{}"),
        ];
        let mut options = Self {
            torque_needed: false,
            ..Self::for_robot(dof)
        };
        let named = names.map(|(group, name)| (group.name().to_owned(), name.to_owned()));
        options.columns.names.extend(named);
        options
    }

    /// Options for `--robot kr300`: six joints, the benchmark's files and its torque filter.
    pub fn kr300(part: Part) -> Self {
        Self {
            part,
            torque_filter: Some(TorqueFilter::KR300.decimated()),
            kr300: true,
            ..Self::for_robot(6)
        }
    }
}
