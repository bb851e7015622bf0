//! Motion of one recording: clocks, input of the columns, rests.

pub(crate) mod channel;
pub(crate) mod delay;
mod derivative;
pub(crate) mod executions;
pub(crate) mod floor;
pub(crate) mod frame;
pub(crate) mod motor;
pub(crate) mod part;
pub(crate) mod passage;
pub(crate) mod scene;
pub(crate) mod sensed;
pub(crate) mod standing;
