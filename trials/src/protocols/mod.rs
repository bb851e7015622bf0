//! Recordings made as the source papers made theirs, of simulated robots whose parameters are known.

pub mod changed;
pub mod demo;
mod effects;
mod excitation;
mod foxbot;
mod kr300;
pub mod payload;
mod recorded;
mod runs;
mod truth;
mod ur5;

pub use effects::{Effect, JointEffects};
pub use recorded::{Protocol, Simulated};
pub use runs::{Gear, Machine};

use crate::SimulateError;
use datasets::ReadOptions;
use std::fs;
use std::path::Path;

impl Protocol {
    /// Simulated robot of the protocol, for other motions than those of its paper.
    ///
    /// # Errors
    /// Its bodies do not make a possible robot.
    pub fn machine(self) -> Result<Machine, SimulateError> {
        match self {
            Self::Ur5 => ur5::machine(),
            Self::Kr300 => kr300::machine(),
            Self::FoxbotA05 => foxbot::machine(),
        }
    }

    /// Simulates all recordings, on the threads of the current pool. `progress` is called with the finished
    /// part, 0 to 1. The same seed gives the same recordings on any number of threads.
    ///
    /// # Errors
    /// The simulated robot is not a possible one.
    pub fn simulate(
        self,
        seed: u64,
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<Simulated, SimulateError> {
        self.simulate_machine(&self.machine()?, seed, progress)
    }

    /// Simulates the protocol with another robot of the same arm, see [`Protocol::simulate`] and [`Machine::plain`].
    ///
    /// # Errors
    /// The simulated robot is not a possible one.
    pub fn simulate_machine(
        self,
        machine: &Machine,
        seed: u64,
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<Simulated, SimulateError> {
        match self {
            Self::Ur5 => ur5::simulate(machine, seed, progress),
            Self::Kr300 => kr300::simulate(machine, seed, progress),
            Self::FoxbotA05 => foxbot::simulate(machine, seed, progress),
        }
    }
}

/// Edition of the simulation, raised with every change of its results, so that no cache goes stale.
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
