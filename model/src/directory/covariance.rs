//! `covariance.json`: data that only the standard deviation of a prediction needs and no control loop reads.
//! They are in a file of their own, because they are most of what is written.

use super::error::DirectoryError;
use feedforward::model_file::sha256;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Name of the file in the model directory.
pub(super) const FILE: &str = "covariance.json";
/// Version of the file that this program writes and reads.
const SCHEMA: &str = "covariance/1";

/// Contents of `covariance.json`, to be written.
#[derive(Serialize)]
struct Written<'a> {
    schema: &'static str,
    covariance: &'a [Vec<f64>],
}

/// Contents of `covariance.json`, as read.
#[derive(Deserialize)]
struct Stored {
    schema: String,
    covariance: Vec<Vec<f64>>,
}

/// Text of `covariance.json` for this covariance matrix.
pub(super) fn text(covariance: &[Vec<f64>]) -> String {
    let written = Written {
        schema: SCHEMA,
        covariance,
    };
    // Finite numbers in lists: nothing that a serialiser refuses.
    let mut text = serde_json::to_string(&written).unwrap_or_default();
    text.push('\n');
    text
}

/// Covariance table of a model directory whose `model.json` holds its `checksum`.
///
/// # Errors
/// No file, a damaged one, or that of another model.
pub(super) fn read(directory: &Path, checksum: &str) -> Result<Vec<Vec<f64>>, DirectoryError> {
    let path = directory.join(FILE);
    let text = std::fs::read_to_string(&path).map_err(|source| DirectoryError::Read {
        path: path.clone(),
        source,
    })?;
    let format = |reason: String| DirectoryError::Format {
        path: path.clone(),
        reason,
    };
    if sha256(text.as_bytes()) != checksum {
        return Err(format(
            "not the file that model.json was written with (checksum differs)".into(),
        ));
    }
    let stored: Stored = serde_json::from_str(&text).map_err(|e| format(e.to_string()))?;
    if stored.schema != SCHEMA {
        return Err(DirectoryError::Schema {
            path,
            found: stored.schema,
            read: SCHEMA,
        });
    }
    Ok(stored.covariance)
}
