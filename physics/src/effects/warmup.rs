//! Friction that falls while gearboxes warm up.

use super::Term;
use serde::{Deserialize, Serialize};

/// exp(−t/time_constant) times another term, t being the session clock since its start.
///
/// The factor stays in [0, 1]: nothing is extrapolated without bound. A recording that does not
/// continue a known clock uses `neutral`, the factor's mean over the training samples.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WarmUp {
    /// Term of which the coefficient decays.
    pub term: Box<Term>,
    /// Time constant of the decay, s.
    pub time_constant: f64,
    /// Start of the session on the recordings' clock, s.
    pub start: f64,
    /// Factor where the clock is unknown.
    pub neutral: f64,
}

impl WarmUp {
    /// Factor at `clock` (None: unknown), in [0, 1].
    pub fn factor(&self, clock: Option<f64>) -> f64 {
        clock.map_or(self.neutral, |t| {
            (-(t - self.start).max(0.0) / self.time_constant).exp()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factor_is_bounded() {
        let w = WarmUp {
            term: Box::new(Term::Offset),
            time_constant: 100.0,
            start: 50.0,
            neutral: 0.4,
        };
        assert_eq!(w.factor(Some(-1e9)), 1.0);
        assert_eq!(w.factor(Some(1e9)), 0.0);
        assert_eq!(w.factor(None), 0.4);
        assert!((w.factor(Some(150.0)) - (-1f64).exp()).abs() < 1e-15);
    }
}
