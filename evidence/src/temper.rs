//! Probabilities that are too sure.

/// Smallest probability, and distance from certainty, that is tempered: no check reaches odds beyond a million to one.
const SUREST: f64 = 1e-6;

/// Probability whose odds are those of `probability` raised to `power`. A power below 1 is for probabilities that are too
/// sure.
pub fn tempered(probability: f64, power: f64) -> f64 {
    let p = probability.clamp(SUREST, 1.0 - SUREST);
    let odds = (p / (1.0 - p)).powf(power);
    odds / (1.0 + odds)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn odds_are_taken_to_the_power() {
        assert!((tempered(0.99, 0.5) - 99.0_f64.sqrt() / (1.0 + 99.0_f64.sqrt())).abs() < 1e-12);
        assert!((tempered(0.3, 1.0) - 0.3).abs() < 1e-12);
        assert_eq!(tempered(0.5, 0.2), 0.5);
        assert!(tempered(1.0, 0.2) < 1.0);
    }
}
