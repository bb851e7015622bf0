//! Sensors beyond the motor's encoder and current: link-side encoders and thermometers.

use super::case::Case;
use super::oracle::frictions;
use datasets::Recording;
use ndarray::{Array2, ArrayViewMut1};
use plant::arm::Arm;
use plant::run::Trace;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::TAU;

/// Time constant of gears whose temperature no mechanism follows, s.
const WARMING: f64 = 110.0;

/// Choice of a case's further sensors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Sensors {
    /// Whether links have encoders of their own.
    pub links: bool,
    /// Whether every joint has a thermometer.
    pub temperatures: bool,
}

impl Sensors {
    /// Adds readings of these sensors of the true link positions and temperatures to the case's recordings.
    /// They are drawn from a stream of their own, so that nothing else of the case changes.
    pub(super) fn record(self, case: &mut Case, key: [u8; 32]) {
        let mut rng = ChaCha8Rng::from_seed(key);
        rng.set_stream(u64::MAX);
        let dof = case.train.dof();
        let encoders: Vec<LinkEncoder> = (0..dof).map(|_| LinkEncoder::draw(&mut rng)).collect();
        let thermometers: Vec<Thermometer> =
            (0..dof).map(|_| Thermometer::draw(&mut rng)).collect();
        for recording in [&mut case.train, &mut case.test] {
            recording.ql = recording.ql.take().filter(|_| self.links);
            for (encoder, column) in encoders.iter().zip(columns(&mut recording.ql)) {
                encoder.read(column, &mut rng);
            }
            recording.temp = recording.temp.take().filter(|_| self.temperatures);
            for (thermometer, column) in thermometers.iter().zip(columns(&mut recording.temp)) {
                thermometer.read(&recording.time, column, &mut rng);
            }
        }
    }
}

fn columns(table: &mut Option<Array2<f64>>) -> impl Iterator<Item = ArrayViewMut1<'_, f64>> {
    table.iter_mut().flat_map(|t| t.columns_mut())
}

/// An encoder on a link, mounted by hand.
struct LinkEncoder {
    /// Step of the encoder's count, rad (m).
    count: f64,
    /// Standard deviation of the encoder's noise, steps.
    noise: f64,
    /// Offset of the encoder's zero, rad (m).
    zero: f64,
    /// Error of the encoder once a turn by its disc's eccentricity, rad, and its phase.
    eccentric: [f64; 2],
}

impl LinkEncoder {
    fn draw(rng: &mut ChaCha8Rng) -> Self {
        Self {
            count: TAU / f64::from(1u32 << rng.random_range(17..21)),
            noise: rng.random_range(0.2..0.6),
            zero: rng.random_range(-0.02..0.02),
            eccentric: [rng.random_range(0.0..1e-4), rng.random_range(0.0..TAU)],
        }
    }

    fn read(&self, mut link: ArrayViewMut1<f64>, rng: &mut ChaCha8Rng) {
        let [size, phase] = self.eccentric;
        link.mapv_inplace(|q| {
            let z: f64 = StandardNormal.sample(rng);
            let seen = q + self.zero + size * (q + phase).sin();
            (seen / self.count + self.noise * z).round() * self.count
        });
    }
}

/// A thermometer near a gear.
struct Thermometer {
    /// Temperature of the room, °C.
    room: f64,
    /// Rise of the temperature at the steady state, K.
    rise: f64,
    /// Time constant by which the reading is late, s.
    lag: f64,
    /// Resolution of the reading, K.
    step: f64,
    /// Standard deviation of the reading's noise, K.
    noise: f64,
}

impl Thermometer {
    fn draw(rng: &mut ChaCha8Rng) -> Self {
        Self {
            room: rng.random_range(18.0..28.0),
            rise: rng.random_range(6.0..25.0),
            lag: rng.random_range(2.0..15.0),
            step: [0.1, 0.5, 1.0][rng.random_range(0..3)],
            noise: rng.random_range(0.02..0.2),
        }
    }

    /// Replaces relative temperatures by readings, °C.
    fn read(&self, time: &[f64], mut warmth: ArrayViewMut1<f64>, rng: &mut ChaCha8Rng) {
        let (mut shown, mut before) = (warmth[0], time[0]);
        for (warmth, &now) in warmth.iter_mut().zip(time) {
            shown += (1.0 - (-(now - before) / self.lag).exp()) * (*warmth - shown);
            before = now;
            let z: f64 = StandardNormal.sample(rng);
            let seen = self.room + self.rise * shown + self.noise * z;
            *warmth = (seen / self.step).round() * self.step;
        }
    }
}

/// Puts the true link positions and relative temperatures of a trace into its recording, for [`Sensors::record`].
pub(super) fn link_and_warmth(trace: &Trace, plain: &Arm, recording: &mut Recording) {
    let table = |values: Vec<f64>| {
        Array2::from_shape_vec((trace.len(), trace.dof), values)
            .expect("a trace has a value for each sample and joint")
    };
    recording.ql = Some(table(trace.link.clone()));
    recording.temp = Some(table(warmth(trace, plain)));
}

/// Relative temperature of all joints in every row: as the plant's mechanisms had it, else as friction heats the gear.
pub(super) fn warmth(trace: &Trace, plain: &Arm) -> Vec<f64> {
    let n = trace.dof;
    let mut out = trace.warmth.clone();
    for (j, friction) in frictions(plain).iter().enumerate() {
        if out.get(j).is_none_or(|w| w.is_finite()) {
            continue;
        }
        let speeds = trace.qd.iter().skip(j).step_by(n);
        let power: Vec<f64> = speeds.map(|&v| friction.torque(v) * v).collect();
        let mean = (power.iter().sum::<f64>() / power.len() as f64).max(1e-12);
        let mut state = 0.0;
        for k in 0..trace.len() {
            if k > 0 {
                let dt = trace.time[k] - trace.time[k - 1];
                state += (power[k] / mean - state) * (1.0 - (-dt / WARMING).exp());
            }
            out[k * n + j] = state;
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array1;

    #[test]
    fn an_encoder_reads_within_its_counts_and_a_thermometer_follows() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let encoder = LinkEncoder {
            count: 1e-4,
            noise: 0.3,
            zero: 0.01,
            eccentric: [0.0, 0.0],
        };
        let link = Array1::linspace(-1.0, 1.0, 1000);
        let mut seen = link.clone();
        encoder.read(seen.view_mut(), &mut rng);
        let off = &seen - &link - 0.01;
        assert!(off.iter().all(|x| x.abs() < 2.5e-4));
        assert!(off.std(0.0) > 2e-5 && off.mean().unwrap().abs() < 1e-5);

        let thermometer = Thermometer {
            room: 20.0,
            rise: 10.0,
            lag: 5.0,
            step: 0.1,
            noise: 0.0,
        };
        let time: Vec<f64> = (0..600).map(|k| 0.1 * f64::from(k)).collect();
        let mut warm = Array1::from_elem(600, 1.0);
        warm[0] = 0.0;
        thermometer.read(&time, warm.view_mut(), &mut rng);
        assert_eq!(warm[0], 20.0);
        // One time constant after the step.
        assert!((warm[50] - 26.3).abs() < 0.11, "{}", warm[50]);
        assert!((warm[599] - 30.0).abs() < 0.11);
    }
}
