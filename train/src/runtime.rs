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

/// The number of threads that was asked for: all cores by default.
///
/// # Errors
/// None at all.
pub fn threads(wanted: Option<usize>) -> Result<usize, Failure> {
    let threads =
        wanted.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from));
    if threads == 0 {
        return Err(Failure::input(
            "--threads 0: at least one thread is needed",
            "",
        ));
    }
    Ok(threads)
}

/// A pool of that many threads. The process's own stays as it is: it may belong to somebody else.
///
/// # Errors
/// The system has no threads left.
pub fn pool(threads: usize) -> Result<rayon::ThreadPool, Failure> {
    /// As the main thread has, for the work is called from one of the pool's.
    const STACK: usize = 8 << 20;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    pool.stack_size(STACK)
        .build()
        .map_err(|e| Failure::other(e.to_string()))
}

/// Ends an interrupted run.
pub fn stop(cancel: &AtomicBool, hint: &str) -> Result<(), Failure> {
    if cancel.load(Ordering::SeqCst) {
        Err(Failure::interrupted(hint))
    } else {
        Ok(())
    }
}
