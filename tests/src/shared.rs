//! The shared data beside the repository, where it is there.

use std::io::Write;
use std::path::{Path, PathBuf};

/// A file or folder of the shared data; where it is absent, None, and why a test is skipped is printed.
pub fn shared(path: &str) -> Option<PathBuf> {
    let place = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../shared")
        .join(path);
    if place.exists() {
        return Some(place);
    }
    // Not eprintln: what goes through it is swallowed where a test passes.
    let _ = writeln!(
        std::io::stderr(),
        "skipped: {} is not there",
        place.display()
    );
    None
}
