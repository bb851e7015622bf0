//! What every program has: a version with the commit that it was built from, options from a file, threads and silence.
#![forbid(unsafe_code)]

mod config;
mod running;

pub use config::{ConfigError, parse, with_config};
pub use running::Running;

/// Version of the workspace and, of a program that was built from a checkout, the commit: `0.1.0 (157d66b1c)`.
pub const VERSION: &str = env!("RESIDYN_VERSION");

#[cfg(test)]
mod tests {
    use super::VERSION;

    #[test]
    fn the_commit_stands_behind_the_version_where_there_is_one() {
        let commit = VERSION
            .strip_prefix(env!("CARGO_PKG_VERSION"))
            .expect("the version comes first");
        let inner = commit.strip_prefix(" (").and_then(|c| c.strip_suffix(')'));
        assert!(
            commit.is_empty() || inner.is_some_and(|c| !c.is_empty()),
            "{VERSION}"
        );
    }
}
