//! Long work beside the interpreter: on a thread of its own, without the interpreter's lock, while Ctrl-C is looked at.

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Sender, channel};
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
    run_heard(py, on, |_| Ok(()), move |cancel, _| work(cancel))
}

/// Runs work as [`run`] does; `hear` is called on the interpreter's thread with each line that the work sends.
///
/// # Errors
/// As [`run`], or what `hear` raises.
pub fn run_heard<T: Send + 'static>(
    py: Python<'_>,
    on: OnInterrupt,
    hear: impl Fn(String) -> PyResult<()>,
    work: impl FnOnce(&AtomicBool, Sender<String>) -> T + Send + 'static,
) -> PyResult<T> {
    let cancel = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&cancel);
    let (sender, lines) = channel();
    let worker = thread::spawn(move || work(&flag, sender));
    let heard = || lines.try_iter().try_for_each(&hear);
    let mut interrupted = Ok(());
    while !worker.is_finished() {
        py.detach(|| thread::sleep(WATCH));
        if interrupted.is_ok() {
            interrupted = py.check_signals().and_then(|()| heard());
            if interrupted.is_err() {
                cancel.store(true, Ordering::SeqCst);
                if on == OnInterrupt::Abandon {
                    return Err(interrupted.expect_err("just seen"));
                }
            }
        }
    }
    interrupted.and_then(|()| heard())?;
    worker
        .join()
        .map_err(|_| PyRuntimeError::new_err("a defect of residyn: please report it"))
}
