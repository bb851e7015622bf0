//! Checksums that tie the files of a model directory to each other and to the recordings.

use feedforward::model_file::hexadecimal;
use sha2::{Digest, Sha256};
use std::io::Read;
use std::path::{Path, PathBuf};

/// SHA-256 of a file, or of all files below a folder, concatenated in order of their names. Files are read in
/// pieces, since recordings may be large.
///
/// # Errors
/// A file cannot be read.
pub fn sha256_of(path: &Path) -> std::io::Result<String> {
    let mut files: Vec<PathBuf> = Vec::new();
    let mut open = vec![path.to_owned()];
    while let Some(next) = open.pop() {
        if next.is_dir() {
            for entry in std::fs::read_dir(next)? {
                open.push(entry?.path());
            }
        } else {
            files.push(next);
        }
    }
    files.sort();
    let mut hash = Sha256::new();
    let mut piece = vec![0; 1 << 16];
    for file in files {
        let mut file = std::fs::File::open(file)?;
        loop {
            let count = file.read(&mut piece)?;
            if count == 0 {
                break;
            }
            hash.update(&piece[..count]);
        }
    }
    Ok(hexadecimal(&hash.finalize()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use feedforward::model_file::sha256;

    #[test]
    fn files_and_folders() {
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in [("b", "second"), ("a", "first")] {
            std::fs::write(folder.path().join(name), text).unwrap();
        }
        let file = sha256_of(&folder.path().join("a")).unwrap();
        assert_eq!(file, sha256(b"first"));
        assert_eq!(sha256_of(folder.path()).unwrap(), sha256(b"firstsecond"));
        assert!(sha256_of(&folder.path().join("c")).is_err());
    }
}
