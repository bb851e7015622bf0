//! Checkpoints: one safetensors file per network, written under a temporary name and renamed.

use std::collections::HashMap;
use std::path::Path;

use safetensors::SafeTensors;
use safetensors::tensor::{Dtype, TensorView};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::adam::Adam;
use super::state::{Position, State};
use crate::Error;

const KEY: &str = "residyn-checkpoint";

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Header {
    /// Digest of data, settings and seed: resuming under others would not give the same weights.
    fingerprint: String,
    steps: u64,
    progress: Position,
    /// SHA-256 of the four tensors.
    sha256: String,
}

fn bytes(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

fn digest<'a>(tensors: impl Iterator<Item = &'a [u8]>) -> String {
    let mut hash = Sha256::new();
    tensors.for_each(|t| hash.update(t));
    hash.finalize().iter().map(|b| format!("{b:02x}")).collect()
}

const NAMES: [&str; 4] = ["parameters", "first", "second", "best"];

pub(super) fn save(path: &Path, fingerprint: &str, state: &State) -> Result<(), Error> {
    let tensors = [
        &state.parameters,
        &state.adam.first,
        &state.adam.second,
        &state.best,
    ]
    .map(|v| bytes(v));
    let bad = |problem: String| Error::BadCheckpoint {
        path: path.to_owned(),
        problem,
    };
    let header = Header {
        fingerprint: fingerprint.to_owned(),
        steps: state.adam.steps,
        progress: state.progress.clone(),
        sha256: digest(tensors.iter().map(|t| &t[..])),
    };
    let header = serde_json::to_string(&header).map_err(|e| bad(e.to_string()))?;
    let views = NAMES
        .iter()
        .zip(&tensors)
        .map(|(name, t)| Ok((*name, TensorView::new(Dtype::F32, vec![t.len() / 4], t)?)))
        .collect::<Result<Vec<_>, safetensors::SafeTensorError>>()
        .map_err(|e| bad(e.to_string()))?;
    let content = safetensors::serialize(views, Some(HashMap::from([(KEY.to_owned(), header)])))
        .map_err(|e| bad(e.to_string()))?;
    let temporary = path.with_extension("tmp");
    std::fs::write(&temporary, content)
        .and_then(|()| std::fs::rename(&temporary, path))
        .map_err(|source| Error::Io {
            path: path.to_owned(),
            source,
        })
}

pub(super) fn load(path: &Path, fingerprint: &str, parameters: usize) -> Result<State, Error> {
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
    let header: Header = serde_json::from_str(header).map_err(|e| bad(e.to_string()))?;
    let mut views = Vec::new();
    for name in NAMES {
        let view = file.tensor(name).map_err(|e| bad(e.to_string()))?;
        if view.dtype() != Dtype::F32 {
            return Err(bad(format!("tensor `{name}` is not f32")));
        }
        views.push(view);
    }
    if digest(views.iter().map(|v| v.data())) != header.sha256 {
        return Err(bad("its checksum does not match".into()));
    }
    if header.fingerprint != fingerprint || views.iter().any(|v| v.data().len() != 4 * parameters) {
        return Err(Error::OtherCheckpoint {
            path: path.to_owned(),
        });
    }
    let [parameters, first, second, best] = [0, 1, 2, 3].map(|i: usize| {
        let (values, _) = views[i].data().as_chunks::<4>();
        values.iter().map(|b| f32::from_le_bytes(*b)).collect()
    });
    Ok(State {
        parameters,
        adam: Adam {
            first,
            second,
            steps: header.steps,
        },
        best,
        progress: header.progress,
    })
}
