//! Confidence of a cause: the estimated probability that it has the right name.
//!
//! Lead and what is left are combined by logistic regression over simulated cases with known truth (`diagnose prove
//! --calibrate` fits the weights and prints them). So of the causes named with a confidence of 0.8, four in
//! five are right there. Without such weights in the settings there is no confidence, and the report gives the
//! evidence alone.

use crate::catalogue::effect::Effect;
use crate::schema::Support;
use crate::search::find::{Accepted, Findings};
use crate::settings::ConfidenceSettings;
use crate::traces::unknown::Misfit;

/// Names of the terms that the weights multiply.
pub const TERMS: [&str; 3] = ["constant", "ln(1 + lead)", "ln(1 + structure left in %)"];
/// Number of weights of the logistic regression.
pub const WEIGHTS: usize = TERMS.len();

impl Support {
    /// Evidence for an accepted cause. `left` is the structure in the residual by joint. None where its own columns were
    /// refused in its place.
    pub fn new(found: &Findings, cause: &Accepted, left: &[Option<Misfit>]) -> Option<Self> {
        let own = place(found, cause.candidate);
        let best = |same: bool| {
            let mut tried = cause.tried.iter();
            tried.find(|t| (place(found, t.candidate) == own) == same)
        };
        let gain = best(true)?.gain;
        let structured = own.1.iter().filter_map(|&j| left[j].as_ref());
        Some(Self {
            lead: gain - best(false).map_or(0.0, |t| t.gain.max(0.0)),
            left: structured.map(Misfit::structured).fold(0.0, f64::max),
        })
    }

    /// Values of the terms that the weights multiply, in the order of `TERMS`.
    pub fn terms(&self) -> [f64; WEIGHTS] {
        [1.0, self.lead.max(0.0).ln_1p(), (100.0 * self.left).ln_1p()]
    }

    /// Probability that effect and joint are right, where there are weights.
    pub fn confidence(&self, settings: &ConfidenceSettings) -> Option<f64> {
        let weights = settings.weights.as_ref()?;
        Some(probability(&self.terms(), weights))
    }
}

/// Effect, joints and driver of a candidate.
fn place(found: &Findings, candidate: usize) -> (Effect, &[usize], Option<usize>) {
    let c = &found.candidates[candidate];
    (c.effect, &c.joints, c.driver)
}

/// Logistic function of the weighted sum of the terms.
pub fn probability(terms: &[f64; WEIGHTS], weights: &[f64; WEIGHTS]) -> f64 {
    let odds: f64 = terms.iter().zip(weights).map(|(t, w)| t * w).sum();
    1.0 / (1.0 + (-odds).exp())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn odds_are_weighed_sums_of_logarithms() {
        let e = std::f64::consts::E;
        let support = Support {
            lead: e - 1.0,
            left: (e * e - 1.0) / 100.0,
        };
        let terms = support.terms();
        for (term, by_hand) in terms.iter().zip([1.0, 1.0, 2.0]) {
            assert!((term - by_hand).abs() < 1e-12, "{terms:?}");
        }
        // Three to one: constant ln 6, and two halves of a logarithm of 2 against it.
        let weights = [6.0_f64.ln(), 0.0, -0.5 * 2.0_f64.ln()];
        assert!((probability(&terms, &weights) - 0.75).abs() < 1e-12);
        let settings = ConfidenceSettings { weights: None };
        assert_eq!(support.confidence(&settings), None);
        let settings = ConfidenceSettings {
            weights: Some(weights),
        };
        assert!((support.confidence(&settings).unwrap() - 0.75).abs() < 1e-12);
    }
}
