//! The report as the JSON file has it (schema `diagnosis/1`).

pub(crate) mod value;

use crate::catalogue::effect::Effect;
use crate::catalogue::{Parameter, Unit};
use datasets::check::CheckReport;
use datasets::metrics::Scores;
use serde::{Deserialize, Serialize};

/// A diagnosis.
#[derive(Clone, Debug, Serialize)]
pub struct Diagnosis {
    /// `diagnosis/1`
    pub schema: &'static str,
    /// Joint names, base first.
    pub joints: Vec<String>,
    /// What it comes to.
    pub verdict: Verdict,
    /// Why nothing can be said, where the verdict is `cannot_tell`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// The earlier recordings that the gap is measured from instead of a simulator's model.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub compared: Option<Compared>,
    /// Why the model as given is nothing to measure a gap from, where its description has no masses: the first step of `ladder` is
    /// then that of what stands in for them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub no_gap_as_given: Option<&'static str>,
    /// How far the gap shrinks, step by step, on the held-out recording.
    pub ladder: Vec<Step>,
    /// Where the gap lies.
    #[serde(rename = "where")]
    pub places: Vec<Place>,
    /// Accepted causes, largest share first.
    pub causes: Vec<Cause>,
    /// Narrow peaks of what the parameters leave, said before a cause is.
    pub resonances: Vec<Resonance>,
    /// Friction of every joint over its speed, all that is friction summed.
    pub friction: Vec<Friction>,
    /// Parameters of the given structure that moved, the causes being in place; most deviations first.
    pub moved_parameters: Vec<Moved>,
    /// Parameters that a bound holds, and its cost; null where all are possible by themselves.
    pub bounds: Option<Bounds>,
    /// Everything tried, best first.
    pub candidates: Vec<Tested>,
    /// What the gap means in motion, with the model as given and with the causes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub simulation: Option<Simulation>,
    /// The motion that would tell ambiguous causes apart, where one was designed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub next_experiment: Option<NextExperiment>,
    /// What this recording cannot show.
    pub not_identifiable: Vec<NotIdentifiable>,
    /// Check of the fitted and of the held-out recording, before any physics.
    pub recordings: Vec<CheckReport>,
    /// What is left, and whether it has structure.
    pub unexplained: Vec<Unexplained>,
    /// What was done to the recordings, and what is odd about them.
    pub notes: Vec<String>,
}

/// Verdict.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Nothing but noise and small parameter changes.
    NoGap,
    /// The causes bring the gap to the floor.
    Explained,
    /// More than the floor is left, without clear structure.
    PartlyExplained,
    /// Clear structure is left that no effect of the catalogue explains.
    UnknownEffect,
    /// The recording does not say.
    CannotTell,
}

impl Verdict {
    /// Name in the report.
    pub fn name(self) -> &'static str {
        match self {
            Verdict::NoGap => "no_gap",
            Verdict::Explained => "explained",
            Verdict::PartlyExplained => "partly_explained",
            Verdict::UnknownEffect => "unknown_effect",
            Verdict::CannotTell => "cannot_tell",
        }
    }
}

/// Earlier recordings of the robot.
#[derive(Clone, Debug, Serialize)]
pub struct Compared {
    /// Files.
    pub before: Vec<String>,
    /// Part of the fitted and of the held-out samples whose motion the earlier recordings hold: there torque is compared with
    /// torque, elsewhere with the model identified from them.
    pub repeated: [f64; 2],
    /// Where the motion is another: error with structure, over the joint's torque, that is left on each joint where nothing has changed
    /// (`nrmse` of `unexplained` is to be compared with it).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub usual: Option<Vec<f64>>,
}

/// A step of the ladder.
#[derive(Clone, Debug, Serialize)]
pub struct Step {
    /// `as_given`, `reidentified`, an effect, `learned` or `repeatability`.
    pub step: String,
    /// Held-out samples that are scored; where contact is listed, those outside pushes.
    pub samples: usize,
    /// Over all of them; null where nothing was judged.
    #[serde(flatten)]
    pub all: Scores,
    /// Over those in which each joint moves.
    pub moving: Scores,
}

