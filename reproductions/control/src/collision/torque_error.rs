//! The softMC manual's detector.

/// Torque error behind an exponential filter: TE ← F·TE + (1 − F)·(model − measured), F from 0 to 1 (TorqueErrorFilter; the manual
/// calls it an averaging filter and its formula is a picture that our copy does not hold). It is compared with
/// TorqueErrorMax, joint by joint.
#[derive(Debug, Clone)]
pub struct TorqueError {
    filter: f64,
    value: Vec<f64>,
}

impl TorqueError {
    /// For `dof` joints with TorqueErrorFilter `filter`.
    pub fn new(dof: usize, filter: f64) -> Self {
        Self {
            filter,
            value: vec![0.0; dof],
        }
    }

    /// The filter of a time constant at a sample time, s.
    pub fn filter(time_constant: f64, dt: f64) -> f64 {
        (-dt / time_constant).exp()
    }

    /// Starts anew.
    pub fn reset(&mut self) {
        self.value.fill(0.0);
    }

    /// The next sample's torque error of every joint, N·m or N.
    pub fn step(&mut self, model: &[f64], measured: &[f64]) -> &[f64] {
        for (value, (m, tau)) in self.value.iter_mut().zip(model.iter().zip(measured)) {
            *value += (1.0 - self.filter) * (m - tau - *value);
        }
        &self.value
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// F = 0.5: 4 N·m of error show as 2, 3, 3.5.
    #[test]
    fn by_hand() {
        let mut error = TorqueError::new(1, 0.5);
        let seen: Vec<f64> = (0..3).map(|_| error.step(&[5.0], &[1.0])[0]).collect();
        assert_eq!(seen, [2.0, 3.0, 3.5]);
        assert!((TorqueError::filter(0.01, 0.001) - 0.904_837_418).abs() < 1e-9);
    }
}
