//! Report of a diagnosis of motion, as the JSON file has it (schema `replay/1`).
//!
//! Lists by joint are in the order of `Report::joints`. The held-out recording is that on which all figures are
//! measured.

use crate::score::Figures;
use serde::Serialize;

/// Report of a diagnosis of motion: verdict, causes with their values, the corrected simulator, and what stays open.
#[derive(Debug, Clone, Serialize)]
pub struct Report {
    /// Name and version of the schema: `replay/1`.
    pub schema: &'static str,
    /// Names of the joints, base first.
    pub joints: Vec<String>,
    /// Verdict on the simulator: `no_gap`, `explained`, `partly_explained`, `unknown_effect` or `cannot_tell`.
    pub verdict: &'static str,
    /// Reason in words why nothing can be said; none unless the verdict is `cannot_tell`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// Earlier recordings to which the simulator was fitted first. None where the simulator as given was diagnosed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub compared: Option<Compared>,
    /// Errors on the held-out recording as the causes are added one by one: first the simulator as given, then with each
    /// cause. The last step is [`REPEATABILITY`] where the recording repeats a motion.
    pub ladder: Vec<Step>,
    /// Errors and drives of the corrected model file alone, whose format holds no friction by load or at standstill.
    pub file_alone: FileAlone,
    /// Errors of the corrected simulator on the held-out recording where its parameters are fitted to that recording itself. None
    /// where this was not asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ceiling: Option<Figures>,
    /// Regions of motion that hold more than their part of the squared error of the simulator as given, largest share
    /// first.
    #[serde(rename = "where")]
    pub places: Vec<Place>,
    /// Causes: effects more probable than not. Confirmed ones stand first; among equals the larger share of the gap
    /// does.
    pub causes: Vec<Cause>,
    /// Effects with an inclusion probability between 0.01 and 0.5, which are not listed as causes; most probable first.
    pub candidates: Vec<Candidate>,
    /// Quantities that this motion does not determine, each with the reason.
    pub not_identifiable: Vec<NotIdentifiable>,
    /// Joints on which an unknown torque, beside the causes, is more probable than not.
    pub unknown: Vec<UnknownJoint>,
    /// Drives of the corrected simulator.
    pub controller: Controller,
    /// Friction and rotor inertia of the joints of the corrected simulator.
    pub joint_parameters: JointParameters,
    /// Notes for the reader in words: assumptions, and oddities of the description.
    pub notes: Vec<String>,
}

/// Name of the ladder's step that is no simulator: one execution of a motion stands for another.
pub const REPEATABILITY: &str = "repeatability";

impl Report {
    /// Step of the corrected simulator: the ladder's last one that is a simulator.
    pub fn corrected(&self) -> Option<&Step> {
        self.ladder.iter().rfind(|s| s.step != REPEATABILITY)
    }
}

/// Comparison of the robot with itself at an earlier time.
#[derive(Debug, Clone, Serialize)]
pub struct Compared {
    /// Paths of the earlier recordings.
    pub before: Vec<String>,
}

/// Step of the ladder: the simulator with one more cause than at the step before.
#[derive(Debug, Clone, Serialize)]
pub struct Step {
    /// Name of the step: `as_given` for the first, `tolerances` where only values within their tolerance changed,
    /// [`REPEATABILITY`], else the added effect.
    pub step: String,
    /// Errors of this step's simulator on the held-out recording.
    #[serde(flatten)]
    pub figures: Figures,
}

/// Region of one joint's motion that holds more than its part of the squared error.
#[derive(Debug, Clone, Serialize)]
pub struct Place {
    /// Name of the joint.
    pub joint: String,
    /// Coordinate that the region is a range of: `velocity` (magnitude), `position`, `direction`, `time` or
    /// `command_time` (time since the command last changed).
    pub coordinate: &'static str,
    /// Lowest and highest value of the coordinate in the region.
    pub range: [f64; 2],
    /// Unit of `range`.
    pub unit: &'static str,
    /// Part, 0 to 1, of the squared error over all joints that lies in the region. Each joint's error is taken relative
    /// to its RMS of command less position.
    pub share_of_gap: f64,
    /// Part, 0 to 1, of the joint's samples that lie in the region.
    pub share_of_time: f64,
}

/// Value of one parameter of a cause, as given and as fitted.
#[derive(Debug, Clone, Serialize)]
pub struct Value {
    /// Name of the parameter, such as `kp` or `coulomb`.
    pub name: &'static str,
    /// Name of the joint; none for a parameter of the whole arm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub joint: Option<String>,
    /// Value in the simulator as given, in `unit`; none of a limit that is not given.
    pub given: Option<f64>,
    /// Fitted value, in `unit`.
    pub value: f64,
    /// Standard deviation of the fitted value, in `unit`; none where it was not fitted or has no finite one.
    pub std: Option<f64>,
    /// Unit of the values and the standard deviation; `1` for a pure number.
    pub unit: &'static str,
}

