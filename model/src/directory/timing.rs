//! `timing.json`: wall time of a training. It is exempt from the rule that the same seed gives the same bytes.

use super::error::DirectoryError;
use super::text::json;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Name of the file in the model directory.
pub const FILE: &str = "timing.json";
/// Version of the file that this program writes and reads.
const SCHEMA: &str = "timing/1";

/// Contents of `timing.json`: wall times of identification and of the compensator's training, s, with threads and
/// resumption. Reading input and writing results do not count.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Timing {
    schema: String,
    /// Number of threads with which the model was trained.
    pub threads: usize,
    /// Wall time of the identification of the physics, choice of the cut-off included, s.
    pub physics_s: f64,
    /// Wall time of the compensator's training, s; none without one.
    pub compensator_s: Option<f64>,
    /// Whether the run continued from a checkpoint, so that the time before it is missing.
    pub resumed: bool,
}

impl Timing {
    /// Timing of a run on `threads` threads.
    pub fn new(threads: usize, physics_s: f64, compensator_s: Option<f64>, resumed: bool) -> Self {
        Self {
            schema: SCHEMA.into(),
            threads,
            physics_s,
            compensator_s,
            resumed,
        }
    }

    /// Wall time of physics and compensator together, s.
    pub fn seconds(&self) -> f64 {
        self.physics_s + self.compensator_s.unwrap_or(0.0)
    }

    /// Timing of a model directory; none where it has no `timing.json`.
    ///
    /// # Errors
    /// A damaged file, or one of another version.
    pub fn load(directory: &Path) -> Result<Option<Self>, DirectoryError> {
        let path = directory.join(FILE);
        let text = match std::fs::read_to_string(&path) {
            Ok(text) => text,
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            Err(source) => return Err(DirectoryError::Read { path, source }),
        };
        let timing: Self = serde_json::from_str(&text).map_err(|e| DirectoryError::Format {
            path: path.clone(),
            reason: e.to_string(),
        })?;
        if timing.schema != SCHEMA {
            return Err(DirectoryError::Schema {
                path,
                found: timing.schema,
                read: SCHEMA,
            });
        }
        Ok(Some(timing))
    }

    /// Writes the timing into a model directory.
    ///
    /// # Errors
    /// File that cannot be written.
    pub fn save(&self, directory: &Path) -> Result<(), DirectoryError> {
        Ok(report::write_atomic(&directory.join(FILE), json(self))?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn read_back_and_refused() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(Timing::load(folder.path()).unwrap(), None);
        let timing = Timing::new(2, 1.5, Some(20.0), true);
        assert_eq!(timing.seconds(), 21.5);
        timing.save(folder.path()).unwrap();
        assert_eq!(Timing::load(folder.path()).unwrap(), Some(timing));
        for (text, fragment) in [
            ("{}", "schema"),
            (
                r#"{"schema":"timing/9","threads":1,"physics_s":1.0,"compensator_s":null,"resumed":false}"#,
                "timing/9",
            ),
        ] {
            std::fs::write(folder.path().join(FILE), text).unwrap();
            let error = Timing::load(folder.path()).unwrap_err().to_string();
            assert!(error.contains(FILE) && error.contains(fragment), "{error}");
        }
    }
}
