//! Friction that changes evenly over a session: wear, a lubricant that runs out.

use super::Term;
use serde::{Deserialize, Serialize};

/// Number of session lengths before the start and after the end up to which the change goes on.
const BEYOND: f64 = 1.0;

/// (t − start)/span times another term, t being the session clock.
///
/// The factor stays in [−1, 2], one session's length beyond either end: nothing is extrapolated without bound. A recording
/// that does not continue a known clock uses `neutral`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Drift {
    /// Term of which the coefficient changes.
    pub term: Box<Term>,
    /// Start of the session on the recordings' clock, s.
    pub start: f64,
    /// Length of the session, s.
    pub span: f64,
    /// Factor where the clock is unknown.
    pub neutral: f64,
}

impl Drift {
    /// Factor at `clock` (None: unknown).
    pub fn factor(&self, clock: Option<f64>) -> f64 {
        clock.map_or(self.neutral, |t| {
            ((t - self.start) / self.span).clamp(-BEYOND, 1.0 + BEYOND)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factor_is_bounded() {
        let drift = Drift {
            term: Box::new(Term::Offset),
            start: 50.0,
            span: 200.0,
            neutral: 0.5,
        };
        assert_eq!(drift.factor(Some(100.0)), 0.25);
        assert_eq!(drift.factor(Some(1e9)), 2.0);
        assert_eq!(drift.factor(Some(-1e9)), -1.0);
        assert_eq!(drift.factor(None), 0.5);
    }
}
