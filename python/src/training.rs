//! `train` with the arguments of the command line.

use crate::error::{raise, refused};
use crate::interrupt::{self, OnInterrupt};
use ::train::arguments::Arguments;
use ::train::{Progress, Watch};
use clap::Parser;
use pyo3::prelude::*;
use std::sync::mpsc::Sender;

/// Callbacks of Python, and where lines for the interpreter's own thread go.
struct Heard {
    progress: Option<Py<PyAny>>,
    lines: Sender<String>,
}

impl Watch for Heard {
    fn warns(&self, line: &str) {
        // Nobody listens after an interruption.
        let _ = self.lines.send(line.to_owned());
    }

    fn trained(&self, p: &Progress) {
        let Some(callback) = &self.progress else {
            return;
        };
        Python::attach(|py| {
            let said = (p.joint, p.member, p.epoch, p.epochs, p.best_validation_rmse);
            // What a callback raises is shown and does not spoil the training.
            if let Err(e) = callback.call1(py, said) {
                e.write_unraisable(py, None);
            }
        });
    }
}

fn parsed(arguments: Vec<String>) -> PyResult<Arguments> {
    let command = ["train".to_owned()].into_iter().chain(arguments);
    Arguments::try_parse_from(command).map_err(refused)
}

/// Runs `train`; `progress` is called with (joint, network, epoch, epochs, error on held-back groups in N·m or None) from
/// whatever thread trains, `warn` on the interpreter's with every severe point of a recording or of the model.
#[pyfunction]
pub fn train(
    py: Python,
    arguments: Vec<String>,
    progress: Option<Py<PyAny>>,
    warn: Py<PyAny>,
) -> PyResult<()> {
    let arguments = parsed(arguments)?;
    let hear = |line: String| warn.call1(py, (line,)).map(drop);
    let done = interrupt::run_heard(py, OnInterrupt::Stop, hear, move |cancel, lines| {
        ::train::run(&arguments, cancel, &Heard { progress, lines })
    })?;
    done.map_err(raise)
}

/// Checks recordings as `train --check-only` does: its JSON, and its lines.
#[pyfunction]
pub fn check(py: Python, arguments: Vec<String>) -> PyResult<(String, Vec<String>)> {
    let arguments = parsed(arguments)?;
    let done = interrupt::run(py, OnInterrupt::Abandon, move |_| {
        ::train::check(&arguments).map(|checked| (checked.json(), checked.lines()))
    })?;
    done.map_err(raise)
}
