//! The sealed answer of a case.

use super::experiment::{Chosen, Experiment, Run, together};
use super::hard::HardTruth;
use super::kind::Kind;
use super::oracle::{Oracle, unabsorbed};
use super::size::column_rms;
use crate::effects::joint_name;
use physics::robot::RobotError;
use plant::arm::Arm;
use serde::Serialize;
use serde_json::Value;

/// The answer of a case, as `truth/ID.json` holds it.
#[derive(Debug, Clone, Serialize)]
pub struct Truth {
    /// Name of the case, as in its files.
    pub case: String,
    /// Name of its [`super::Kind`].
    pub kind: String,
    /// Family from which the robot was drawn.
    pub robot: String,
    /// Seed of the run, index of the case, attempt that succeeded.
    pub seed: [u64; 3],
    /// Version of the generator, where it is not the first.
    #[serde(skip_serializing_if = "is_first")]
    pub generator: u8,
    /// Whether motions are executed twice.
    #[serde(skip_serializing_if = "is_no")]
    pub repeats: bool,
    /// Number of joints of the robot.
    pub joints: usize,
    /// Withheld effects with their parameters.
    pub effects: Vec<TruthEffect>,
    /// Root mean square of the torque without noise per joint, over all samples, N·m.
    pub torque_rms: Vec<f64>,
    /// Root mean square torque of all effects together, by joint, N·m.
    pub effect_rms: Vec<f64>,
    /// Root mean square of the effects' torque beside base parameters, Coulomb and viscous friction, by joint, N·m.
    pub unabsorbed_rms: Vec<f64>,
    /// Root mean square of each joint's torque noise, N·m.
    pub noise_rms: Vec<f64>,
    /// Speed below which the plant's friction is softened, by joint, rad/s.
    pub v_eps: Vec<f64>,
    /// Least error that a model can have on the held-out recording.
    pub oracle: Oracle,
    /// The plant without the effect.
    pub plant: PlantTruth,
    /// Time that the case took to make, s.
    pub seconds: f64,
    /// Further drawn properties of a hard case.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hard: Option<HardTruth>,
}

impl Truth {
    /// Answer of a case. `found` are the torques of its effects in `run`, `noise` that of the recorded torque,
    /// row after row. Seed and time are left at zero.
    ///
    /// # Errors
    /// The bodies make no possible robot.
    pub(super) fn of(
        kind: Kind,
        id: &str,
        experiment: &Experiment,
        run: &Run,
        found: &[Vec<f64>],
        noise: &[f64],
        oracle: Oracle,
    ) -> Result<Self, RobotError> {
        let (trace, plain, withheld) = (&run.trace, experiment.plain, experiment.withheld);
        let n = trace.dof;
        let torque_rms = column_rms(&run.noted, n);
        let noise_rms = column_rms(noise, n);
        // All together, and where there are several each by itself.
        let mut parts = vec![together(found)];
        if withheld.len() > 1 {
            parts.extend(found.iter().cloned());
        }
        let left = unabsorbed(plain, &trace.q, &trace.qd, &trace.qdd, &noise_rms, &parts)?;
        let effects = withheld.iter().enumerate().map(|(i, w)| {
            let own = if withheld.len() > 1 { i + 1 } else { 0 };
            let strength = column_rms(&parts[own], n);
            TruthEffect::of(w, &strength, &left[own], &torque_rms, &noise_rms)
        });
        Ok(Self {
            case: id.to_owned(),
            kind: kind.name().to_owned(),
            robot: experiment.nominal.family.to_owned(),
            seed: [0; 3],
            generator: 1,
            repeats: false,
            joints: n,
            effects: effects.collect(),
            effect_rms: column_rms(&parts[0], n),
            unabsorbed_rms: left[0].clone(),
            torque_rms,
            noise_rms,
            v_eps: plain.v_eps.clone(),
            oracle,
            plant: PlantTruth::of(plain),
            seconds: 0.0,
            hard: None,
        })
    }
}

fn is_first(generator: &u8) -> bool {
    *generator == 1
}

fn is_no(repeats: &bool) -> bool {
    !repeats
}

/// Parameters of the plant without the effect.
#[derive(Debug, Clone, Serialize)]
pub struct PlantTruth {
    /// Standard parameters of each link (inertia about the joint's origin).
    pub inertias: Vec<Vec<f64>>,
    /// Coulomb friction of each joint, N·m.
    #[serde(rename = "Fc")]
    pub coulomb: Vec<f64>,
    /// Viscous friction of each joint, N·m·s/rad.
    #[serde(rename = "Fv")]
    pub viscous: Vec<f64>,
}

impl PlantTruth {
    fn of(plain: &Arm) -> Self {
        let inertia = |j: &physics::robot::Joint| j.link.inertia.parameters().to_vec();
        Self {
            inertias: plain.joints.iter().map(inertia).collect(),
            coulomb: plain.friction(),
            viscous: plain.damping(),
        }
    }
}

/// Withheld effect in a case's answer.
#[derive(Debug, Clone, Serialize)]
pub struct TruthEffect {
    /// Name of the effect in the contract's table; `unknown` for one outside it.
    pub effect: String,
    /// Name of the mechanism that made the torque.
    pub mechanism: String,
    /// Scope of the effect: `joint` where it belongs to joints, `global` where it belongs to the arm.
    pub scope: String,
    /// Names of the joints whose torque the effect changes.
    pub joints: Vec<String>,
    /// Name of the joint on which the effect's shares are taken.
    pub reference_joint: String,
    /// Size of the effect, in the unit of its mechanism.
    pub level: f64,
    /// Parameters of the mechanism.
    pub parameters: Value,
    /// Root mean square of its torque over that of the joint's.
    pub share: f64,
    /// Share after base parameters, Coulomb and viscous friction have absorbed what they can.
    pub share_after_reidentification: f64,
    /// Ratio of the root mean square of the part that is left after re-identification to that of the torque's noise.
    pub snr_after_reidentification: f64,
    /// Names of effects that no recording can tell from the effect.
    pub indistinguishable: Vec<String>,
}

impl TruthEffect {
    /// Answer on an effect. `strength` is the root mean square of its torque per joint, `left` that of its
    /// residual beside parameters.
    fn of(effect: &Chosen, strength: &[f64], left: &[f64], torque: &[f64], noise: &[f64]) -> Self {
        let (n, at) = (torque.len(), effect.at);
        let description = effect.effect.describe(effect.size, n);
        let scope = if description.joints.is_some() {
            "joint"
        } else {
            "global"
        };
        let touched = || (0..n).filter(|&j| strength[j] > 0.02 * torque[j]).collect();
        Self {
            effect: effect.name.to_owned(),
            mechanism: description.mechanism.to_owned(),
            scope: scope.to_owned(),
            joints: description
                .joints
                .unwrap_or_else(touched)
                .into_iter()
                .map(joint_name)
                .collect(),
            reference_joint: joint_name(at),
            level: effect.size,
            parameters: description.parameters,
            share: strength[at] / torque[at],
            share_after_reidentification: left[at] / torque[at],
            snr_after_reidentification: left[at] / noise[at],
            indistinguishable: description
                .indistinguishable
                .into_iter()
                .map(str::to_owned)
                .collect(),
        }
    }
}
