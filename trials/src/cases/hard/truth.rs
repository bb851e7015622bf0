//! Answer of a hard case besides the withheld effect.

use serde::Serialize;

/// An effect on a joint, and the part of its torque that it makes.
#[derive(Debug, Clone, Serialize)]
pub struct NamedShare {
    /// Name of the effect on the joint.
    pub effect: &'static str,
    /// Name of the joint that has the effect.
    pub joint: String,
    /// Root mean square of the effect's torque over that of the joint's torque.
    pub share: f64,
}

/// Bias of one joint's torque.
#[derive(Debug, Clone, Serialize)]
pub struct Bias {
    /// Name of the joint with the bias.
    pub joint: String,
    /// Bias over the root mean square of the joint's torque, without unit.
    pub share: f64,
}

/// Filters of the joints' currents before the log.
#[derive(Debug, Clone, Serialize)]
pub struct LowPass {
    /// Whether all joints have the same filter.
    pub same: bool,
    /// First moment of each joint's filter, ms.
    pub lag_ms: Vec<f64>,
}

/// All properties that were drawn besides robot and effect.
#[derive(Debug, Clone, Serialize)]
pub struct HardTruth {
    /// Largest relative error of most described inertials.
    pub inertial_width: f64,
    /// Largest factor between described and real friction.
    pub friction_width: f64,
    /// Names of the joints whose friction is not described.
    pub no_friction: Vec<String>,
    /// Name of the law by which friction comes to rest.
    pub rest: String,
    /// Number of trajectories to fit on.
    pub train: usize,
    /// Number of trajectories to be judged on.
    pub test: usize,
    /// Length of the trajectories, s.
    pub duration: f64,
    /// Sampling rate of the log, Hz.
    pub rate: f64,
    /// Irregularity of the sampling times.
    pub jitter: &'static str,
    /// Whether velocity is recorded.
    pub velocity: bool,
    /// Whether the held-out trajectories are of another day.
    pub other_day: bool,
    /// Name of the file that alone has pushes (`train` or `heldout`).
    pub contact: Option<&'static str>,
    /// Filters that the currents went through.
    pub lowpass: LowPass,
    /// Bias of one joint's torque.
    pub bias: Bias,
    /// Outliers of the torque per minute, over all joints.
    pub outliers: f64,
    /// Small effects on the joints.
    pub background: Vec<NamedShare>,
}
