//! Trajectories: sums of sines, periodic or not, with optional smooth start and stop along their path.

use ndarray::Array2;
use signal::Motion;

/// q_j(s) = δ_j + Σ_i (μ_ji sin(ω_ji s) + ν_ji cos(ω_ji s)) (Han et al., eq. 33; UR5 paper, eq. 11; COMAU paper, eq. 17 with
/// a = ωμ, b = −ων). The path s is the time itself, or, with a ramp, runs from rest to the pace of time and back to rest.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Duration of one run, s.
    pub duration: f64,
    /// Duration of the smooth start and of the smooth stop, s; 0: none.
    pub ramp: f64,
    /// Offset δ_j of each joint, rad (m), length N.
    pub offset: Vec<f64>,
    /// Angular frequencies ω_ji, rad/s, N × terms.
    pub pulsation: Array2<f64>,
    /// Coefficients μ_ji of the sines, rad (m), N × terms.
    pub sine: Array2<f64>,
    /// Coefficients ν_ji of the cosines, rad (m), N × terms.
    pub cosine: Array2<f64>,
}

/// Motion of all joints at one time; N values each.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct State {
    /// Positions of the joints, rad or m.
    pub q: Vec<f64>,
    /// Velocities of the joints, rad/s or m/s.
    pub qd: Vec<f64>,
    /// Acceleration, rad/s² or m/s².
    pub qdd: Vec<f64>,
    /// Jerks of the joints, rad/s³ or m/s³.
    pub qddd: Vec<f64>,
}

impl State {
    /// State at position zero without motion.
    pub fn new(dof: usize) -> Self {
        let zeros = || vec![0.0; dof];
        Self {
            q: zeros(),
            qd: zeros(),
            qdd: zeros(),
            qddd: zeros(),
        }
    }
}

/// Path and its first three derivatives by time during the smooth start of `ramp` seconds. The path is the
/// integral of 10u³ − 15u⁴ + 6u⁵; at both ends of the start its acceleration is zero.
pub(super) fn gathering(t: f64, ramp: f64) -> [f64; 4] {
    let u = t / ramp;
    let u2 = u * u;
    [
        ramp * u2 * u2 * (2.5 + u * (u - 3.0)),
        u2 * u * (10.0 + u * (6.0 * u - 15.0)),
        30.0 * u2 * (1.0 - u) * (1.0 - u) / ramp,
        60.0 * u * (1.0 - u) * (1.0 - 2.0 * u) / (ramp * ramp),
    ]
}

impl Series {
    /// Number of joints N of the motion.
    pub fn dof(&self) -> usize {
        self.offset.len()
    }

    /// State at time `t` of one run, 0 ≤ t ≤ duration (s).
    pub fn at(&self, t: f64, state: &mut State) {
        let [s, s1, s2, s3] = self.path(t);
        state.q.copy_from_slice(&self.offset);
        state.qd.fill(0.0);
        state.qdd.fill(0.0);
        state.qddd.fill(0.0);
        for j in 0..self.dof() {
            let (mut d1, mut d2, mut d3) = (0.0, 0.0, 0.0);
            for i in 0..self.sine.ncols() {
                let w = self.pulsation[(j, i)];
                let (sin, cos) = (w * s).sin_cos();
                let (mu, nu) = (self.sine[(j, i)], self.cosine[(j, i)]);
                let value = mu * sin + nu * cos;
                let slope = w * (mu * cos - nu * sin);
                state.q[j] += value;
                d1 += slope;
                d2 -= w * w * value;
                d3 -= w * w * slope;
            }
            state.qd[j] = d1 * s1;
            state.qdd[j] = d2 * s1 * s1 + d1 * s2;
            state.qddd[j] = d3 * s1 * s1 * s1 + 3.0 * d2 * s1 * s2 + d1 * s3;
        }
    }

    /// Path and its first three derivatives by time.
    fn path(&self, t: f64) -> [f64; 4] {
        if self.ramp <= 0.0 {
            return [t, 1.0, 0.0, 0.0];
        }
        let left = self.duration - t;
        if t < self.ramp {
            gathering(t, self.ramp)
        } else if left < self.ramp {
            let [s, s1, s2, s3] = gathering(left.max(0.0), self.ramp);
            [self.duration - self.ramp - s, s1, -s2, s3]
        } else {
            [t - 0.5 * self.ramp, 1.0, 0.0, 0.0]
        }
    }

    /// Position at the start, N values.
    pub fn start(&self) -> Vec<f64> {
        let mut state = State::new(self.dof());
        self.at(0.0, &mut state);
        state.q
    }

    /// Samples at `rate` (Hz) of `repeats` runs one after the other, both ends included, on a clock that begins at `start` (s).
    ///
    /// Only a motion that ends where it starts can be repeated without a jump.
    pub fn sampled(&self, rate: f64, repeats: usize, start: f64) -> Motion {
        let n = self.dof();
        let each = ((self.duration * rate).round() as usize).max(1);
        let samples = each * repeats + 1;
        let table = || Array2::<f64>::zeros((samples, n));
        let (mut q, mut qd, mut qdd) = (table(), table(), table());
        let mut state = State::new(n);
        for i in 0..samples {
            // The last sample is the end of a run, not the start of another.
            let k = if i + 1 == samples { each } else { i % each };
            self.at((k as f64 / rate).min(self.duration), &mut state);
            for j in 0..n {
                q[(i, j)] = state.q[j];
                qd[(i, j)] = state.qd[j];
                qdd[(i, j)] = state.qdd[j];
            }
        }
        Motion {
            time: (0..samples).map(|i| start + i as f64 / rate).collect(),
            q,
            qd,
            qdd,
            segments: std::iter::once(0..samples).collect(),
        }
    }

    /// Shrinks the motion towards a pose: every position is then `pose` + factor·(q − `pose`).
    pub fn shrink(&mut self, pose: &[f64], factor: f64) {
        for (offset, pose) in self.offset.iter_mut().zip(pose) {
            *offset = pose + factor * (*offset - pose);
        }
        self.sine *= factor;
        self.cosine *= factor;
    }

    /// Bounds of the joints' speeds by their amplitudes (Han et al., eq. 34, fourth constraint), N values.
    pub fn speed_bounds(&self) -> Vec<f64> {
        let of = |j: usize| {
            let each = (0..self.sine.ncols())
                .map(|i| self.pulsation[(j, i)] * self.sine[(j, i)].hypot(self.cosine[(j, i)]));
            each.sum::<f64>()
        };
        (0..self.dof()).map(of).collect()
    }
}
