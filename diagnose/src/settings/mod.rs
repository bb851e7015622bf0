//! Every number that decides what a diagnosis says: a verdict, a listing, an acceptance, a guard.
//!
//! One file per room that decides, one field per number with its meaning, its unit (none: a ratio), its default and its
//! source:
//!
//! | source | the number is |
//! |---|---|
//! | contract | part of what the report means (`docs/formats.md`, `docs/diagnosis-proof.md`): another value makes another format |
//! | tuned | found on simulated cases; a seed that it was found on proves nothing any more |
//! | physics | what robots, friction or statistics say, whatever the cases |
//!
//! Settings of a measurement (bands, windows, lags, grids of shapes, tolerances of an algorithm) stand where
//! they are used, and those of one effect alone in its file of the catalogue.

#[macro_use]
mod fields;
mod advice;
mod input;
mod ladder;
mod measure;
mod motion;
mod rules;
mod search;
#[cfg(test)]
mod tests;
mod traces;

pub use advice::AdviceSettings;
pub use input::InputSettings;
pub use ladder::LadderSettings;
pub use measure::{
    ConfidenceSettings, MeasureSettings, OtherDaySettings, ResonanceSettings, SaidSettings,
    VerdictSettings,
};
pub use motion::MotionSettings;
pub use rules::{Off, Rule};
pub use search::SearchSettings;
pub use traces::{BlowSettings, ContactSettings, StructureSettings, TraceSettings};

/// All thresholds of a diagnosis, room by room.
#[derive(Clone, Debug, Default)]
pub struct Settings {
    /// Thresholds of joints' reversals and rests.
    pub motion: MotionSettings,
    /// Limits of what a recording can show.
    pub input: InputSettings,
    /// Pushes, blows, structure.
    pub traces: TraceSettings,
    /// Acceptance of causes by the search.
    pub search: SearchSettings,
    /// Listing of accepted causes in the report.
    pub ladder: LadderSettings,
    /// Verdict, resonances and further statements.
    pub measure: MeasureSettings,
    /// Guards of the advised motion.
    pub advice: AdviceSettings,
}

impl Settings {
    /// Settings with one number multiplied by a factor. `name` is `room.field` as in the documentation. None where no
    /// setting has that name.
    pub fn scaled(&self, name: &str, factor: f64) -> Option<Self> {
        let mut own = self.clone();
        let (room, field) = name.rsplit_once('.')?;
        let known = match room {
            "motion" => own.motion.scale(field, factor),
            "input" => own.input.scale(field, factor),
            "traces.contact" => own.traces.contact.scale(field, factor),
            "traces.blows" => own.traces.blows.scale(field, factor),
            "traces.structure" => own.traces.structure.scale(field, factor),
            "search" => own.search.scale(field, factor),
            "ladder" => own.ladder.scale(field, factor),
            "measure.verdict" => own.measure.verdict.scale(field, factor),
            "measure.confidence" => own.measure.confidence.scale(field, factor),
            "measure.resonance" => own.measure.resonance.scale(field, factor),
            "measure.said" => own.measure.said.scale(field, factor),
            "measure.other_day" => own.measure.other_day.scale(field, factor),
            "advice" => own.advice.scale(field, factor),
            _ => false,
        };
        known.then_some(own)
    }
}
