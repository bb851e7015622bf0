//! What of a residual comes suddenly.

use super::TorqueError;

/// A residual less its own mean behind a slower exponential filter. What a model is wrong by changes with position, speed and
/// temperature, over tenths of a second and more; a contact comes at once. A push that lasts fades within the slow filter's time:
/// it is for the detector of the residual itself (a band for contacts and one for collisions: Haddadin, De Luca and
/// Albu-Schäffer, "Robot collisions: a survey", IEEE T-RO 33(6), 2017, section on monitoring signals).
#[derive(Debug, Clone)]
pub struct Sudden {
    slow: TorqueError,
    value: Vec<f64>,
}

impl Sudden {
    /// For `dof` joints with the slow filter's factor ([`TorqueError::filter`]).
    pub fn new(dof: usize, filter: f64) -> Self {
        Self {
            slow: TorqueError::new(dof, filter),
            value: vec![0.0; dof],
        }
    }

    /// Starts anew.
    pub fn reset(&mut self) {
        self.slow.reset();
        self.value.fill(0.0);
    }

    /// The next sample's sudden part of every joint's residual, N·m or N.
    pub fn step(&mut self, residual: &[f64]) -> &[f64] {
        let nothing = vec![0.0; residual.len()];
        let mean = self.slow.step(residual, &nothing);
        for ((value, r), m) in self.value.iter_mut().zip(residual).zip(mean) {
            *value = r - m;
        }
        &self.value
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// F = 0.5 and a residual of 8 N·m that lasts: 8 − 4, 8 − 6, 8 − 7.
    #[test]
    fn by_hand() {
        let mut sudden = Sudden::new(1, 0.5);
        let seen: Vec<f64> = (0..3).map(|_| sudden.step(&[8.0])[0]).collect();
        assert_eq!(seen, [4.0, 2.0, 1.0]);
        sudden.reset();
        assert_eq!(sudden.step(&[8.0])[0], 4.0);
    }
}
