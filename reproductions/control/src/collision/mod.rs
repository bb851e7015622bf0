//! Collisions seen in torque.
//!
//! - `torque_error`: the softMC manual's: model minus measured torque behind an exponential filter;
//! - `momentum`: the observer of generalised momentum (De Luca and Mattone, ICRA 2005; De Luca et al., IROS 2006);
//! - `sudden`: what of the torque from outside comes suddenly;
//! - `regime`: how a joint moved lately, for a threshold each;
//! - `threshold`: thresholds for a wanted rate of false alarms, and alarms;
//! - `recording`: all of them on a recording of a stored model's robot: `eval --collision`;
//! - `contacts`: simulated contacts.

mod contacts;
mod momentum;
mod page;
mod recording;
mod regime;
mod residual;
mod sudden;
mod threshold;
mod torque_error;

pub use contacts::{Contacts, Found, Plan, contacts};
pub use momentum::Momentum;
pub use page::{page, tables};
pub use recording::{Collisions, Detector, of_recording};
pub use regime::{Regime, Regimes};
pub use residual::Signal;
pub use sudden::Sudden;
pub use threshold::{Alarm, SHORTEST, Thresholds, alarms, thresholds};
pub use torque_error::TorqueError;

/// Time constant of the detectors, s: of the filter, and the inverse of the observer's gain. Three of them are within the 50 ms
/// in which a contact is to be found.
pub const TIME_CONSTANT: f64 = 0.012;
/// Length of the windows that a sudden momentum is a difference of, s: half the 50 ms in which a contact is to be found.
pub const WINDOW: f64 = 0.025;

/// The detectors, in the order of tables and signals.
pub const DETECTORS: [&str; 3] = ["torque_error", "momentum_observer", "sudden_momentum"];
