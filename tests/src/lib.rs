//! What the tests in `tests/` share: running the programs, small recordings, the shared data.
//!
//! The programs are looked for where Cargo puts them, beside the running test; build them first with
//! `cargo build --release --bins`.
#![forbid(unsafe_code)]

pub mod bag;
pub mod csv;
pub mod program;
pub mod shared;
pub mod synthetic;
