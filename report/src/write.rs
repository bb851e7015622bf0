//! Files that are written whole or not at all.

use crate::say;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

/// Name of a file that stands for standard output.
const STANDARD: &str = "-";

/// Error of a file that could not be written; no partial file is left.
#[derive(Debug, thiserror::Error)]
#[error("{} cannot be written: {source}", path.display())]
pub struct WriteError {
    /// Path of the file that was to be written.
    pub path: PathBuf,
    /// Error of the operating system.
    pub source: std::io::Error,
}

/// A file that cannot be written, found before work began.
#[derive(Debug, thiserror::Error)]
#[error("{0}; name another file, or make its folder first")]
pub struct OutputError(pub WriteError);

/// Checks before work begins that files can be written: their folders exist and may be written. Where one of them is
/// `-`, standard output is kept for it, and messages to a person go to standard error from here on.
///
/// # Errors
/// The first file that cannot be written, with the reason.
pub fn prepare<'a>(paths: impl IntoIterator<Item = &'a PathBuf>) -> Result<(), OutputError> {
    for path in paths {
        if path.as_os_str() == STANDARD {
            say::keep_standard_output();
            continue;
        }
        let failed = |source| {
            OutputError(WriteError {
                path: path.clone(),
                source,
            })
        };
        if path.is_dir() {
            return Err(failed(ErrorKind::IsADirectory.into()));
        }
        std::fs::metadata(folder(path)).map_err(failed)?;
        // An error here names the temporary file, which is nobody's: its kind says enough.
        tempfile::Builder::new()
            .prefix(".report-")
            .tempfile_in(folder(path))
            .map_err(|e| failed(e.kind().into()))?;
    }
    Ok(())
}

/// Tells a person which files were written; standard output is none of them.
pub fn say_written<'a>(paths: impl IntoIterator<Item = &'a PathBuf>) {
    for path in paths {
        if path.as_os_str() != STANDARD {
            crate::say!("Written: {}", path.display());
        }
    }
}

/// Files that belong together, in words: the path of the first, and the names of those beside it. None of no files.
pub fn together(paths: &[PathBuf]) -> Option<String> {
    let (first, beside) = paths.split_first()?;
    let names = beside.iter().filter_map(|path| path.file_name());
    let names: Vec<_> = names.map(|name| name.to_string_lossy()).collect();
    let first = first.display();
    Some(if names.is_empty() {
        first.to_string()
    } else {
        format!("{first}, with {} beside it", names.join(", "))
    })
}

fn folder(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// Writes `text` to a temporary name in the same directory, then renames it to `path`; `-` is standard output.
///
/// # Errors
/// [`WriteError`] when the directory does not exist, is full or may not be written; a file that was there
/// before is then untouched.
pub fn write_atomic(path: &Path, contents: impl AsRef<[u8]>) -> Result<(), WriteError> {
    if path.as_os_str() == STANDARD {
        say::kept(contents.as_ref());
        return Ok(());
    }
    let attempt = || -> std::io::Result<()> {
        let mut builder = tempfile::Builder::new();
        // Temporary files are private by default; a report is as readable as any other new file.
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            builder.permissions(std::fs::Permissions::from_mode(0o666));
        }
        let mut file = builder.prefix(".report-").tempfile_in(folder(path))?;
        file.write_all(contents.as_ref())?;
        file.as_file().sync_all()?;
        file.persist(path)?;
        Ok(())
    };
    attempt().map_err(|source| WriteError {
        path: path.to_owned(),
        source,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn replaces_a_file_and_leaves_nothing_else() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("page.html");
        write_atomic(&path, "first").unwrap();
        write_atomic(&path, "second").unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "second");
        assert_eq!(std::fs::read_dir(directory.path()).unwrap().count(), 1);
    }

    #[test]
    fn files_that_belong_together_are_named_by_the_first() {
        let paths = ["out/arm.urdf", "out/arm.mjcf.xml", "out/arm.values.tsv"].map(PathBuf::from);
        let said = together(&paths).unwrap();
        assert_eq!(
            said,
            "out/arm.urdf, with arm.mjcf.xml, arm.values.tsv beside it"
        );
        assert_eq!(together(&paths[..1]).unwrap(), "out/arm.urdf");
        assert_eq!(together(&[]), None);
    }

    #[test]
    fn a_folder_that_is_not_there_is_found_before_work_begins() {
        let directory = tempfile::tempdir().unwrap();
        let there = directory.path().join("page.html");
        prepare([&there]).unwrap();
        assert_eq!(std::fs::read_dir(directory.path()).unwrap().count(), 0);
        let missing = directory.path().join("no/page.html");
        let error = prepare([&there, &missing]).unwrap_err();
        assert_eq!(error.0.path, missing);
        assert!(!error.to_string().contains(".report-"), "{error}");
        assert!(prepare([&directory.path().to_owned()]).is_err());
    }

    #[test]
    fn a_failed_write_leaves_nothing_and_names_the_file() {
        let directory = tempfile::tempdir().unwrap();
        // A directory cannot be replaced by a file.
        let path = directory.path().join("taken");
        std::fs::create_dir(&path).unwrap();
        let error = write_atomic(&path, "text").unwrap_err();
        assert!(error.to_string().contains("taken"), "{error}");
        assert_eq!(std::fs::read_dir(directory.path()).unwrap().count(), 1);
        assert!(write_atomic(&directory.path().join("no/such/x.html"), "").is_err());
    }
}
