//! Raw recordings whose torque came through a channel with one fault, and healthy ones.
//!
//! Robot, motion, stamps and encoders are those of [`crate::raw`]. Here the torque is made differently: its
//! source (`source`) and the stages on the way to the log (`channel`). Nothing here depends on the recognition
//! of faults; [`generate`] gives the truth.

mod channel;
mod fault;
mod sheet;
mod source;
mod wrong;

pub use fault::Fault;
pub use sheet::DataSheet;
pub use wrong::{Wrong, against};

use crate::SimulateError;
use crate::raw::{ATTEMPTS, RUN_IN, TRACE_HZ, robot, sensors};
use datasets::Recording;
use physics::robot::Robot;
use plant::random::log_uniform;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use sha2::{Digest, Sha256};
use std::ops::Range;

/// A recording with the truth about its torque channel.
#[derive(Debug, Clone)]
pub struct ChannelCase {
    /// The robot as described: inertials nearly right; friction, gear ratios and torque constants in some descriptions.
    pub robot: Robot,
    /// Recording whose torque came through the channel.
    pub recording: Recording,
    /// Fault of the recorded torque.
    pub fault: Fault,
    /// Indices of the joints with the fault, from 0.
    pub joints: Vec<usize>,
    /// Data sheet: motor turns per joint turn, N·m/A at the motor, and rated torque on the link side in N·m.
    pub sheet: Vec<DataSheet>,
}

/// Simulates the recording at `index` of the run with this seed and fault; it is the same on every machine and thread.
///
/// # Errors
/// No random robot followed its reference, or one is not a possible robot.
pub fn generate(fault: Fault, seed: u64, index: u64) -> Result<ChannelCase, SimulateError> {
    let mut key = Sha256::new();
    key.update(b"channel");
    key.update(fault.name());
    key.update(seed.to_le_bytes());
    key.update(index.to_le_bytes());
    let key: [u8; 32] = key.finalize().into();
    for attempt in 0..ATTEMPTS {
        let mut rng = ChaCha8Rng::from_seed(key);
        rng.set_stream(attempt);
        if let Some(case) = attempt_case(fault, &mut rng)? {
            return Ok(case);
        }
    }
    Err(SimulateError::NoCase {
        kind: fault.name(),
        index,
    })
}

/// Errors of the controller's sensors where it is the controller's torque that is logged: it works with the motor's
/// encoder, before the gear.
const FINE: f64 = 0.02;

/// Largest factor between a unit and 1 N·m at which the unit counts as N·m.
const SAME: f64 = 1.3;

fn attempt_case(fault: Fault, rng: &mut ChaCha8Rng) -> Result<Option<ChannelCase>, SimulateError> {
    let rate_hz = [50.0, 100.0, 125.0, 200.0, 250.0, 500.0, 1000.0][rng.random_range(0..7)];
    let drawn = robot::draw(0.0, rng);
    let session = robot::session(&drawn.nominal, RUN_IN, rng);
    let coarse = if fault == Fault::Commanded { FINE } else { 1.0 };
    let Some(trace) = robot::run(&drawn, &session, TRACE_HZ, coarse, rng)? else {
        return Ok(None);
    };
    // What gravity takes is nothing to remove where no joint but a sliding one carries any.
    let settled = (RUN_IN * TRACE_HZ) as usize;
    let whole = trace.bounds();
    let parts: Vec<Range<usize>> = whole.windows(2).map(|w| w[0] + settled..w[1]).collect();
    let fed = source::torque(fault, &drawn, &trace, rng)?;
    if fault == Fault::GravityRemoved && !fed.gravity_varies {
        return Ok(None);
    }
    let mut sensors = sensors::draw(&drawn.nominal, rate_hz, rng);
    if fault == Fault::Filtered {
        // Who filters forwards and backwards does it on an even grid.
        (sensors.jitter, sensors.lost) = (0.0, 0.0);
    }
    let sheet: Vec<DataSheet> = sheet(&drawn, &trace.tau, rng);
    // Per cents that happen to be the N·m themselves are no fault.
    let same = |s: &DataSheet| (100.0 / s.rated).ln().abs() < SAME.ln();
    if fault == Fault::Percent && sheet.iter().all(same) {
        return Ok(None);
    }
    let mut recording = sensors.record("simulated", &trace, &fed.torque, &parts, rng);
    let joints = channel::pass(fault, &mut recording, &sheet, fed.exact, rng);
    let mut described = drawn.nominal.clone();
    let knows_friction = rng.random_bool(0.5);
    let knows_drives = rng.random_range(0..3);
    for (joint, own) in described.joints.iter_mut().zip(&sheet) {
        if !knows_friction {
            (joint.damping, joint.friction) = (0.0, 0.0);
        }
        joint.gear_ratio = (knows_drives > 0).then_some(own.gear_ratio);
        joint.torque_constant = (knows_drives > 1).then_some(own.torque_constant);
    }
    Ok(Some(ChannelCase {
        robot: described.robot()?,
        recording,
        fault,
        joints,
        sheet,
    }))
}

/// Drives that suit the torques of a motion.
fn sheet(drawn: &robot::Drawn, tau: &[f64], rng: &mut ChaCha8Rng) -> Vec<DataSheet> {
    let n = drawn.nominal.dof();
    // Makers use one kind of gear and few sizes of motor.
    let gear = log_uniform(rng, 50.0, 160.0);
    let constant = log_uniform(rng, 0.08, 0.25);
    (0..n)
        .map(|j| {
            let top = tau
                .iter()
                .skip(j)
                .step_by(n)
                .fold(0.0, |m: f64, t| m.max(t.abs()));
            let peak = top * rng.random_range(1.2..2.5);
            DataSheet {
                gear_ratio: (gear * log_uniform(rng, 0.8, 1.25)).round(),
                torque_constant: constant * log_uniform(rng, 0.8, 1.25) * motor_size(peak),
                rated: peak * rng.random_range(0.35..0.7),
            }
        })
        .collect()
}

/// Larger motors have more torque per current: over that of a motor for 100 N·m behind its gear.
fn motor_size(peak: f64) -> f64 {
    (peak / 100.0).max(0.2).powf(0.35)
}
