//! Raw recordings in the form of a controller's log, with the truth about their torque channel.
//!
//! A recording is a motion of a random robot (`robot`) seen through sensors (`sensors`) and a torque channel
//! (`channel`): a pure shift, a causal filter, gain, offset, noise and quantisation; jittered stamps, lost
//! packets, encoder counts, a velocity that may be late. The robot has a little of all effects that a rigid
//! body with viscous and Coulomb friction lacks. Its URDF is nearly right, so that no model is exact.
//! [`generate`] makes a recording of one motion or several, divides it into a training and a test part, and
//! gives the values that an estimator should find.

mod channel;
mod clock;
pub(crate) mod robot;
pub(crate) mod sensors;
mod truth;
mod write;

pub use crate::lag::Lag;
pub use clock::TRACE_HZ;
pub use truth::{RawTruth, Setting, best_shift};
pub use write::write;

use crate::SimulateError;
use datasets::Recording;
use physics::robot::to_urdf;
use plant::reference::Session;
use plant::run::Trace;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use sha2::{Digest, Sha256};
use std::ops::Range;

/// Time before each recorded trajectory, in which filters settle, s.
pub(crate) const RUN_IN: f64 = 0.5;
/// Part of a single motion, or of several, that is for fitting.
const TRAIN: f64 = 0.6;
/// Largest number of robots tried until one follows its reference.
pub(crate) const ATTEMPTS: u64 = 50;

/// A raw recording with its answer.
#[derive(Debug, Clone)]
pub struct RawCase {
    /// Name: ten hexadecimal digits without meaning.
    pub id: String,
    /// The robot's description, inertials nearly right.
    pub urdf: String,
    /// Recording on which delay and gains are estimated.
    pub train: Recording,
    /// Recording on which the estimates are tested.
    pub test: Recording,
    /// Truth about the recording.
    pub truth: RawTruth,
}

/// Simulates the recording at `index` of the run with this seed; it is the same on every machine and thread.
///
/// # Errors
/// No random robot followed its reference, or one is not a possible robot.
pub fn generate(seed: u64, index: u64) -> Result<RawCase, SimulateError> {
    let mut key = Sha256::new();
    key.update(b"raw");
    key.update(seed.to_le_bytes());
    key.update(index.to_le_bytes());
    let key: [u8; 32] = key.finalize().into();
    let id: String = key[..5].iter().map(|b| format!("{b:02x}")).collect();
    for attempt in 0..ATTEMPTS {
        let mut rng = ChaCha8Rng::from_seed(key);
        rng.set_stream(attempt);
        if let Some(case) = attempt_case(&id, seed, index, &mut rng)? {
            return Ok(case);
        }
    }
    Err(SimulateError::NoCase { kind: "raw", index })
}

fn attempt_case(
    id: &str,
    seed: u64,
    index: u64,
    rng: &mut ChaCha8Rng,
) -> Result<Option<RawCase>, SimulateError> {
    let rate_hz = [50.0, 100.0, 125.0, 200.0, 250.0, 500.0, 1000.0][rng.random_range(0..7)];
    let drawn = robot::draw(robot::SEEN_AT_THE_JOINT, rng);
    let session = robot::session(&drawn.nominal, RUN_IN, rng);
    let Some(trace) = robot::run(&drawn, &session, TRACE_HZ, 1.0, rng)? else {
        return Ok(None);
    };
    let parts = recorded_parts(&trace, &session);
    let channel = channel::draw(&trace, rate_hz, rng);
    let noted = channel.noted(&trace, rng);
    let sensors = sensors::draw(&drawn.nominal, rate_hz, rng);
    let truth = truth::of(
        &trace,
        &channel,
        &noted.filtered,
        &parts.0,
        truth::Setting {
            id: id.to_owned(),
            seed,
            index,
            robot: drawn.nominal.family.to_owned(),
            rate_hz,
            jitter: sensors.jitter,
            lost: sensors.lost,
            velocity_late: sensors.velocity_late,
            inertial_error: drawn.inertial_error,
        },
    );
    let label = |kind: &str| format!("raw-{id}-{kind}");
    let train = sensors.record(&label("train"), &trace, &noted.recorded, &parts.0, rng);
    let test = sensors.record(&label("test"), &trace, &noted.recorded, &parts.1, rng);
    Ok(Some(RawCase {
        id: id.to_owned(),
        urdf: to_urdf(&drawn.nominal.robot()?),
        train,
        test,
        truth,
    }))
}

/// Training and test rows of the trace. Of a single motion they are its first part and the remainder; of
/// several, each motion belongs to one of them as a whole.
fn recorded_parts(trace: &Trace, session: &Session) -> (Vec<Range<usize>>, Vec<Range<usize>>) {
    let bounds = trace.bounds();
    let settled = (RUN_IN * TRACE_HZ) as usize;
    let whole: Vec<Range<usize>> = bounds.windows(2).map(|w| w[0] + settled..w[1]).collect();
    if session.lengths.len() == 1 {
        let middle = whole[0].start + (TRAIN * whole[0].len() as f64) as usize;
        let (first, rest) = (whole[0].start..middle, middle..whole[0].end);
        return (vec![first], vec![rest]);
    }
    let count = ((TRAIN * whole.len() as f64).round() as usize).clamp(1, whole.len() - 1);
    let (first, rest) = whole.split_at(count);
    (first.to_vec(), rest.to_vec())
}
