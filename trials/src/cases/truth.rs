//! The sealed answer of a case.

use super::oracle::Oracle;
use serde::Serialize;
use serde_json::Value;

/// The answer of a case, as `truth/ID.json` holds it.
#[derive(Debug, Clone, Serialize)]
pub struct Truth {
    /// Name of the case.
    pub case: String,
    /// Name of its [`super::Kind`].
    pub kind: String,
    /// Family of its robot.
    pub robot: String,
    /// Seed of the run, index of the case, attempt that succeeded.
    pub seed: [u64; 3],
    /// Number of joints.
    pub joints: usize,
    /// Withheld effects.
    pub effects: Vec<TruthEffect>,
    /// Root mean square of the torque without noise per joint, over all samples, N·m.
    pub torque_rms: Vec<f64>,
    /// The same of all effects together.
    pub effect_rms: Vec<f64>,
    /// What base parameters, Coulomb and viscous friction leave of them.
    pub unabsorbed_rms: Vec<f64>,
    /// Root mean square of the torque noise.
    pub noise_rms: Vec<f64>,
    /// Speed below which the plant's friction is softened, rad/s.
    pub v_eps: Vec<f64>,
    /// The best that can be had on the held-out recording.
    pub oracle: Oracle,
    /// The plant without the effect.
    pub plant: PlantTruth,
    /// Time that the case took to make, s.
    pub seconds: f64,
}

/// Parameters of the plant without the effect.
#[derive(Debug, Clone, Serialize)]
pub struct PlantTruth {
    /// Standard parameters of each link (inertia about the joint's origin).
    pub inertias: Vec<Vec<f64>>,
    /// Coulomb friction, N·m.
    #[serde(rename = "Fc")]
    pub coulomb: Vec<f64>,
    /// Viscous friction, N·m·s/rad.
    #[serde(rename = "Fv")]
    pub viscous: Vec<f64>,
}

/// One withheld effect.
#[derive(Debug, Clone, Serialize)]
pub struct TruthEffect {
    /// Name in the contract's table; `unknown` for one outside it.
    pub effect: String,
    /// Mechanism that made it.
    pub mechanism: String,
    /// `joint` where it belongs to joints, `global` where it belongs to the arm.
    pub scope: String,
    /// Joints whose torque it changes.
    pub joints: Vec<String>,
    /// Joint on which its shares are taken.
    pub reference_joint: String,
    /// Size, in the unit of the mechanism.
    pub level: f64,
    /// Its parameters.
    pub parameters: Value,
    /// Root mean square of its torque over that of the joint's.
    pub share: f64,
    /// The same after base parameters, Coulomb and viscous friction have taken what they can.
    pub share_after_reidentification: f64,
    /// That part over the torque noise.
    pub snr_after_reidentification: f64,
    /// Effects that no recording can tell from it.
    pub indistinguishable: Vec<String>,
}