/// A region where the gap lies.
#[derive(Clone, Debug, Serialize)]
pub struct Place {
    /// Joint.
    pub joint: String,
    /// Coordinate, by its name in docs/formats.md.
    pub coordinate: &'static str,
    /// From, to.
    pub range: [f64; 2],
    /// Unit of the range.
    pub unit: Unit,
    /// Share of the squared held-out error.
    pub share_of_gap: f64,
    /// 90 % interval of the same; none for a band of frequency or an order.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub share_interval: Option<[f64; 2]>,
    /// Share of the samples.
    pub share_of_time: f64,
}

/// A force from outside during part of a recording.
#[derive(Clone, Debug, Serialize)]
pub struct Push {
    /// `data` or `heldout`.
    pub recording: &'static str,
    /// Label of the trajectory.
    pub trajectory: String,
    /// First time stamp, s.
    pub start: f64,
    /// Last time stamp, s.
    pub end: f64,
    /// Link that is pushed: the last one whose joint is loaded.
    pub link: String,
    /// Mean torque of the push by joint, N·m (N).
    pub torque: Vec<f64>,
}

/// What speaks for the name of a cause.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Support {
    /// Gain over the best other name, parameters and the same effect at another place included, nats.
    pub lead: f64,
    /// Logarithm of how many times as likely as its rivals together the cause is, going by simulations of each.
    pub likeness: f64,
    /// Gain over what chance reaches in one recording of a hundred.
    pub over_chance: f64,
    /// Structure left on its joints, relative to their torque.
    pub left: f64,
}

/// An accepted cause.
#[derive(Clone, Debug, Serialize)]
pub struct Cause {
    /// Effect.
    pub effect: Effect,
    /// `parameter` or `structure`.
    pub kind: &'static str,
    /// Joints that it touches.
    pub joints: Vec<String>,
    /// Driving joint of a coupling.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub driver: Option<String>,
    /// Estimated probability that effect and joint are right; null where it was not estimated.
    pub confidence: Option<f64>,
    /// What a confidence is made of; null where it was not estimated.
    pub support: Option<Support>,
    /// Gain over the best other name in its place, nats; null for parameters and for contact, which nothing else was tried
    /// against. No probability.
    pub lead: Option<f64>,
    /// Part of what all causes remove: Shapley's value, or what is lost without the cause if that is more, over the sum of these.
    pub share_of_gap: f64,
    /// Part of the named joints' squared error that it removes.
    pub gap_closed: f64,
    /// 90 % interval of the same; null of contact, which does not repeat.
    pub gap_closed_interval: Option<[f64; 2]>,
    /// Whether the interval excludes zero.
    pub confirmed: bool,
    /// Chance of so large a gain anywhere in the catalogue, or of so clear a trace, from surrogates; null where none were drawn.
    pub p_value: Option<f64>,
    /// Sizes.
    pub parameters: Vec<Parameter>,
    /// Of contact: when, where and how much.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub pushes: Vec<Push>,
    /// What this recording cannot tell from it.
    pub ambiguous_with: Vec<Effect>,
    /// Relative deviation of the description's inertial parameters up to which it is found; null where it is found at any.
    pub right_to: Option<f64>,
    /// What has to be known to trust it: `short recording`, or by what it was seen where not by the error that it removes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub remark: Option<&'static str>,
}

/// Remark on what a few seconds show: nothing says how often chance does.
pub const SHORT: &str = "short recording";

/// Remark on a play that its blows show, whatever error its torque removes.
pub const STRUCK: &str = "seen by the blows that follow changes of the load's sign";

/// A candidate that was tried.
#[derive(Clone, Debug, Serialize)]
pub struct Tested {
    /// Effect.
    pub effect: Effect,
    /// Joints.
    pub joints: Vec<String>,
    /// Part of the joints' squared gap that is closed on trajectories left out with it in the place of an accepted cause, or beside all of them.
    pub gap_closed: f64,
    /// Chance of so large a gain anywhere in the catalogue, or of so clear a trace, from surrogates; null where none were drawn.
    pub p_value: Option<f64>,
}

/// What this recording cannot show.
#[derive(Clone, Debug, Serialize)]
pub struct NotIdentifiable {
    /// Effect; none where nothing at all can be said of the joints.
    pub effect: Option<Effect>,
    /// Joints.
    pub joints: Vec<String>,
    /// Why.
    pub reason: String,
}