/// Cause of the gap: an effect more probable than not, on one or more joints.
#[derive(Debug, Clone, Serialize)]
pub struct Cause {
    /// Name of the effect, such as `servo_gain`.
    pub effect: &'static str,
    /// Kind of the effect: `parameter` for values of friction and links, `structure` for all others.
    pub kind: &'static str,
    /// Names of the joints that the effect acts on; all joints for an effect of the whole arm.
    pub joints: Vec<String>,
    /// Name of the joint whose motor turns these joints' links, too; none but for a coupling.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub driver: Option<String>,
    /// Posterior inclusion probability of the effect, 0 to 1; that of the least probable joint where there are several.
    pub confidence: f64,
    /// Share, 0 to 1, of this cause in the squared error that the causes remove on the held-out recording. Each cause's
    /// part is the error that returns without it; the shares sum to 1.
    pub share_of_gap: f64,
    /// Part of the squared error of its joints that the cause removes on the held-out recording, against a fit without
    /// the cause.
    pub gap_closed: f64,
    /// Lower and upper end of the 90 % confidence interval of `gap_closed`.
    pub gap_closed_interval: [f64; 2],
    /// Whether the whole interval of `gap_closed` lies above zero, so that the held-out recording confirms the cause.
    pub confirmed: bool,
    /// Always null: the decision is by posterior probability, not by a test.
    pub p_value: Option<f64>,
    /// Values of the effect's parameters. Parameters at their lower bound zero are left out.
    pub parameters: Vec<Value>,
    /// Names of other effects that explain this motion about as well in this one's place.
    pub ambiguous_with: Vec<&'static str>,
}

/// Effect that was considered and not listed as a cause.
#[derive(Debug, Clone, Serialize)]
pub struct Candidate {
    /// Name of the effect.
    pub effect: &'static str,
    /// Name of the joint that it would act on; all joints for an effect of the whole arm.
    pub joints: Vec<String>,
    /// Posterior inclusion probability, 0.01 to 0.5.
    pub probability: f64,
}

/// Quantity that this motion does not determine.
#[derive(Debug, Clone, Serialize)]
pub struct NotIdentifiable {
    /// Name of the effect that the quantity belongs to; none where it is a parameter of no listed cause.
    pub effect: Option<&'static str>,
    /// Names of the joints concerned.
    pub joints: Vec<String>,
    /// Reason in words: too little motion, a value at its bound, or two values of which only the combination is
    /// known.
    pub reason: String,
    /// Reason as a word for programs.
    pub finding: Finding,
    /// Values that it is about; none of a joint that never moves.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub values: Vec<Named>,
}

/// Why a quantity is not determined.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Finding {
    /// The joint never moves.
    Still,
    /// The value is not told from zero.
    Zero,
    /// Two values are known by their sum or difference alone.
    Inseparable,
    /// What was assumed of the values is not halved.
    Little,
}

/// Parameter by its name in the report.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Named {
    /// Name of the parameter.
    pub name: &'static str,
    /// Name of the joint; none for a parameter of the whole arm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub joint: Option<String>,
}

/// Joint on which an unknown effect acts: a torque that no effect of the catalogue explains.
#[derive(Debug, Clone, Serialize)]
pub struct UnknownJoint {
    /// Name of the joint.
    pub joint: String,
    /// Posterior inclusion probability of the unknown torque, 0.5 to 1.
    pub probability: f64,
}

/// Corrected model file alone: the simulator without effects that the file's format cannot hold, fitted again without
/// them.
#[derive(Debug, Clone, Serialize)]
pub struct FileAlone {
    /// Errors of this simulator on the held-out recording.
    #[serde(flatten)]
    pub figures: Figures,
    /// Drives of this simulator; their standard deviations are null.
    pub controller: Controller,
}

/// Drives of a simulator. Each list has one value for each joint; units hold for rotary joints.
#[derive(Debug, Clone, Serialize)]
pub struct Controller {
    /// Kind of the controller: `pd`, `pid`, `cascade` or `dc_servo`.
    pub kind: &'static str,
    /// Proportional gain: torque per position error, N·m/rad.
    pub kp: Vec<f64>,
    /// Standard deviation of `kp`, N·m/rad; null where `kp` was not fitted.
    pub kp_std: Vec<Option<f64>>,
    /// Derivative gain: torque per velocity error, N·m·s/rad.
    pub kd: Vec<f64>,
    /// Standard deviation of `kd`, N·m·s/rad; null where `kd` was not fitted.
    pub kd_std: Vec<Option<f64>>,
    /// Delay from command to drive, s: common delay, delay of the joint and time constant of the command filter
    /// together.
    pub delay: Vec<f64>,
    /// Standard deviation of the delay, s: that of the filter's time constant, else of the common delay; null where
    /// neither was fitted.
    pub delay_std: Vec<Option<f64>>,
    /// Limit of the drive's torque, N·m, equal in both directions; null where there is none.
    pub limit: Vec<Option<f64>>,
    /// Constant that the drive adds to its commanded position, rad.
    pub command_zero: Vec<f64>,
    /// Part of the gravity torque of the given description, without a payload, that each drive adds to its own torque.
    /// It is one value for the arm, from 0 (none) to 1 (all of it).
    pub gravity_compensation: f64,
}

/// Friction and rotor inertia of the fitted joints, one value for each joint. Units hold for rotary joints.
#[derive(Debug, Clone, Serialize)]
pub struct JointParameters {
    /// Viscous friction coefficient, N·m·s/rad.
    pub damping: Vec<f64>,
    /// Coulomb friction, N·m.
    pub frictionloss: Vec<f64>,
    /// Rotor inertia reflected to the joint, kg·m².
    pub armature: Vec<f64>,
}
