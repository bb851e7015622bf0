//! Motions that separate causes from each other.

/// A motion to record. Where several causes compete, the first in this order is advised.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Experiment {
    /// Rests, reached from either side.
    Rests,
    /// Level put on the robot's base; no motion.
    Level,
    /// The same motions with and without a known mass on the last link.
    KnownMass,
    /// The same motion at another temperature.
    ColdAndWarm,
    /// Slow motion over the joint's whole range, to and fro.
    WholeRange,
    /// Repetition of the same speeds under other loads.
    Loads,
    /// Constant speeds from the slowest to the fastest.
    Speeds,
    /// Many reversals of the velocity.
    Reversals,
}

impl Experiment {
    /// Instruction for the user, in a sentence.
    pub fn text(self) -> &'static str {
        match self {
            Self::Rests => "Record rests that are reached from both directions.",
            Self::Level => {
                "Put a level on the base: where the first axis lies flat, no motion tells a tilt from its joint's zero."
            }
            Self::KnownMass => {
                "Record the same motions with and without a known mass on the last link."
            }
            Self::ColdAndWarm => "Repeat one motion cold and warm.",
            Self::WholeRange => {
                "Record slow motion over the joint's whole range, to and fro, with and without load."
            }
            Self::Loads => "Repeat the same speeds in poses with different load, up and down.",
            Self::Speeds => "Record constant speeds from the slowest to the fastest.",
            Self::Reversals => "Record slow reversals of single joints, and fast ones.",
        }
    }
}
