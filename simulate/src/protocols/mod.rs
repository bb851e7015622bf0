//! Recordings made as the source papers made theirs, of simulated robots whose parameters are known.

mod foxbot;
mod kr300;
mod runs;
mod ur5;

use crate::SimulateError;
use crate::cases::write_whole;
use datasets::{ReadOptions, Recording};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};

/// A robot and how it was recorded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Protocol {
    /// UR5: two Fourier excitations run eight times at 100 Hz, a thousand point-to-point moves at 60 Hz (154,440
    /// samples), and a verification run (the uncertainty-compensation paper).
    Ur5,
    /// KR300: 36 trajectories of 60.6 s run twice, 10 Hz behind a 2 Hz low-pass (the benchmark paper).
    Kr300,
    /// Foxbot A05: Fourier series of order three up to 0.4 Hz at 100 Hz, friction with a power of speed (the iterative
    /// identification paper).
    FoxbotA05,
}

impl Protocol {
    /// All protocols.
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
    fn parts(self) -> &'static [&'static str] {
        match self {
            Self::Ur5 => &["identification", "moves", "verification"],
            Self::Kr300 => &["train", "test"],
            Self::FoxbotA05 => &["identification", "validation"],
        }
    }

    /// Simulates all recordings, on the threads of the current pool. `progress` is told the finished part, 0 to 1. The same
    /// seed gives the same recordings on any number of threads.
    ///
    /// # Errors
    /// The simulated robot is not a possible one.
    pub fn simulate(
        self,
        seed: u64,
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<Simulated, SimulateError> {
        match self {
            Self::Ur5 => ur5::simulate(seed, progress),
            Self::Kr300 => kr300::simulate(seed, progress),
            Self::FoxbotA05 => foxbot::simulate(seed, progress),
        }
    }
}

/// Recordings of a simulated robot.
#[derive(Debug, Clone)]
pub struct Simulated {
    /// The protocol.
    pub protocol: Protocol,
    /// Name and recording of each part: for the UR5 `identification`, `moves` and `verification`; for the KR300 `train` and
    /// `test`; for the Foxbot `identification` and `validation`.
    pub parts: Vec<(String, Recording)>,
    /// The true parameters: standard inertial parameters, rotor inertias, friction, and what each mechanism is.
    pub truth: Value,
}

impl Simulated {
    /// The part with this name.
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

/// Changes with every change of what a seed gives, so that no cache goes stale.
const EDITION: u32 = 2;

/// The protocol's recordings from `cache`, or simulated and left there. A cache that cannot be read is made anew.
///
/// # Errors
/// As [`Protocol::simulate`] and [`Simulated::write`].
pub fn cached(
    protocol: Protocol,
    seed: u64,
    cache: &Path,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Simulated, SimulateError> {
    let folder = cache.join(format!("{}-{seed}-{EDITION}", protocol.name()));
    if let Some(found) = read(protocol, &folder) {
        progress(1.0);
        return Ok(found);
    }
    let made = protocol.simulate(seed, progress)?;
    made.write(&folder, "parquet")?;
    // What is read back is what every later call gets.
    Ok(read(protocol, &folder).unwrap_or(made))
}

fn read(protocol: Protocol, folder: &Path) -> Option<Simulated> {
    let name = protocol.name();
    // Written last, so that the parts are whole when it is there.
    let truth = fs::read_to_string(folder.join(format!("{name}-truth.json"))).ok()?;
    let truth = serde_json::from_str(&truth).ok()?;
    let read = |part: &&str| {
        let path = folder.join(format!("{name}-{part}.parquet"));
        let recording = datasets::read(&path, &ReadOptions::default()).ok()?;
        Some(((*part).to_owned(), recording))
    };
    let parts = protocol
        .parts()
        .iter()
        .map(read)
        .collect::<Option<Vec<_>>>()?;
    Some(Simulated {
        protocol,
        parts,
        truth,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cache_gives_what_was_simulated() {
        let cache = tempfile::tempdir().unwrap();
        let get = || cached(Protocol::FoxbotA05, 6, cache.path(), &|_| {}).unwrap();
        let (first, second) = (get(), get());
        let fresh = Protocol::FoxbotA05.simulate(6, &|_| {}).unwrap();
        for made in [&first, &second] {
            assert_eq!(made.truth, fresh.truth);
            for (name, recording) in &fresh.parts {
                let found = made.part(name).unwrap();
                assert_eq!(
                    (&found.q, &found.qd, &found.tau),
                    (&recording.q, &recording.qd, &recording.tau)
                );
                assert_eq!(found.trajectories, recording.trajectories);
            }
        }
        // A broken cache is made anew.
        let file = cache
            .path()
            .join(format!("foxbot_a05-6-{EDITION}"))
            .join("foxbot_a05-identification.parquet");
        fs::write(&file, "broken").unwrap();
        assert_eq!(get().parts[0].1.q, fresh.parts[0].1.q);
    }
}
