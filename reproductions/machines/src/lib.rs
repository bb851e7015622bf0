//! Machines as a motion controller knows them: axes, SCARA, Delta, PUMA, each with a torque model that is linear in named
//! parameters and with kinematics of its own, beside the serial chains of rigid bodies in `physics`.
//!
//! - [`description`]: what a machine is (a TOML file; the built-in ones are such files);
//! - [`models`]: the torque models, one file each, behind the trait [`TorqueModel`];
//! - [`machine`]: a description with its model and the friction of its axes;
//! - [`identification`]: from a recording to parameters, errors and success, as the softMC manual has it;
//! - [`reasons`]: what of a recording explains a poor result;
//! - [`payload`]: a body on the last axis, against an identified machine without it;
//! - [`program`], [`recorder`], [`store`]: results in the controller's program layout, in its recorder's columns, as JSON;
//! - [`plant`]: simulated machines by *other* equations than the models.
//!
//! Units are SI: rad and N·m for rotary axes, m and N for linear ones.
#![forbid(unsafe_code)]

mod command;
mod command_line;
pub mod description;
pub mod error;
pub mod identification;
pub mod machine;
pub mod models;
pub mod payload;
pub mod plant;
pub mod prediction;
pub mod program;
pub mod reasons;
pub mod recorder;
pub mod recording;
pub mod store;

pub use command_line::{command, command_line};
pub use description::Description;
pub use error::MachineError;
pub use machine::Machine;
pub use models::{Parameter, TorqueModel};
