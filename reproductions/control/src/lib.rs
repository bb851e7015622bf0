//! What a torque model is worth to a controller, in simulation: tracking, settling, and the collisions that it shows.
//!
//! - [`subject`]: a simulated robot with its motors, on whose joints something may push;
//! - [`drive`]: the cascade of a drive, and the rule that sets its gains;
//! - [`model`]: what the controller knows of the robot's torque;
//! - [`motion`]: straight lines, Fourier series, sine waves;
//! - [`track`]: the loop, by [`track::Mode`];
//! - [`measures`]: errors, and settling as the softMC manual defines it;
//! - [`demonstration`]: the robots of `eval --closed-loop`, its tables and page;
//! - [`collision`]: torque error and momentum observer, their thresholds and alarms: `eval --collision`.
#![forbid(unsafe_code)]

pub mod collision;
pub mod demonstration;
pub mod drive;
pub mod error;
pub mod measures;
pub mod model;
pub mod motion;
pub mod subject;
pub mod track;

pub use error::ControlError;
