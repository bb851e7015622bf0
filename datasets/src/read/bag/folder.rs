//! The files of a rosbag2 folder.

use crate::{Problem, ReadError};
use std::path::{Path, PathBuf};

/// The file that makes a folder a bag.
const METADATA: &str = "metadata.yaml";

/// The files of a bag, in the order in which they were written: those that `metadata.yaml` lists, else all that end as
/// recordings do, by name.
///
/// # Errors
/// The folder cannot be read or holds no recording.
pub(super) fn files(folder: &Path) -> Result<Vec<PathBuf>, ReadError> {
    let io = |e: std::io::Error| Problem::Io(e).in_file(folder);
    let listed = match std::fs::read_to_string(folder.join(METADATA)) {
        Ok(text) => listed(&text),
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => Vec::new(),
        Err(e) => return Err(io(e)),
    };
    let mut files: Vec<PathBuf> = listed
        .iter()
        // Bags of the first version have the folder's own name in front.
        .map(|name| match folder.join(name) {
            path if path.exists() => path,
            path => path.file_name().map_or(path.clone(), |n| folder.join(n)),
        })
        .collect();
    if files.is_empty() {
        for entry in std::fs::read_dir(folder).map_err(io)? {
            let path = entry.map_err(io)?.path();
            let ending = path.extension().and_then(|e| e.to_str());
            if matches!(ending, Some("mcap" | "db3")) {
                files.push(path);
            }
        }
        files.sort();
    }
    if files.is_empty() {
        return Err(Problem::NoBag.in_file(folder));
    }
    Ok(files)
}

/// The entries of `relative_file_paths`: a list of plain or quoted texts, as rosbag2 writes it.
fn listed(metadata: &str) -> Vec<String> {
    let mut lines = metadata.lines();
    let Some(head) = lines.find(|l| l.trim_start().starts_with("relative_file_paths:")) else {
        return Vec::new();
    };
    let unquoted = |text: &str| text.trim().trim_matches(['"', '\'']).to_owned();
    let behind = head.split_once(':').map_or("", |(_, rest)| rest).trim();
    if let Some(inner) = behind.strip_prefix('[').and_then(|b| b.strip_suffix(']')) {
        let entries = inner.split(',').map(unquoted);
        return entries.filter(|e| !e.is_empty()).collect();
    }
    lines
        .map_while(|line| line.trim_start().strip_prefix("- "))
        .map(unquoted)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_of_files() {
        let block = "rosbag2_bagfile_information:\n  version: 5\n  relative_file_paths:\n    - run_0.mcap\n    - \"run_1.mcap\"\n  duration:\n";
        assert_eq!(listed(block), ["run_0.mcap", "run_1.mcap"]);
        assert_eq!(
            listed("relative_file_paths: [a.db3, 'b.db3']\n"),
            ["a.db3", "b.db3"]
        );
        assert!(listed("relative_file_paths: []").is_empty());
        assert!(listed("something: else").is_empty());
    }
}
