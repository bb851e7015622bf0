//! A causal low-pass that gives its output's derivatives, at stamps that need not be even.

use std::f64::consts::FRAC_1_SQRT_2;

/// State of a second-order low-pass ẍ = ω²(u − x) − 2ζωẋ with ζ = 1/√2, and its input.
///
/// The state is solved exactly over each step, whatever its length, with the input linear between samples. So position,
/// velocity and acceleration come at once, and uneven stamps cost nothing: differences of a filtered position would divide
/// each stamp's jitter into the acceleration. A sample changes the state from its own time on, never before.
#[derive(Clone, Copy, Debug)]
pub struct StateVariable {
    /// ω/√2, 1/s: decay and angular frequency of the poles.
    a: f64,
    time: f64,
    input: f64,
    position: f64,
    velocity: f64,
}

impl StateVariable {
    /// At rest on the first sample: `input` at `time`, s. `cutoff_hz` is positive, the frequency at which the gain is 1/√2.
    pub fn at_rest(cutoff_hz: f64, time: f64, input: f64) -> Self {
        Self {
            a: 2.0 * std::f64::consts::PI * cutoff_hz * FRAC_1_SQRT_2,
            time,
            input,
            position: input,
            velocity: 0.0,
        }
    }

    /// Takes the sample `input` at `time`, s, which is later than the last one.
    pub fn step(&mut self, time: f64, input: f64) {
        let (a, dt) = (self.a, time - self.time);
        let slope = (input - self.input) / dt;
        // Distances from the answer to an endless ramp of this slope, which lags by 2ζ/ω = 1/a.
        let z = self.position - (self.input - slope / a);
        let v = self.velocity - slope;
        let (sin, cos) = (a * dt).sin_cos();
        let decay = (-a * dt).exp();
        self.position = input - slope / a + decay * (z * cos + (v / a + z) * sin);
        self.velocity = slope + decay * (v * cos - (v + 2.0 * a * z) * sin);
        (self.time, self.input) = (time, input);
    }

    /// Position, velocity and acceleration at the last sample.
    pub fn state(&self) -> [f64; 3] {
        let a = self.a;
        let pull = 2.0 * a * a * (self.input - self.position);
        [self.position, self.velocity, pull - 2.0 * a * self.velocity]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_from_rest_by_small_steps_of_the_equation() {
        let hz = 3.0;
        let omega = 2.0 * std::f64::consts::PI * hz;
        let input = |t: f64| 0.4 + 2.0 * t;
        let mut exact = StateVariable::at_rest(hz, 0.0, input(0.0));
        let (mut x, mut v, mut t) = (input(0.0), 0.0, 0.0);
        let fine = 1e-6;
        // Steps from a third of a time constant to three of them.
        for next in [0.02, 0.05, 0.21, 0.22] {
            exact.step(next, input(next));
            while t < next - 0.5 * fine {
                let a = omega * omega * (input(t) - x) - 2.0 * FRAC_1_SQRT_2 * omega * v;
                (x, v, t) = (x + fine * (v + 0.5 * fine * a), v + fine * a, t + fine);
            }
            let a = omega * omega * (input(t) - x) - 2.0 * FRAC_1_SQRT_2 * omega * v;
            for (found, wanted) in exact.state().iter().zip([x, v, a]) {
                assert!(
                    (found - wanted).abs() < 1e-4 * (1.0 + wanted.abs()),
                    "{next}: {found} {wanted}"
                );
            }
        }
    }

    #[test]
    fn one_step_or_many_over_a_straight_input() {
        let mut whole = StateVariable::at_rest(5.0, 1.0, 0.2);
        let mut parts = whole;
        whole.step(1.3, 0.8);
        for part in [1.01, 1.02, 1.15, 1.3] {
            parts.step(part, 0.2 + 2.0 * (part - 1.0));
        }
        for (a, b) in whole.state().iter().zip(parts.state()) {
            assert!((a - b).abs() < 1e-9, "{a} {b}");
        }
    }
}
