//! Tells the crate the commit that is compiled, where the workspace is a checkout.
//!
//! `RESIDYN_COMMIT` says it instead; empty, there is none, and a new commit compiles nothing anew.

use std::env;
use std::path::Path;
use std::process::Command;

/// Variable of the environment that says the commit in place of the checkout.
const SAID: &str = "RESIDYN_COMMIT";

fn main() {
    println!("cargo:rerun-if-env-changed={SAID}");
    let commit = match env::var(SAID) {
        Ok(said) => Some(said),
        Err(_) => checked_out(),
    };
    let commit = commit.filter(|c| !c.is_empty());
    let version = env::var("CARGO_PKG_VERSION").unwrap_or_default();
    let text = commit.map_or(version.clone(), |commit| format!("{version} ({commit})"));
    println!("cargo:rustc-env=RESIDYN_VERSION={text}");
}

/// Short name of the commit that is checked out; none of a package outside the repository, whatever repository surrounds it.
fn checked_out() -> Option<String> {
    let package = env::var("CARGO_MANIFEST_DIR").ok()?;
    let root = Path::new(&package).parent()?;
    if !root.join(".git").exists() {
        return None;
    }
    let git = |arguments: &[&str]| {
        let done = Command::new("git")
            .current_dir(root)
            .args(arguments)
            .output();
        let done = done.ok().filter(|d| d.status.success())?;
        Some(String::from_utf8(done.stdout).ok()?.trim().to_owned())
    };
    // The log of HEAD grows by every commit and every change of branch. A path that does not exist would count as changed always.
    let log = root.join(git(&["rev-parse", "--git-path", "logs/HEAD"])?);
    if log.exists() {
        println!("cargo:rerun-if-changed={}", log.display());
    }
    git(&["rev-parse", "--short=9", "HEAD"])
}
