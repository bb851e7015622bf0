//! Assignment of a file's columns to quantities and joints.

mod declaration;
mod layout;
mod map;
mod names;
mod options;
mod recognised;

pub(crate) use declaration::lines;
pub(crate) use layout::{Layout, Role, Used};
pub use map::ColumnMap;
pub use options::{Part, ReadOptions};

/// A group of columns, one per joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Group {
    /// Joint position, motor side.
    Q,
    /// Joint position, link side.
    Ql,
    /// Joint velocity.
    Qd,
    /// Joint acceleration.
    Qdd,
    /// Joint torque.
    Tau,
    /// Commanded joint position.
    QRef,
    /// Commanded joint velocity.
    QdRef,
    /// Torque that a controller adds to its own law.
    TauFf,
    /// Joint temperature.
    Temp,
}

impl Group {
    /// All groups, in the order in which they are written.
    pub const ALL: [Self; 9] = [
        Self::Q,
        Self::Ql,
        Self::Qd,
        Self::Qdd,
        Self::Tau,
        Self::QRef,
        Self::QdRef,
        Self::TauFf,
        Self::Temp,
    ];

    /// Name of the group: the column of joint j is this with j (from 1) behind it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Q => "q",
            Self::Ql => "ql",
            Self::Qd => "qd",
            Self::Qdd => "qdd",
            Self::Tau => "tau",
            Self::QRef => "q_ref",
            Self::QdRef => "qd_ref",
            Self::TauFf => "tau_ff",
            Self::Temp => "temp",
        }
    }
}

/// Conversion of a stored value to SI link-side units: `value · scale + offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Affine {
    /// Factor of the conversion: unit, gear ratio, torque constant.
    pub scale: f64,
    /// Offset of the conversion, added after scaling, in SI units: joint zero.
    pub offset: f64,
}

impl Affine {
    /// The identity: a value stays as it is.
    pub const IDENTITY: Self = Self {
        scale: 1.0,
        offset: 0.0,
    };

    /// Value after conversion: `value` · scale + offset.
    pub fn apply(self, value: f64) -> f64 {
        value * self.scale + self.offset
    }
}
