//! The extension module of the Python package `residyn`: thin wrappers around what the programs call, with the same numbers.
// The macros of pyo3 expand to the calls of Python's C interface.
#![allow(unsafe_code)]

mod diagnosing;
mod error;
mod interrupt;
mod model;
mod recording;
mod replaying;
mod robot;
mod simulated;
mod sums;
mod training;

/// Python module `residyn._residyn`.
#[pyo3::pymodule]
mod _residyn {
    #[pymodule_export]
    use crate::diagnosing::{Diagnosis, diagnose};
    #[pymodule_export]
    use crate::error::InputError;
    #[pymodule_export]
    use crate::model::Model;
    #[pymodule_export]
    use crate::recording::{read_recording, write_recording};
    #[pymodule_export]
    use crate::replaying::{Replay, replay};
    #[pymodule_export]
    use crate::robot::Robot;
    #[pymodule_export]
    use crate::simulated::{effects, simulate_case};
    #[pymodule_export]
    use crate::sums::Sums;
    #[pymodule_export]
    use crate::training::{check, train};
}
