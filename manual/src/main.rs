//! `manual`: manual pages and shell completions of `residyn`, made from what its programs take.
#![forbid(unsafe_code)]

use clap::Parser;
use clap_complete::{Shell, generate};
use report::{WriteError, say, warn, write_atomic};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Program whose manual is written.
const NAME: &str = "residyn";
/// Shells with the file from which each takes completions, below the prefix.
const SHELLS: [(Shell, &str); 3] = [
    (Shell::Bash, "share/bash-completion/completions/residyn"),
    (Shell::Zsh, "share/zsh/site-functions/_residyn"),
    (Shell::Fish, "share/fish/vendor_completions.d/residyn.fish"),
];
/// Folder of manual pages below the prefix.
const PAGES: &str = "share/man/man1";

/// Writes the manual pages of `residyn` and of each of its commands, and completions for bash, zsh and fish
#[derive(Parser)]
#[command(name = "manual", version = program::VERSION)]
struct Arguments {
    /// Folder below which `share/man` and the shells' folders lie.
    #[arg(long, value_name = "DIR")]
    prefix: PathBuf,
}

/// A folder or page that could not be written.
#[derive(Debug, thiserror::Error)]
enum ManualError {
    #[error("{} cannot be written: {source}", path.display())]
    Folder {
        path: PathBuf,
        source: std::io::Error,
    },
    #[error(transparent)]
    File(#[from] WriteError),
}

fn main() -> ExitCode {
    let Arguments { prefix } = Arguments::parse();
    match write(&prefix) {
        Ok(()) => {
            say!(
                "Written below {}: manual pages and completions for bash, zsh and fish",
                prefix.display()
            );
            ExitCode::SUCCESS
        }
        Err(error) => {
            warn!("error: {error}");
            ExitCode::from(1)
        }
    }
}

/// Writes all files.
fn write(prefix: &Path) -> Result<(), ManualError> {
    let folder = |path: &Path| {
        fs::create_dir_all(path).map_err(|source| ManualError::Folder {
            path: path.to_owned(),
            source,
        })
    };
    for (shell, file) in SHELLS {
        let mut text = Vec::new();
        generate(shell, &mut residyn::programs::command(), NAME, &mut text);
        let path = prefix.join(file);
        folder(path.parent().unwrap_or(prefix))?;
        write_atomic(&path, text)?;
    }
    let pages = prefix.join(PAGES);
    folder(&pages)?;
    clap_mangen::generate_to(residyn::programs::command(), &pages).map_err(|source| {
        ManualError::Folder {
            path: pages.clone(),
            source,
        }
    })
}
