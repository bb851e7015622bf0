//! Failures as exceptions with the words of the command line, options as keywords.

use diagnose::DiagnoseError;
use model::failure::Failure;
use pyo3::create_exception;
use pyo3::exceptions::{PyKeyboardInterrupt, PyOSError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use replay::job::ReplayError;

create_exception!(
    _residyn,
    InputError,
    PyValueError,
    "Input that cannot be used: what is wrong and, on a second line, what to do."
);

/// What a program says, in the words of Python: `residyn.said`.
pub fn in_python(text: String) -> String {
    let said = |py: Python| -> PyResult<String> {
        let module = py.import("residyn.said")?;
        module.call_method1("in_python", (&text,))?.extract()
    };
    Python::attach(said).unwrap_or(text)
}

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
    let text = in_python(text);
    match status {
        2 => InputError::new_err(text),
        130 => PyKeyboardInterrupt::new_err(text),
        _ => PyRuntimeError::new_err(text),
    }
}

/// Python exception for input that cannot be used.
pub fn refused(why: impl std::fmt::Display) -> PyErr {
    InputError::new_err(in_python(why.to_string()))
}

/// Python exception for a diagnosis that cannot be made.
pub fn undiagnosed(error: &DiagnoseError) -> PyErr {
    let text = in_python(error.to_string());
    if error.is_input() {
        InputError::new_err(text)
    } else {
        PyRuntimeError::new_err(text)
    }
}

/// Python exception for a diagnosis of motion that cannot be made or written.
pub fn unreplayed(error: &ReplayError) -> PyErr {
    let text = in_python(error.to_string());
    if error.is_input() {
        InputError::new_err(text)
    } else {
        PyOSError::new_err(text)
    }
}
