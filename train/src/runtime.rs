//! Threads and interruption.

use model::failure::Failure;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Flag that Ctrl-C raises.
pub fn interruptible() -> Result<Arc<AtomicBool>, Failure> {
    let cancel = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&cancel);
    ctrlc::set_handler(move || {
        // A second Ctrl-C does not wait for a place to stop.
        if flag.swap(true, Ordering::SeqCst) {
            std::process::exit(130);
        }
    })
    .map_err(|e| Failure::other(e.to_string()))?;
    Ok(cancel)
}

/// Sets the number of threads, all cores by default, and returns it.
pub fn threads(wanted: Option<usize>) -> Result<usize, Failure> {
    let threads =
        wanted.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from));
    if threads == 0 {
        return Err(Failure::input(
            "--threads 0: at least one thread is needed",
            "",
        ));
    }
    // Fails only where the pool exists already, which it does not this early.
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build_global()
        .map_err(|e| Failure::other(e.to_string()))?;
    Ok(threads)
}

/// Ends an interrupted run.
pub fn stop(cancel: &AtomicBool, hint: &str) -> Result<(), Failure> {
    if cancel.load(Ordering::SeqCst) {
        Err(Failure::interrupted(hint))
    } else {
        Ok(())
    }
}
