//! `train` with the arguments of the command line.

use crate::error::{raise, refused};
use crate::interrupt::{self, OnInterrupt};
use ::train::arguments::Arguments;
use clap::Parser;
use pyo3::prelude::*;

/// Runs `train`; `progress` is called with (joint, network, epoch, epochs, error on held-back groups in N·m or None) from
/// whatever thread trains.
#[pyfunction]
pub fn train(py: Python, arguments: Vec<String>, progress: Option<Py<PyAny>>) -> PyResult<()> {
    let command = ["train".to_owned()].into_iter().chain(arguments);
    let arguments = Arguments::try_parse_from(command).map_err(refused)?;
    let done = interrupt::run(py, OnInterrupt::Stop, move |cancel| {
        let call = |p: &::train::Progress| {
            if let Some(callback) = &progress {
                Python::attach(|py| {
                    let said = (p.joint, p.member, p.epoch, p.epochs, p.best_validation_rmse);
                    // What a callback raises is shown and does not spoil the training.
                    if let Err(e) = callback.call1(py, said) {
                        e.write_unraisable(py, None);
                    }
                });
            }
        };
        ::train::run(&arguments, cancel, Some(&call))
    })?;
    done.map_err(raise)
}
