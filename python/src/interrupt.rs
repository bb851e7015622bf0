//! Long work beside the interpreter: on a thread of its own, without the interpreter's lock, while Ctrl-C is looked at.

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

/// Interval at which signals of the interpreter are looked at.
const WATCH: Duration = Duration::from_millis(20);

/// Effect of Ctrl-C on the work that runs.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum OnInterrupt {
    /// Work that is stopped and waited for: it may be writing.
    Stop,
    /// Work that runs to its end by itself. Its result is dropped.
    Abandon,
}

/// Runs `work`, which may look at the flag that Ctrl-C raises.
///
/// # Errors
/// `KeyboardInterrupt`, or a panic of the work.
pub fn run<T: Send + 'static>(
    py: Python<'_>,
    on: OnInterrupt,
    work: impl FnOnce(&AtomicBool) -> T + Send + 'static,
) -> PyResult<T> {
    let cancel = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&cancel);
    let worker = thread::spawn(move || work(&flag));
    let mut interrupted = Ok(());
    while !worker.is_finished() {
        py.detach(|| thread::sleep(WATCH));
        if interrupted.is_ok() {
            interrupted = py.check_signals();
            if interrupted.is_err() {
                cancel.store(true, Ordering::SeqCst);
                if on == OnInterrupt::Abandon {
                    return Err(interrupted.expect_err("just seen"));
                }
            }
        }
    }
    interrupted?;
    worker
        .join()
        .map_err(|_| PyRuntimeError::new_err("a defect of residyn: please report it"))
}
