//! Reading of `model.json`, by the loop and by programs that need more of its content.

use serde::de::DeserializeOwned;
use sha2::{Digest, Sha256};

/// Name of the file in a model directory.
pub const NAME: &str = "model.json";
/// Name of the compensator's file beside `model.json`.
pub const NETWORK: &str = "compensator.safetensors";
/// Version of `model.json` that this library reads.
pub const SCHEMA: &str = "model/1";

/// Reason why a text is not a `model.json` of this version.
#[derive(Debug, thiserror::Error)]
pub enum ModelFileError {
    /// The model was written by another version.
    #[error("schema {0:?}, this program reads {SCHEMA:?}; train the model again")]
    Schema(String),
    /// File that is not a model, or is damaged.
    #[error("not a model of this program: {0}")]
    Format(String),
}

/// The part of a `model.json` that `T` has fields for.
///
/// # Errors
/// Another version, no JSON, or fields that are missing or of another kind.
pub fn parse<T: DeserializeOwned>(text: &[u8]) -> Result<T, ModelFileError> {
    let format = |e: serde_json::Error| ModelFileError::Format(e.to_string());
    let value: serde_json::Value = serde_json::from_slice(text).map_err(format)?;
    let found = value.get("schema").and_then(|s| s.as_str());
    if found != Some(SCHEMA) {
        return Err(ModelFileError::Schema(found.unwrap_or("none").to_owned()));
    }
    serde_json::from_value(value).map_err(format)
}

/// SHA-256 in lower-case hexadecimal, by which the files of a model directory refer to each other.
pub fn sha256(bytes: &[u8]) -> String {
    hexadecimal(&Sha256::digest(bytes))
}

/// A digest in lower-case hexadecimal.
pub fn hexadecimal(digest: &[u8]) -> String {
    digest.iter().map(|b| format!("{b:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(serde::Deserialize, Debug, PartialEq)]
    struct Part {
        clock: Vec<f64>,
    }

    #[test]
    fn a_part_is_read_and_other_versions_are_named() {
        let part: Part = parse(br#"{"schema":"model/1","clock":[1.5],"more":0}"#).unwrap();
        assert_eq!(part.clock, [1.5]);
        let told = |text: &str| parse::<Part>(text.as_bytes()).unwrap_err().to_string();
        assert!(told(r#"{"schema":"model/0"}"#).contains("\"model/0\""));
        assert!(told("{}").contains("\"none\""));
        assert!(told(r#"{"schema":"model/1"}"#).contains("clock"));
        assert!(told("{").contains("not a model"));
    }
}
