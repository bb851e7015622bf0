//! URDF.

mod read;
mod write;

pub(in crate::robot) use read::read;
pub use write::{to_urdf, urdf_with};
