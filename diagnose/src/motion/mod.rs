//! Motion of one recording: its clocks, what columns see of it, where it stands.

pub(crate) mod channel;
pub(crate) mod delay;
pub(crate) mod executions;
pub(crate) mod floor;
pub(crate) mod frame;
pub(crate) mod motor;
pub(crate) mod passage;
pub(crate) mod scene;
pub(crate) mod sensed;
pub(crate) mod standing;
