//! Cases that come nearer to a real robot's recordings, everything drawn independently.
//!
//! The description's inertials are within 3, 10 or 25 % of the plant's, its friction within a factor of 1.1, 2 or 3, on some
//! joints missing (`robot`). Joints have small effects besides the withheld one and one of four laws of coming to rest
//! (`background`). Trajectories are few or many and may rest; the held-out ones may be of another day (`motion`). Torque
//! comes from a filtered, quantised current with coloured noise, outliers and a bias (`channel`); stamps may be jittered,
//! velocity missing (`sensors`).

mod background;
mod case;
mod channel;
mod motion;
mod recorded;
pub(super) mod robot;
mod sensors;
mod truth;

pub use case::OF_A_GEAR;
pub(super) use case::attempt;
pub use truth::{HardTruth, NamedShare};

/// Rate of the trace behind a recording, Hz.
const TRACE_HZ: f64 = 500.0;
