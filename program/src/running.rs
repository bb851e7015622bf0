//! How a program runs, whatever it does: threads and what it prints.

use clap::Args;
use indicatif::ProgressBar;
use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};
use std::num::NonZeroUsize;
use std::process::ExitCode;
use std::time::Duration;

/// Stack of a thread of a pool, bytes: that of the main thread, since the pool does the main work.
const STACK: usize = 8 << 20;

/// Options of every program that works for longer.
#[derive(Clone, Debug, Args)]
pub struct Running {
    /// Number of threads; the result does not depend on it [default: all cores].
    #[arg(long, value_parser = threads)]
    pub threads: Option<NonZeroUsize>,
    /// Print nothing but errors.
    #[arg(long)]
    pub quiet: bool,
}

impl Running {
    /// The number of threads that was asked for: all cores by default.
    pub fn threads(&self) -> usize {
        let all = || std::thread::available_parallelism().map_or(1, usize::from);
        self.threads.map_or_else(all, usize::from)
    }

    /// A pool of that many threads. The process's own stays as it is: it may belong to somebody else.
    ///
    /// # Errors
    /// The system has no threads left.
    pub fn pool(&self) -> Result<ThreadPool, ThreadPoolBuildError> {
        let pool = ThreadPoolBuilder::new().num_threads(self.threads());
        pool.stack_size(STACK).build()
    }

    /// Runs a program's work on that many threads, in silence where that was asked for.
    pub fn run(&self, work: impl FnOnce() -> ExitCode + Send) -> ExitCode {
        if self.quiet {
            report::say::silence();
        }
        match self.pool() {
            Ok(pool) => pool.install(work),
            Err(error) => {
                report::warn!("error: {error}");
                ExitCode::FAILURE
            }
        }
    }

    /// What turns on a terminal while the program works.
    pub fn spinner(&self) -> ProgressBar {
        if self.quiet {
            return ProgressBar::hidden();
        }
        let spinner = ProgressBar::new_spinner();
        spinner.enable_steady_tick(Duration::from_millis(200));
        spinner
    }
}

fn threads(text: &str) -> Result<NonZeroUsize, String> {
    let wrong = |_| "a whole number from 1 on is needed".to_owned();
    text.parse().map_err(wrong)
}
