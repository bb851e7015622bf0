//! Failures as exceptions with the words of the command line.

use diagnose::DiagnoseError;
use model::failure::Failure;
use pyo3::PyErr;
use pyo3::create_exception;
use pyo3::exceptions::{PyKeyboardInterrupt, PyOSError, PyRuntimeError, PyValueError};
use replay::job::ReplayError;

create_exception!(
    _residyn,
    InputError,
    PyValueError,
    "Input that cannot be used: what is wrong and, on a second line, what to do."
);

/// Python exception for a failure of a command line: status 2 is the input's fault, 130 an interruption.
pub fn raise(failure: impl Into<Failure>) -> PyErr {
    let Failure {
        message,
        hint,
        status,
    } = failure.into();
    let text = if hint.is_empty() {
        message
    } else {
        format!("{message}\n{hint}")
    };
    match status {
        2 => InputError::new_err(text),
        130 => PyKeyboardInterrupt::new_err(text),
        _ => PyRuntimeError::new_err(text),
    }
}

/// Python exception for input that cannot be used.
pub fn refused(why: impl std::fmt::Display) -> PyErr {
    InputError::new_err(why.to_string())
}

/// Python exception for a diagnosis that cannot be made.
pub fn undiagnosed(error: &DiagnoseError) -> PyErr {
    if error.is_input() {
        InputError::new_err(error.to_string())
    } else {
        PyRuntimeError::new_err(error.to_string())
    }
}

/// Python exception for a diagnosis of motion that cannot be made or written.
pub fn unreplayed(error: &ReplayError) -> PyErr {
    if error.is_input() {
        InputError::new_err(error.to_string())
    } else {
        PyOSError::new_err(error.to_string())
    }
}
