//! A robot with its recordings.

use crate::SimulateError;
use crate::cases::write_whole;
use datasets::Recording;
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};

/// A robot and how it was recorded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Protocol {
    /// UR5: two Fourier excitations run eight times at 100 Hz, a thousand point-to-point moves at 60 Hz (154,440
    /// samples), and a verification run, as in the UR5 paper (uncertainty compensation).
    Ur5,
    /// KR300: 36 trajectories of 60.6 s run twice, 10 Hz behind a 2 Hz low-pass (Weigand et al., 2022).
    Kr300,
    /// Foxbot A05: Fourier series of order three up to 0.4 Hz at 100 Hz, friction with a power of speed (Han et al.,
    /// 2020).
    FoxbotA05,
}

impl Protocol {
    /// All protocols: one per source paper.
    pub const ALL: [Self; 3] = [Self::Ur5, Self::Kr300, Self::FoxbotA05];

    /// Name on the command line; that of the built-in robot.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ur5 => "ur5",
            Self::Kr300 => "kr300",
            Self::FoxbotA05 => "foxbot_a05",
        }
    }

    /// Parts of the recording, as [`Simulated::parts`] has them.
    pub(super) fn parts(self) -> &'static [&'static str] {
        match self {
            Self::Ur5 => &["identification", "moves", "verification"],
            Self::Kr300 => &["train", "test"],
            Self::FoxbotA05 => &["identification", "validation"],
        }
    }
}

/// Recordings of a simulated robot.
#[derive(Debug, Clone)]
pub struct Simulated {
    /// Protocol of the recordings.
    pub protocol: Protocol,
    /// Name and recording of each part: for the UR5 `identification`, `moves` and `verification`; for the KR300 `train` and
    /// `test`; for the Foxbot `identification` and `validation`.
    pub parts: Vec<(String, Recording)>,
    /// True parameters: standard inertial parameters, rotor inertias, friction, and those of each mechanism.
    pub truth: Value,
}

impl Simulated {
    /// Recording of the part with this name.
    pub fn part(&self, name: &str) -> Option<&Recording> {
        self.parts.iter().find(|p| p.0 == name).map(|p| &p.1)
    }

    /// Writes `NAME-PART.parquet` for each part (or another format by `ending`) and `NAME-truth.json` into `folder`;
    /// returns the files.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn write(&self, folder: &Path, ending: &str) -> Result<Vec<PathBuf>, SimulateError> {
        fs::create_dir_all(folder).map_err(|source| SimulateError::Write {
            path: folder.to_owned(),
            source,
        })?;
        let name = self.protocol.name();
        let mut files = Vec::new();
        for (part, recording) in &self.parts {
            let path = folder.join(format!("{name}-{part}.{ending}"));
            datasets::write(recording, &path)?;
            files.push(path);
        }
        let path = folder.join(format!("{name}-truth.json"));
        let text =
            serde_json::to_string_pretty(&self.truth).map_err(|source| SimulateError::Json {
                path: path.clone(),
                source,
            })?;
        write_whole(&path, &text)?;
        files.push(path);
        Ok(files)
    }
}
