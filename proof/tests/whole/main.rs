//! Whole diagnoses, each of which runs mostly on one thread: one program of tests runs two of them at a time.

mod before_after;
mod blows;
mod few_or_many;
mod patched;
mod proof;
mod real_arms;
mod shared_cases;

use std::io::Write;
use std::path::PathBuf;

/// A folder of the shared data, where it is there; said where not.
fn shared(path: &str) -> Option<PathBuf> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("../../shared")
        .join(path);
    if path.is_dir() {
        return Some(path);
    }
    // Not println: what goes through it is swallowed where a test passes.
    let _ = writeln!(
        std::io::stderr(),
        "skipped: {} is not there",
        path.display()
    );
    None
}
