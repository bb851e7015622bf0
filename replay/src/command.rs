//! Commanded signal of one joint as a function of time.

/// Value of a command between two recorded commands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Interpolation {
    /// Last command, held until the next.
    #[default]
    Hold,
    /// Straight line from each command to the next.
    Linear,
}

/// Commanded position or velocity of one joint over one trajectory, with its running integral.
///
/// A simulation step uses the mean of the command over the step. A delay that is no multiple of the step then acts
/// continuously. It also has a derivative where commands are held.
#[derive(Debug, Clone)]
pub struct Command {
    /// Times of the recorded commands, s, increasing.
    time: Vec<f64>,
    /// Recorded command at each time.
    value: Vec<f64>,
    /// Integral of the command from the first time to each time.
    integral: Vec<f64>,
    /// Value between two recorded commands.
    interpolation: Interpolation,
}

impl Command {
    /// Command with the values `value` at the times `time` (s, increasing, at least one).
    pub fn new(time: &[f64], value: Vec<f64>, interpolation: Interpolation) -> Self {
        let mut integral = vec![0.0; time.len()];
        for k in 1..time.len() {
            let mean = match interpolation {
                Interpolation::Hold => value[k - 1],
                Interpolation::Linear => 0.5 * (value[k - 1] + value[k]),
            };
            integral[k] = integral[k - 1] + mean * (time[k] - time[k - 1]);
        }
        Self {
            time: time.to_vec(),
            value,
            integral,
            interpolation,
        }
    }

    /// Index of the last recorded command at or before time `t`; none before the first. The search begins at index
    /// `hint`, which becomes the result.
    fn before(&self, t: f64, hint: &mut usize) -> Option<usize> {
        if t < self.time[0] {
            return None;
        }
        let mut k = (*hint).min(self.time.len() - 1);
        while k > 0 && self.time[k] > t {
            k -= 1;
        }
        while k + 1 < self.time.len() && self.time[k + 1] <= t {
            k += 1;
        }
        *hint = k;
        Some(k)
    }

    /// Value and running integral at time `t`. The first command also holds before its time, and the last one after it.
    fn at(&self, t: f64, hint: &mut usize) -> (f64, f64) {
        let Some(k) = self.before(t, hint) else {
            return (self.value[0], self.value[0] * (t - self.time[0]));
        };
        let since = t - self.time[k];
        if self.interpolation == Interpolation::Hold || k + 1 == self.time.len() {
            return (self.value[k], self.integral[k] + self.value[k] * since);
        }
        let slope = (self.value[k + 1] - self.value[k]) / (self.time[k + 1] - self.time[k]);
        let value = self.value[k] + slope * since;
        (
            value,
            self.integral[k] + 0.5 * (self.value[k] + value) * since,
        )
    }

    /// Mean of the command over [t, t + h], and the derivative of that mean with respect to t. `hint` speeds up
    /// successive calls.
    pub fn mean(&self, t: f64, h: f64, hint: &mut usize) -> (f64, f64) {
        let (from, below) = self.at(t, hint);
        let (to, above) = self.at(t + h, hint);
        ((above - below) / h, (to - from) / h)
    }

    /// Value of the command at time `t`.
    pub fn value(&self, t: f64) -> f64 {
        let last = self.time.partition_point(|stamp| *stamp <= t);
        self.at(t, &mut last.saturating_sub(1)).0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_held_command_changes_gradually_within_a_step() {
        let command = Command::new(&[0.0, 1.0, 2.0], vec![0.0, 1.0, 3.0], Interpolation::Hold);
        // Of the step from 0.75 to 1.25 the second half has the second command.
        let (mean, rate) = command.mean(0.75, 0.5, &mut 0);
        assert!((mean - 0.5).abs() < 1e-15 && (rate - 2.0).abs() < 1e-15);
        assert_eq!(command.mean(-3.0, 0.5, &mut 2).0, 0.0);
        assert_eq!(command.mean(7.0, 0.5, &mut 0).0, 3.0);
    }

    #[test]
    fn a_line_has_its_own_mean() {
        let command = Command::new(&[0.0, 1.0, 2.0], vec![0.0, 1.0, 3.0], Interpolation::Linear);
        let (mean, rate) = command.mean(0.5, 1.0, &mut 0);
        // 0.5 to 1 over half a second, 1 to 2 over the other half.
        assert!((mean - (0.75 * 0.5 + 1.5 * 0.5)).abs() < 1e-15);
        assert!((rate - 1.5).abs() < 1e-15);
    }
}
