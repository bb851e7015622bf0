//! The shared data beside the repository, where it is there. Tests of other crates include this file, too: it is found from any crate's folder.

use std::io::Write;
use std::path::{Path, PathBuf};

/// Set to 1, as continuous integration does: a test whose data are absent fails instead of being skipped.
const REQUIRE: &str = "RESIDYN_REQUIRE_SHARED";

/// A file or folder of the shared data; where it is absent, None, and why a test is skipped is printed.
///
/// # Panics
/// It is absent, and `RESIDYN_REQUIRE_SHARED` is 1.
pub fn shared(path: &str) -> Option<PathBuf> {
    let place = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../shared")
        .join(path);
    if place.exists() {
        return Some(place);
    }
    let required = std::env::var_os(REQUIRE).is_some_and(|v| v == "1");
    assert!(
        !required,
        "{} is not there, and {REQUIRE} is 1",
        place.display()
    );
    // Not eprintln: what goes through it is swallowed where a test passes.
    let _ = writeln!(
        std::io::stderr(),
        "skipped: {} is not there",
        place.display()
    );
    None
}
