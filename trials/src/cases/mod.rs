//! Sealed diagnosis cases: a simulator's model, recordings of a slightly different robot with one withheld effect,
//! and the answer.
//!
//! [`draw`] or, nearer to real recordings, [`draw_hard`] chooses the kind of a case. [`generate`] makes it.
//! [`write()`] writes the files that a diagnosis reads (`cases/ID/`) and the one that it must not read
//! (`truth/ID.json`). Equal index and seed give equal cases on any number of threads.

mod again;
mod case;
mod experiment;
mod generate;
mod hard;
mod kind;
mod nearly;
mod oracle;
mod rehearsal;
mod sensors;
mod size;
mod truth;
mod witness;
mod write;

pub use crate::effects::{EFFECTS, Origin};
pub use again::GENERATOR;
pub use case::Case;
pub use generate::{generate, generate_with, name, witnessed};
pub use hard::{HardTruth, NamedShare, OF_A_GEAR};
pub use kind::{
    CaseSpec, HARD_ROUND, Kind, ROUND, draw, draw_hard, draw_hard_only, draw_only, draw_without,
    effect_index, frequencies,
};
#[cfg(test)]
pub(crate) use oracle::left_by_parameters;
pub use oracle::{Nrmse, Oracle};
pub use sensors::Sensors;
pub use truth::{PlantTruth, Truth, TruthEffect};
pub use witness::{Mechanism, TorqueLog, Witness};
pub use write::{write, write_all};
pub(crate) use write::{write_sealed, write_whole};
