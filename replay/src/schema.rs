//! The report as the JSON file has it (schema `replay/1`).

use crate::score::Figures;
use serde::Serialize;

/// A diagnosis of motion.
#[derive(Debug, Clone, Serialize)]
pub struct Report {
    /// `replay/1`
    pub schema: &'static str,
    /// Joint names, base first.
    pub joints: Vec<String>,
    /// `no_gap`, `explained`, `partly_explained`, `unknown_effect` or `cannot_tell`.
    pub verdict: &'static str,
    /// Why nothing can be said.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// The recordings that the simulator as given stands for, where what has changed since is asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub compared: Option<Compared>,
    /// How far the gap shrinks, step by step, on the held-out recording.
    pub ladder: Vec<Step>,
    /// What the written model file leaves by itself: it holds no friction by load or at standstill.
    pub file_alone: FileAlone,
    /// Where the gap lies.
    #[serde(rename = "where")]
    pub places: Vec<Place>,
    /// Listed effects, largest share first.
    pub causes: Vec<Cause>,
    /// What was weighed and not listed, most probable first.
    pub candidates: Vec<Candidate>,
    /// What this motion cannot show.
    pub not_identifiable: Vec<NotIdentifiable>,
    /// Joints on which something is left that no effect of the catalogue explains, with its probability.
    pub unknown: Vec<UnknownJoint>,
    /// The drives as fitted.
    pub controller: Controller,
    /// The joints as fitted.
    pub joint_parameters: JointParameters,
    /// What was assumed and what is odd.
    pub notes: Vec<String>,
}

/// A comparison of two days.
#[derive(Debug, Clone, Serialize)]
pub struct Compared {
    /// Recordings of the first.
    pub before: Vec<String>,
}

/// A step of the ladder.
#[derive(Debug, Clone, Serialize)]
pub struct Step {
    /// `as_given` or an effect.
    pub step: String,
    /// Figures of this step on the held-out recording.
    #[serde(flatten)]
    pub figures: Figures,
}

/// A region where the gap lies.
#[derive(Debug, Clone, Serialize)]
pub struct Place {
    /// Joint.
    pub joint: String,
    /// `velocity`, `position`, `direction`, `time` or `command_time`.
    pub coordinate: &'static str,
    /// Lower and upper end of the region.
    pub range: [f64; 2],
    /// Unit of the range.
    pub unit: &'static str,
    /// Share of the squared unexplained part, over all joints.
    pub share_of_gap: f64,
    /// Share of the samples.
    pub share_of_time: f64,
}

/// A parameter of a cause.
#[derive(Debug, Clone, Serialize)]
pub struct Value {
    /// Name.
    pub name: &'static str,
    /// Joint, where it belongs to one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub joint: Option<String>,
    /// Value that the simulator has.
    pub given: f64,
    /// Value that the motion shows.
    pub value: f64,
    /// Standard deviation.
    pub std: Option<f64>,
    /// Unit.
    pub unit: &'static str,
}

/// A listed effect.
#[derive(Debug, Clone, Serialize)]
pub struct Cause {
    /// Effect.
    pub effect: &'static str,
    /// `parameter` or `structure`.
    pub kind: &'static str,
    /// Joints that it touches.
    pub joints: Vec<String>,
    /// Posterior inclusion probability, of its least certain joint.
    pub confidence: f64,
    /// Part of what all causes remove.
    pub share_of_gap: f64,
    /// Part of its joints' squared error that it removes.
    pub gap_closed: f64,
    /// 90 % interval of the same.
    pub gap_closed_interval: [f64; 2],
    /// Whether the interval excludes zero.
    pub confirmed: bool,
    /// Always null: the decision is by evidence.
    pub p_value: Option<f64>,
    /// Sizes.
    pub parameters: Vec<Value>,
    /// Effects that this motion cannot tell from it.
    pub ambiguous_with: Vec<&'static str>,
}

/// An effect that was weighed.
#[derive(Debug, Clone, Serialize)]
pub struct Candidate {
    /// Effect.
    pub effect: &'static str,
    /// Joints.
    pub joints: Vec<String>,
    /// Posterior inclusion probability.
    pub probability: f64,
}

/// What this motion cannot show.
#[derive(Debug, Clone, Serialize)]
pub struct NotIdentifiable {
    /// Effect.
    pub effect: Option<&'static str>,
    /// Joints.
    pub joints: Vec<String>,
    /// Why.
    pub reason: String,
}

/// A joint with an unknown effect.
#[derive(Debug, Clone, Serialize)]
pub struct UnknownJoint {
    /// Joint.
    pub joint: String,
    /// Posterior probability.
    pub probability: f64,
}

/// What the written model file does, fitted for itself.
#[derive(Debug, Clone, Serialize)]
pub struct FileAlone {
    /// What it leaves on the held-out recording.
    #[serde(flatten)]
    pub figures: Figures,
    /// Its drives, of which no deviations are estimated.
    pub controller: Controller,
}

/// The drives as fitted, by joint.
#[derive(Debug, Clone, Serialize)]
pub struct Controller {
    /// `pd`, `pid`, `cascade` or `dc_servo`.
    pub kind: &'static str,
    /// Torque per error of position, N·m/rad.
    pub kp: Vec<f64>,
    /// Its standard deviation; null where it is the given value.
    pub kp_std: Vec<Option<f64>>,
    /// Torque per error of velocity, N·m·s/rad.
    pub kd: Vec<f64>,
    /// Its standard deviation.
    pub kd_std: Vec<Option<f64>>,
    /// Delay of commands, s.
    pub delay: Vec<f64>,
    /// Its standard deviation.
    pub delay_std: Vec<Option<f64>>,
    /// Limit of the torque, N·m; null where there is none.
    pub limit: Vec<Option<f64>>,
    /// What the drive adds to its command, rad.
    pub command_zero: Vec<f64>,
    /// Part of the gravity torque of the given description, without a payload, that each drive adds to its own torque:
    /// one value for the arm, from 0 (none) to 1 (all of it).
    pub gravity_compensation: f64,
}

/// The joints as fitted.
#[derive(Debug, Clone, Serialize)]
pub struct JointParameters {
    /// Viscous friction, N·m·s/rad.
    pub damping: Vec<f64>,
    /// Coulomb friction, N·m.
    pub frictionloss: Vec<f64>,
    /// Rotor inertia, kg·m².
    pub armature: Vec<f64>,
}
