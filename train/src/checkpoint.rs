//! What an interrupted run leaves behind, and whether a run may go on from it.

use crate::arguments::Arguments;
use crate::input::Input;
use model::failure::Failure;
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};

/// Folder of checkpoints inside the model directory.
pub fn folder(arguments: &Arguments) -> PathBuf {
    arguments.out.join("checkpoint")
}

/// Everything that decides the result, as one text.
fn description(arguments: &Arguments, input: &Input) -> String {
    let recordings: Vec<String> = input
        .data
        .iter()
        .chain(&input.heldout)
        .map(|r| format!("{} {} {:x}", r.source, r.len(), fingerprint(r)))
        .collect();
    format!(
        "residyn {}\nrobot {:?}\ngravity {:?}\ndrive {:?}\nseed {}\nmoving only {}\nbasic {}\npreset {:?}\nmembers {:?}\nepochs {:?}\ncutoff {:?}\n{}\n",
        env!("CARGO_PKG_VERSION"),
        arguments.robot,
        arguments.gravity,
        input.setup.drive,
        arguments.seed,
        arguments.moving_only,
        arguments.basic,
        arguments.preset,
        arguments.members,
        arguments.epochs,
        arguments.cutoff_hz,
        recordings.join("\n")
    )
}

fn fingerprint(r: &datasets::Recording) -> u64 {
    let mut hash = Sha256::new();
    for value in r.time.iter().chain(&r.q).chain(r.tau.iter().flatten()) {
        hash.update(value.to_le_bytes());
    }
    hash.finalize()
        .iter()
        .take(8)
        .fold(0, |h, &b| h << 8 | u64::from(b))
}

/// Prepares the folder: with `--resume` the run must be the one that was interrupted, otherwise old
/// checkpoints go.
pub fn open(arguments: &Arguments, input: &Input) -> Result<PathBuf, Failure> {
    let folder = folder(arguments);
    let file = folder.join("run.txt");
    let now = description(arguments, input);
    if arguments.resume {
        let then = std::fs::read_to_string(&file).map_err(|_| {
            Failure::input(
                format!("{} holds no checkpoint to resume", arguments.out.display()),
                "Run without --resume, or give the --out of the interrupted run.",
            )
        })?;
        if let Some((a, b)) = std::iter::zip(then.lines(), now.lines()).find(|(a, b)| a != b) {
            return Err(Failure::input(
                format!(
                    "--resume with other arguments: the interrupted run had `{a}`, this one has `{b}`"
                ),
                "Give the same arguments, or run without --resume.",
            ));
        }
        return Ok(folder);
    }
    remove(&folder);
    std::fs::create_dir_all(&folder)
        .map_err(|e| Failure::other(format!("{}: {e}", folder.display())))?;
    report::write_atomic(&file, &now)?;
    Ok(folder)
}

/// Removes the checkpoints once the result is safe.
pub fn remove(folder: &Path) {
    // What cannot be removed does no harm: the next run checks it against its arguments.
    let _ = std::fs::remove_dir_all(folder);
}
