//! Checkpoints of an interrupted run, and the check whether a run may continue from them.

use crate::arguments::Arguments;
use crate::input::Input;
use model::failure::Failure;
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};

/// Folder of checkpoints inside the model directory.
pub fn folder(arguments: &Arguments) -> PathBuf {
    arguments.out.join("checkpoint")
}

/// Text with all inputs that determine the result.
fn description(arguments: &Arguments, input: &Input) -> String {
    let recordings: Vec<String> = input
        .data
        .iter()
        .chain(&input.heldout)
        .map(|r| format!("{} {} {}", r.source, r.len(), fingerprint(r)))
        .collect();
    format!(
        "residyn {}\nrobot {:?}\njoints {:?}\ngravity {:?}\ndrive {:?}\nseed {}\nmoving only {}\nbasic {}\nestimator {:?}\npreset {:?}\nmembers {:?}\nepochs {:?}\nyardsticks {}\ngpu {}\ncutoff {:?}\n{}\n",
        env!("CARGO_PKG_VERSION"),
        arguments.robot,
        arguments.joints,
        arguments.gravity,
        input.setup.drive,
        arguments.seed,
        arguments.moving_only,
        arguments.basic,
        arguments.estimator,
        arguments.preset,
        arguments.members,
        arguments.epochs,
        arguments.yardsticks,
        arguments.gpu,
        arguments.cutoff_hz,
        recordings.join("\n")
    )
}

fn fingerprint(r: &datasets::Recording) -> String {
    let mut hash = Sha256::new();
    for value in r.time.iter().chain(&r.q) {
        hash.update(value.to_le_bytes());
    }
    for table in [&r.qd, &r.qdd, &r.tau] {
        hash.update([u8::from(table.is_some())]);
        for value in table.iter().flatten() {
            hash.update(value.to_le_bytes());
        }
    }
    for trajectory in &r.trajectories {
        hash.update(format!("{trajectory:?}"));
    }
    let digest = hash.finalize();
    digest.iter().take(8).map(|b| format!("{b:02x}")).collect()
}

fn description_file(arguments: &Arguments) -> PathBuf {
    folder(arguments).join("run.txt")
}

/// Whether the interrupted run in `--out` is this one.
///
/// # Errors
/// Nothing to resume there, or a run with other arguments or recordings.
pub fn check(arguments: &Arguments, input: &Input) -> Result<(), Failure> {
    let then = std::fs::read_to_string(description_file(arguments)).map_err(|_| {
        Failure::input(
            format!("{} holds no checkpoint to resume", arguments.out.display()),
            "Run without --resume, or give the --out of the interrupted run.",
        )
    })?;
    let now = description(arguments, input);
    match std::iter::zip(then.lines(), now.lines()).find(|(a, b)| a != b) {
        Some((a, b)) => Err(Failure::input(
            format!(
                "--resume with other arguments: the interrupted run had `{a}`, this one has `{b}`"
            ),
            "Give the same arguments, or run without --resume.",
        )),
        None => Ok(()),
    }
}

/// Prepares the folder of checkpoints; without `--resume`, old ones go.
///
/// # Errors
/// The folder cannot be written.
pub fn open(arguments: &Arguments, input: &Input) -> Result<PathBuf, Failure> {
    let folder = folder(arguments);
    if !arguments.resume {
        remove(&folder);
        std::fs::create_dir_all(&folder)
            .map_err(|e| Failure::other(format!("{}: {e}", folder.display())))?;
        report::write_atomic(&description_file(arguments), description(arguments, input))?;
    }
    Ok(folder)
}

/// Removes the checkpoints once the result is safe.
pub fn remove(folder: &Path) {
    // What cannot be removed does no harm: the next run checks it against its arguments.
    let _ = std::fs::remove_dir_all(folder);
}
