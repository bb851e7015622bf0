//! Every number that decides what a diagnosis says: a verdict, a listing, an acceptance, a guard.
//!
//! One file per room that decides, one field per number with its meaning, its unit (none: a ratio), its default and its
//! source:
//!
//! | source | the number is |
//! |---|---|
//! | contract | part of what the report means (`docs/formats.md`, `docs/diagnosis.md`): another value makes another format |
//! | tuned | found on simulated cases; a seed that it was found on proves nothing any more |
//! | physics | what robots, friction or statistics say, whatever the cases |
//!
//! What shapes a measurement (bands, windows, lags, grids of shapes, tolerances of an algorithm) stands where it is used, and
//! what one effect alone asks for in its file of the catalogue.

#[macro_use]
mod fields;
mod advice;
mod input;
mod ladder;
mod measure;
mod motion;
mod search;
#[cfg(test)]
mod tests;
mod traces;

pub use advice::AdviceSettings;
pub use input::InputSettings;
pub use ladder::LadderSettings;
pub use measure::{
    ConfidenceSettings, MeasureSettings, ResonanceSettings, SaidSettings, VerdictSettings,
};
pub use motion::MotionSettings;
pub use search::SearchSettings;
pub use traces::{BlowSettings, ContactSettings, StructureSettings, TraceSettings};

/// How gaps are weighed, room by room.
#[derive(Clone, Debug, Default)]
pub struct Settings {
    /// Reversals and rests.
    pub motion: MotionSettings,
    /// What a recording cannot show.
    pub input: InputSettings,
    /// Pushes, blows, structure.
    pub traces: TraceSettings,
    /// When a cause is accepted.
    pub search: SearchSettings,
    /// When it is listed.
    pub ladder: LadderSettings,
    /// Verdict, resonances, what else is said.
    pub measure: MeasureSettings,
    /// What is advised.
    pub advice: AdviceSettings,
}
