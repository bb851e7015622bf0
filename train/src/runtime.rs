//! Threads and interruption.

use model::failure::Failure;
use program::Running;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Flag that is raised by Ctrl-C.
pub fn interruptible() -> Result<Arc<AtomicBool>, Failure> {
    let cancel = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&cancel);
    ctrlc::set_handler(move || {
        // A second Ctrl-C does not wait for a place to stop.
        if flag.swap(true, Ordering::SeqCst) {
            std::process::exit(130);
        }
        report::warn!("Stopping at the next step; Ctrl-C again ends at once.");
    })
    .map_err(|e| Failure::other(e.to_string()))?;
    Ok(cancel)
}

/// A pool of the threads that were asked for.
///
/// # Errors
/// The system has no threads left.
pub fn pool(running: &Running) -> Result<rayon::ThreadPool, Failure> {
    running.pool().map_err(|e| Failure::other(e.to_string()))
}

/// Ends a run that was interrupted, with the hint.
pub fn stop(cancel: &AtomicBool, hint: &str) -> Result<(), Failure> {
    if cancel.load(Ordering::SeqCst) {
        Err(Failure::interrupted(hint))
    } else {
        Ok(())
    }
}
