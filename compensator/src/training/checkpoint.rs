//! Checkpoints: one safetensors file per network that holds burn's records as bytes, with settings and hash
//! beside them; written under a temporary name and renamed.

use std::path::Path;

use burn::tensor::Bytes;
use safetensors::SafeTensors;
use safetensors::tensor::{Dtype, TensorView};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::epoch::Position;
use super::state::State;
use crate::Error;
use crate::config::UnitConfig;
use crate::learning::Records;

/// Key of the header in the metadata of a checkpoint file.
const KEY: &str = "residyn-checkpoint";

/// Version of a checkpoint's format. Version 1 held bare vectors.
const VERSION: u32 = 2;

/// Data, settings and seed to which a checkpoint must belong.
#[derive(Debug)]
pub(super) struct Origin<'a> {
    /// Digest of data, settings and seed: resuming under others would not give the same weights.
    pub(super) fingerprint: String,
    /// Settings, to report differences.
    pub(super) config: &'a UnitConfig,
}

/// Header of a checkpoint, in the metadata of its file.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Header {
    /// Version of the format.
    version: u32,
    /// Digest of data, settings and seed.
    fingerprint: String,
    /// Settings of the unit.
    config: UnitConfig,
    /// Position of the training loop.
    progress: Position,
    /// SHA-256 of the records, since burn's format has no checksum of its own.
    sha256: String,
}

/// Part of a header that the formats of all versions have.
#[derive(Deserialize)]
struct Version {
    #[serde(default = "first")]
    version: u32,
}

/// Version of a header that names none.
fn first() -> u32 {
    1
}

/// Names of burn's records in a checkpoint. The last is that of the best weights so far.
const NAMES: [&str; 4] = ["weights", "optimizer", "schedule", "best"];

/// SHA-256 of the records, in hexadecimal.
fn digest<'a>(records: impl Iterator<Item = &'a [u8]>) -> String {
    let mut hash = Sha256::new();
    records.for_each(|r| hash.update(r));
    hash.finalize().iter().map(|b| format!("{b:02x}")).collect()
}

/// Writes the state of a training.
///
/// # Errors
/// [`Error::Io`], or [`Error::BadCheckpoint`] where a record cannot be written down.
pub(super) fn save(path: &Path, origin: &Origin, state: &State) -> Result<(), Error> {
    let content = content(origin, state).map_err(|e| Error::BadCheckpoint {
        path: path.to_owned(),
        problem: e.to_string(),
    })?;
    let temporary = path.with_extension("tmp");
    std::fs::write(&temporary, content)
        .and_then(|()| std::fs::rename(&temporary, path))
        .map_err(|source| Error::Io {
            path: path.to_owned(),
            source,
        })
}

/// Bytes of a checkpoint file.
fn content(origin: &Origin, state: &State) -> Result<Vec<u8>, Box<dyn std::error::Error>> {
    let Records {
        weights,
        optimizer,
        schedule,
    } = state.learner.records()?;
    let records = [weights, optimizer, schedule, state.best.record()?];
    let header = Header {
        version: VERSION,
        fingerprint: origin.fingerprint.clone(),
        config: origin.config.clone(),
        progress: state.progress.clone(),
        sha256: digest(records.iter().map(|r| &r[..])),
    };
    let header = serde_json::to_string(&header)?;
    let views = NAMES
        .iter()
        .zip(&records)
        .map(|(name, r)| Ok((*name, TensorView::new(Dtype::U8, vec![r.len()], r)?)))
        .collect::<Result<Vec<_>, safetensors::SafeTensorError>>()?;
    let metadata = [(KEY.to_owned(), header)].into_iter().collect();
    Ok(safetensors::serialize(views, Some(metadata))?)
}

/// State of a training from its checkpoint. `fresh` is the state at the start, with the settings.
///
/// # Errors
/// [`Error::Io`]; [`Error::CheckpointVersion`], [`Error::OtherCheckpoint`] or [`Error::BadCheckpoint`], and the file
/// stays as it is.
pub(super) fn load(path: &Path, origin: &Origin, fresh: State) -> Result<State, Error> {
    let bad = |problem: String| Error::BadCheckpoint {
        path: path.to_owned(),
        problem,
    };
    let content = std::fs::read(path).map_err(|source| Error::Io {
        path: path.to_owned(),
        source,
    })?;
    let (_, metadata) = SafeTensors::read_metadata(&content).map_err(|e| bad(e.to_string()))?;
    let file = SafeTensors::deserialize(&content).map_err(|e| bad(e.to_string()))?;
    let header = metadata
        .metadata()
        .as_ref()
        .and_then(|m| m.get(KEY))
        .ok_or_else(|| bad("not a checkpoint".into()))?;
    let Version { version } = serde_json::from_str(header).map_err(|e| bad(e.to_string()))?;
    if version != VERSION {
        return Err(Error::CheckpointVersion {
            path: path.to_owned(),
            found: version,
            supported: VERSION,
        });
    }
    let header: Header = serde_json::from_str(header).map_err(|e| bad(e.to_string()))?;
    let mut records = Vec::new();
    for name in NAMES {
        let view = file.tensor(name).map_err(|e| bad(e.to_string()))?;
        records.push(view.data());
    }
    if digest(records.iter().copied()) != header.sha256 {
        return Err(bad("its checksum does not match".into()));
    }
    if header.fingerprint != origin.fingerprint {
        let what = if header.config == *origin.config {
            "data or another seed"
        } else {
            "settings"
        };
        return Err(Error::OtherCheckpoint {
            path: path.to_owned(),
            what,
        });
    }
    let [weights, optimizer, schedule, best] =
        [0, 1, 2, 3].map(|i: usize| Bytes::from_bytes_vec(records[i].to_vec()));
    let records = Records {
        weights,
        optimizer,
        schedule,
    };
    Ok(State {
        learner: fresh.learner.restore(records).map_err(bad)?,
        best: fresh.best.restore(best).map_err(bad)?,
        progress: header.progress,
    })
}
