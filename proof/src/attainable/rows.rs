//! Rows of a torque log that an observer compares: means of a few samples, whitened by the law of the log's errors.

use trials::cases::{TorqueLog, Witness};

/// Rate of the means, Hz: a quarter of a plain case's rows.
const RATE: f64 = 62.5;
/// Step of the plant, s, within which the instant of a reversal is not known.
const STEP: f64 = 5e-4;

/// Law of the errors of the rows, and the way from a torque to them.
pub struct Rows<'a> {
    log: &'a TorqueLog,
    /// Number of joints.
    pub dof: usize,
    /// Number of samples of the log in a mean.
    mean: usize,
    /// First row of each trajectory, and the end.
    pub starts: Vec<usize>,
    /// Of each joint and row: the part of the row before that is taken away, and the factor on what is left.
    weights: Vec<Vec<[f64; 2]>>,
}

/// Variance of the mean of `m` values of a process with variance 1 and correlation `r` of neighbours, and its covariance with the next such
/// mean.
fn of_means(m: usize, r: f64) -> [f64; 2] {
    let sum = |shift: usize| {
        let pairs = (0..m).flat_map(|a| (0..m).map(move |b| (b + shift).abs_diff(a)));
        pairs.map(|d| r.powi(d as i32)).sum::<f64>() / (m * m) as f64
    };
    [sum(0), sum(m)]
}

impl<'a> Rows<'a> {
    /// Rows of a witness's log.
    pub fn new(witness: &'a Witness) -> Self {
        let (log, n) = (&witness.log, witness.dof());
        let rate = 1.0 / (log.tick * log.every as f64);
        let mean = (rate / RATE).round().max(1.0) as usize;
        let mut starts = vec![0];
        for w in log.bounds.windows(2) {
            starts.push(starts[starts.len() - 1] + (w[1] - w[0]) / (log.every * mean));
        }
        let mut rows = Self {
            log,
            dof: n,
            mean,
            starts,
            weights: Vec::new(),
        };
        rows.weights = (0..n).map(|j| rows.weights_of(j, witness)).collect();
        rows
    }

    fn weights_of(&self, j: usize, witness: &Witness) -> Vec<[f64; 2]> {
        let (log, n) = (self.log, self.dof);
        let [variance, next] = of_means(self.mean, log.colour.powi(log.every as i32));
        let steps = log.quantum[j].powi(2) / 12.0 / self.mean as f64;
        let whole = log.noise[j].powi(2) * variance + steps;
        let kept = log.noise[j].powi(2) * next / whole;
        let friction = &witness.plain().joints[j].friction;
        let sign = |v: f64| witness.plain().rest.sign(v, witness.plain().v_eps[j]);
        let mut weights = Vec::with_capacity(self.starts[self.starts.len() - 1]);
        for (start, count) in self.spans() {
            let mut chained = false;
            for row in 0..count {
                let samples = self.samples(start, row);
                let lost = samples.clone().any(|k| log.outlier[k * n + j]);
                // Friction acts at the end of a step, the motion is known at its middle.
                let unsure = samples.map(|k| {
                    let [_, v, a] = witness.state(k);
                    friction * (sign(v[j] + a[j] * STEP) - sign(v[j])) / self.mean as f64
                });
                let unsure: f64 = unsure.map(|e| e * e).sum();
                let part = if chained { kept } else { 0.0 };
                let scale = 1.0 / (whole * (1.0 - part * part) + unsure).sqrt();
                weights.push(if lost { [0.0, 0.0] } else { [part, scale] });
                chained = !lost;
            }
        }
        weights
    }

    /// First row of the trace and number of rows of each trajectory.
    fn spans(&self) -> impl Iterator<Item = (usize, usize)> {
        let counts = self.starts.windows(2).map(|w| w[1] - w[0]);
        self.log.bounds.iter().copied().zip(counts)
    }

    /// Rows of the trace of which a row is the mean, of a trajectory that begins at `start`.
    fn samples(&self, start: usize, row: usize) -> impl Iterator<Item = usize> + Clone + use<> {
        let (every, mean) = (self.log.every, self.mean);
        (0..mean).map(move |i| start + (row * mean + i) * every)
    }

    /// Number of rows in which a joint's torque counts, in the first `trajectories`.
    pub fn counted(&self, trajectories: usize) -> usize {
        let weights = self.weights.iter();
        let own = weights.flat_map(|w| &w[..self.starts[trajectories]]);
        own.filter(|w| w[1] > 0.0).count()
    }

    /// Whitened rows of a torque of joint `j` before the filter, which has a value for each row of the trace from its begin.
    pub fn of_torque(&self, j: usize, torque: &[f64]) -> Vec<f64> {
        let mut filtered = Vec::with_capacity(torque.len());
        for w in self.log.bounds.windows(2) {
            if w[1] <= torque.len() {
                self.filter(j, &torque[w[0]..w[1]], &mut filtered);
            }
        }
        self.of_log(j, &filtered)
    }

    /// Appends the filtered torque of a trajectory.
    fn filter(&self, j: usize, torque: &[f64], filtered: &mut Vec<f64>) {
        let lag = self.log.lag[j];
        let Some([by_y, by_v]) = lag.per_tick(self.log.tick) else {
            filtered.extend(lag.apply(torque, self.log.tick));
            return;
        };
        let (mut y, mut v) = (torque.first().copied().unwrap_or(0.0), 0.0);
        filtered.extend(torque.iter().map(|x| {
            let [next, rate] = [by_y, by_v].map(|b| b[0] * y + b[1] * v + b[2] * x);
            (y, v) = (next, rate);
            y
        }));
    }

    /// Whitened rows of joint `j` of numbers as the log has them.
    pub fn of_log(&self, j: usize, logged: &[f64]) -> Vec<f64> {
        let mut rows = Vec::new();
        for (start, count) in self.spans() {
            if start >= logged.len() {
                break;
            }
            let mut before = 0.0;
            for row in 0..count {
                let sum: f64 = self.samples(start, row).map(|k| logged[k]).sum();
                let [part, scale] = self.weights[j][rows.len()];
                let here = sum / self.mean as f64;
                rows.push(scale * (here - part * before));
                before = here;
            }
        }
        rows
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_of_coloured_noise_have_their_covariances() {
        // Of two: (1 + r)/2, and (r + 2 r² + r³)/4 with the next two.
        let [variance, next] = of_means(2, 0.5);
        assert!((variance - 0.75).abs() < 1e-15);
        assert!((next - (0.5 + 0.5 + 0.125) / 4.0).abs() < 1e-15);
        let [variance, next] = of_means(4, 0.0);
        assert!((variance - 0.25).abs() < 1e-15 && next == 0.0);
    }
}
