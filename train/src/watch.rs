//! What a caller hears of a running training.

use crate::Progress;

/// Listener of a training; `()` hears nothing. Called from whatever thread works.
pub trait Watch: Sync {
    /// Hears a severe point of the description, of a recording or of the model, one line each. The program prints them, too, unless it is
    /// quiet.
    fn warns(&self, _line: &str) {}

    /// Hears of every epoch of a network.
    fn trained(&self, _progress: &Progress) {}
}

impl Watch for () {}
