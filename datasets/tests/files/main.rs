//! Recordings as files: read, checked, prepared, refused.

mod bags;
mod check;
mod damaged_bytes;
mod everyday_tables;
mod lerobot;
mod mat;
mod prepare;
mod refusals;
#[path = "../../../tests/src/shared.rs"]
mod shared;
mod shared_data;
mod stop_band;
