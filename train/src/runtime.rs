//! Threads and interruption.

use clap::Args;
use model::failure::Failure;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// How a command runs, whatever it does.
#[derive(Clone, Debug, Args)]
pub struct Running {
    /// Number of threads; the result does not depend on it [default: all cores].
    #[arg(long)]
    pub threads: Option<usize>,
    /// Print nothing but errors.
    #[arg(long)]
    pub quiet: bool,
}

impl Running {
    /// The number of threads that was asked for: all cores by default.
    ///
    /// # Errors
    /// None at all.
    pub fn threads(&self) -> Result<usize, Failure> {
        let all = || std::thread::available_parallelism().map_or(1, usize::from);
        match self.threads.unwrap_or_else(all) {
            0 => Err(Failure::input(
                "--threads 0: at least one thread is needed",
                "",
            )),
            threads => Ok(threads),
        }
    }
}

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

/// A pool of that many threads. The process's own stays as it is: it may belong to somebody else.
///
/// # Errors
/// The system has no threads left.
pub fn pool(threads: usize) -> Result<rayon::ThreadPool, Failure> {
    /// Stack of a thread of the pool, bytes. It equals the main thread's, since the pool does the main work.
    const STACK: usize = 8 << 20;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    pool.stack_size(STACK)
        .build()
        .map_err(|e| Failure::other(e.to_string()))
}

/// Ends a run that was interrupted, with the hint.
pub fn stop(cancel: &AtomicBool, hint: &str) -> Result<(), Failure> {
    if cancel.load(Ordering::SeqCst) {
        Err(Failure::interrupted(hint))
    } else {
        Ok(())
    }
}
