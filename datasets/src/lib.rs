//! Recordings of robot motion and torque: readers and writers of the file formats, preprocessing into a
//! [`signal::Motion`], and the check that finds faults of a recording before anything is fitted to it.
//!
//! ```no_run
//! use datasets::{ReadOptions, read};
//! let recording = read("run.parquet".as_ref(), &ReadOptions::default())?;
//! println!("{} samples, {} joints", recording.len(), recording.dof());
//! # Ok::<(), datasets::ReadError>(())
//! ```
#![forbid(unsafe_code)]

mod assemble;
pub mod channel;
pub mod check;
pub mod columns;
pub mod error;
pub mod folds;
mod held;
mod mcap;
pub mod metrics;
mod overlap;
pub mod periods;
pub mod prepare;
pub mod read;
pub mod recording;
pub mod repeats;
mod sources;
mod stamps;
pub mod stop_band;
pub mod torque_filter;
pub mod write;

pub use columns::{Affine, ColumnMap, Group, Part, ReadOptions};
pub use error::{Problem, ReadError};
pub use folds::Folds;
pub use overlap::{holds, kept_rows, overlap};
pub use prepare::{PrepareOptions, Prepared, prepare};
pub use read::read;
pub use recording::{Recording, Trajectory};
pub use torque_filter::{DeclaredFilter, TorqueFilter};
pub use write::{WriteError, write, write_reference};
