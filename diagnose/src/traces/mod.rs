//! Traces: patterns in a residual that identify an effect without a fit. They are pushes, impacts, periodic lines and
//! structure.

pub(crate) mod contact;
pub(crate) mod impacts;
pub(crate) mod order;
pub(crate) mod unknown;
