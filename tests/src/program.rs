//! Runs of the built programs.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A program of this workspace, ready for arguments.
///
/// # Panics
/// When it has not been built.
pub fn program(name: &str) -> Command {
    let test = std::env::current_exe().expect("a running test has a path");
    // target/release/deps/TEST-HASH
    let path: PathBuf = test
        .ancestors()
        .nth(2)
        .map(|folder| folder.join(format!("{name}{}", std::env::consts::EXE_SUFFIX)))
        .unwrap_or_default();
    assert!(
        path.is_file(),
        "{} is not there: run `cargo build --release --bins` first",
        path.display()
    );
    Command::new(path)
}

/// What a finished program left.
#[derive(Clone, Debug)]
pub struct Ended {
    /// Exit status; -1 where a signal ended it.
    pub status: i32,
    /// Standard output.
    pub out: String,
    /// Standard error.
    pub err: String,
}

/// Runs a command to its end.
///
/// # Panics
/// When it cannot be started.
pub fn run(command: &mut Command) -> Ended {
    let output = command.output().expect("the program starts");
    Ended {
        status: output.status.code().unwrap_or(-1),
        out: String::from_utf8_lossy(&output.stdout).into_owned(),
        err: String::from_utf8_lossy(&output.stderr).into_owned(),
    }
}

impl Ended {
    /// Checks that it went well.
    ///
    /// # Panics
    /// When it did not.
    #[track_caller]
    pub fn succeeded(&self) -> &Self {
        assert_eq!(self.status, 0, "standard error: {}", self.err);
        self
    }

    /// Checks that bad input was refused: status 2 and one line that says what is wrong and holds every
    /// one of `fragments`.
    ///
    /// # Panics
    /// When it was not.
    #[track_caller]
    pub fn refused(&self, fragments: &[&str]) {
        assert_eq!(self.status, 2, "standard error: {}", self.err);
        let mut lines = self.err.lines().filter(|line| line.starts_with("error: "));
        let line = lines.next().unwrap_or_default();
        for fragment in fragments {
            assert!(line.contains(fragment), "no `{fragment}` in: {}", self.err);
        }
        assert_eq!(lines.next(), None, "one line says what is wrong");
        assert!(!self.err.contains("panicked"), "{}", self.err);
    }
}

/// Mean NRMSE of one row of `metrics.json` (`part`: `train` or `heldout`) or of `eval --json` (`rows`).
///
/// # Panics
/// When there is no such row.
#[track_caller]
pub fn mean_nrmse(report: &Value, part: &str, name: &str, scope: &str) -> f64 {
    row(report, part, name, scope)["mean_nrmse"]
        .as_f64()
        .unwrap_or_else(|| panic!("{part}, {name}, {scope}: no mean NRMSE"))
}

/// One row of `metrics.json` or of `eval --json`.
///
/// # Panics
/// When there is no such row.
#[track_caller]
pub fn row<'a>(report: &'a Value, part: &str, name: &str, scope: &str) -> &'a Value {
    report[part]
        .as_array()
        .and_then(|rows| {
            rows.iter()
                .find(|r| r["name"] == name && r["scope"] == scope)
        })
        .unwrap_or_else(|| panic!("{part}: no row {name}, {scope}"))
}

/// A JSON file.
///
/// # Panics
/// When there is none.
#[track_caller]
pub fn json(path: &Path) -> Value {
    let text = std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    serde_json::from_str(&text).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// Name and content of every file of a folder, subfolders left out, by name.
///
/// # Panics
/// When the folder cannot be read.
pub fn files(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut list: Vec<(String, Vec<u8>)> = std::fs::read_dir(folder)
        .expect("the folder is there")
        .map(|entry| entry.expect("readable entry").path())
        .filter(|path| path.is_file())
        .map(|path| {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            (name.into_owned(), std::fs::read(&path).expect("readable"))
        })
        .collect();
    list.sort();
    list
}