/// What is left on a joint out of fold, on the fitted recording; null where it was not judged.
#[derive(Clone, Debug, Serialize)]
pub struct Unexplained {
    /// Joint.
    pub joint: String,
    /// Root mean squared error with structure away from reversals, relative to the joint's torque.
    pub nrmse: Option<f64>,
    /// Part of it that a flexible learner predicts on trajectories left out.
    pub learnable: Option<f64>,
    /// Root mean squared error in motion, N·m (N).
    pub moving: Option<f64>,
    /// The same at rest, beyond what friction holds there.
    pub standing: Option<f64>,
    /// Spread of repeated motions, or noise of the torque, N·m (N).
    pub floor: Option<f64>,
}

/// Simulated motion against the recorded one, with the model as given (before) and with the causes (after).
#[derive(Clone, Debug, Serialize)]
pub struct Simulation {
    /// Motion that was simulated, s.
    pub seconds: f64,
    /// Tracking under feedback.
    pub closed_loop: ClosedLoop,
    /// Motion under the recorded torque alone.
    pub free: Free,
}

/// Tracking of the recorded motion with the model's torque as feed-forward.
#[derive(Clone, Debug, Serialize)]
pub struct ClosedLoop {
    /// Bandwidth of the position feedback, Hz.
    pub bandwidth_hz: f64,
    /// Root mean square tracking error per joint, rad (m).
    pub before: Vec<f64>,
    /// The same with the causes.
    pub after: Vec<f64>,
}

/// Motion under the recorded torque from the recorded state on.
#[derive(Clone, Debug, Serialize)]
pub struct Free {
    /// Distance per joint at which the recorded motion is followed no more, rad (m).
    pub tolerance: Vec<f64>,
    /// Number of runs.
    pub starts: usize,
    /// Longest run, s.
    pub longest_s: f64,
    /// Median time within the tolerance, s.
    pub before_s: f64,
    /// The same with the causes.
    pub after_s: f64,
}

/// A motion that tells two causes apart.
#[derive(Clone, Debug, Serialize)]
pub struct NextExperiment {
    /// The cause named and its rival.
    pub effects: [Effect; 2],
    /// Joints of the cause.
    pub joints: Vec<String>,
    /// Length of the motion, s.
    pub seconds: f64,
    /// Evidence that the recorded data can hold for one against the other, nats.
    pub evidence_recorded: f64,
    /// The same together with the new motion.
    pub evidence_expected: f64,
}

/// A parameter of the given structure that moved.
#[derive(Clone, Debug, Serialize)]
pub struct Moved {
    /// Name: `m`, `mx` … of the joint's link, `viscous`, `coulomb`.
    pub name: String,
    /// Joint.
    pub joint: String,
    /// In the model as given.
    pub given: f64,
    /// As fitted.
    pub value: f64,
    /// Standard deviation of the fitted value.
    pub std: f64,
    /// Unit.
    pub unit: &'static str,
    /// Change over its deviation.
    pub deviations: f64,
}

/// What the bounds changed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Bounds {
    /// Links that would be no possible bodies, and coefficients of friction that would be negative.
    pub held: Vec<String>,
    /// What that costs: rise of the mean NRMSE on the fitted rows.
    pub cost: f64,
}

/// Friction of one joint over its speed.
#[derive(Clone, Debug, Serialize)]
pub struct Friction {
    /// Joint.
    pub joint: String,
    /// Speeds, rad/s (m/s).
    pub speed: Vec<f64>,
    /// Of the model as given at these speeds, N·m (N).
    pub given: Vec<f64>,
    /// As found: the model's, the change of its coefficients and every cause that is friction, mean of both directions
    /// over what was recorded at the speed; null where hardly anything was.
    pub found: Vec<Option<f64>>,
    /// Unit of `given` and `found`.
    pub unit: &'static str,
}

/// A resonance.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Resonance {
    /// Frequency, Hz.
    pub frequency: f64,
    /// Width at half its height, Hz; the window's resolution where that is wider.
    pub width: f64,
    /// Joints that show it, base first.
    pub joints: Vec<String>,
    /// Root mean square of its torque on each of them, N·m (N).
    pub rms: Vec<f64>,
    /// Seen while the arm moves.
    pub in_motion: bool,
    /// Seen while the arm stands.
    pub at_rest: bool,
}
