//! `forward.json`: prior and friction for positions from torque, stored beside the model to which they belong.

use super::Inversion;
use crate::directory::{DirectoryError, FORWARD, ModelFile, json};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Version of the file that this program writes and reads.
const SCHEMA: &str = "forward/1";

/// Contents of `forward.json`.
#[derive(Serialize, Deserialize)]
struct Stored<T> {
    schema: String,
    /// SHA-256 of the `model.json` that it was made with.
    model_sha256: String,
    #[serde(flatten)]
    inversion: T,
}

impl Inversion {
    /// Stored inversion of a model directory; none where `train forward` has written none.
    ///
    /// # Errors
    /// A damaged file, one of another version, or one that was made with another `model.json`.
    pub fn load(directory: &Path, joints: usize) -> Result<Option<Self>, DirectoryError> {
        let path = directory.join(FORWARD);
        let text = match std::fs::read_to_string(&path) {
            Ok(text) => text,
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            Err(source) => return Err(DirectoryError::Read { path, source }),
        };
        let format = |reason: String| DirectoryError::Format {
            path: path.clone(),
            reason,
        };
        let stored: Stored<Self> =
            serde_json::from_str(&text).map_err(|e| format(e.to_string()))?;
        if stored.schema != SCHEMA {
            return Err(DirectoryError::Schema {
                path,
                found: stored.schema,
                read: SCHEMA,
            });
        }
        if stored.model_sha256 != ModelFile::sha256(directory)? {
            return Err(DirectoryError::Other { path });
        }
        let inversion = stored.inversion;
        if !inversion.fits(joints) {
            return Err(format(
                "its tables do not fit together or not the model's joints".into(),
            ));
        }
        Ok(Some(inversion))
    }

    /// Whether all lists have the lengths that a robot with `joints` joints needs.
    fn fits(&self, joints: usize) -> bool {
        let prior = &self.prior;
        let tables = self.friction.len() == joints
            && prior.scale.len() == joints
            && prior.deviation.len() == prior.shapes.len()
            && !prior.shapes.is_empty()
            && prior.shapes.iter().all(|s| s.len() == prior.standing.len());
        let positive = |v: &f64| v.is_finite() && *v > 0.0;
        let of_joint = |f: &super::JointFriction| positive(&f.speed) && positive(&f.moving);
        tables
            && positive(&prior.rate_hz)
            && prior.scale.iter().chain(&prior.deviation).all(positive)
            && self.friction.iter().all(of_joint)
    }

    /// Writes the inversion into the directory of its model, whose `model.json` has the checksum `model_sha256`.
    ///
    /// # Errors
    /// File that cannot be written.
    pub fn save(&self, directory: &Path, model_sha256: &str) -> Result<(), DirectoryError> {
        let stored = Stored {
            schema: SCHEMA.into(),
            model_sha256: model_sha256.into(),
            inversion: self,
        };
        Ok(report::write_atomic(
            &directory.join(FORWARD),
            json(&stored),
        )?)
    }
}
