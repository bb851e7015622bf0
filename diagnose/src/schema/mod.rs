//! The report as the JSON file has it (schema `diagnosis/1`).

pub(crate) mod value;

use crate::catalogue::effect::Effect;
use crate::catalogue::{Parameter, Unit};
use datasets::check::CheckReport;
use datasets::metrics::Scores;
use serde::{Deserialize, Serialize};

/// Report of a diagnosis.
#[derive(Clone, Debug, Serialize)]
pub struct Diagnosis {
    /// Name and version of the report's format: `diagnosis/1`.
    pub schema: &'static str,
    /// Names of the robot's joints, base first.
    pub joints: Vec<String>,
    /// Verdict on the gap as a whole.
    pub verdict: Verdict,
    /// Reason for the verdict `cannot_tell`; none with any other verdict.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// The earlier recordings that the gap is measured from instead of a simulator's model.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub compared: Option<Compared>,
    /// Reason why no gap to the model as given is stated: its description has no masses. The first step of `ladder` is
    /// then that of what replaces the masses.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub no_gap_as_given: Option<&'static str>,
    /// Error on the held-out recording, step by step of the ladder.
    pub ladder: Vec<Step>,
    /// The same way with the causes first: `as_given`, one step per cause in the order of `causes`, then `reidentified`,
    /// the model's other parameters fitted again.
    pub by_cause: Vec<Step>,
    /// Regions of time, position, speed or frequency where the gap lies.
    #[serde(rename = "where")]
    pub places: Vec<Place>,
    /// Accepted causes, largest share first.
    pub causes: Vec<Cause>,
    /// Narrow peaks in the spectrum of the residual beside re-identified parameters, before causes are taken out.
    pub resonances: Vec<Resonance>,
    /// Friction torque of every joint over its speed, all causes that are friction included.
    pub friction: Vec<Friction>,
    /// Parameters of the given structure that moved, the causes being in place; most deviations first.
    pub moved_parameters: Vec<Moved>,
    /// Parameters that a bound holds, and its cost; null where all are possible by themselves.
    pub bounds: Option<Bounds>,
    /// All candidates that were tried, best first.
    pub candidates: Vec<Tested>,
    /// Simulated motion against the recorded one, with the model as given and with the causes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub simulation: Option<Simulation>,
    /// Motion designed to tell ambiguous causes apart, where one was designed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub next_experiment: Option<NextExperiment>,
    /// Effects that this recording cannot show.
    pub not_identifiable: Vec<NotIdentifiable>,
    /// Check of the fitted and of the held-out recording, before any physics.
    pub recordings: Vec<CheckReport>,
    /// Residual of each joint that the causes leave, and its structure.
    pub unexplained: Vec<Unexplained>,
    /// Notes on the preparation of the recordings and on oddities in them.
    pub notes: Vec<String>,
}

/// Verdict of a diagnosis on the gap as a whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The gap is nothing but noise and small parameter changes.
    NoGap,
    /// The causes bring the error down to the noise floor.
    Explained,
    /// An error above the floor is left, without clear structure.
    PartlyExplained,
    /// A residual with clear structure is left that no effect of the catalogue explains.
    UnknownEffect,
    /// The recording does not allow a verdict.
    CannotTell,
}

impl Verdict {
    /// Name of the verdict in the report.
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
    /// Paths of the earlier recordings.
    pub before: Vec<String>,
    /// Part of the fitted and of the held-out samples whose motion the earlier recordings hold. There torque is
    /// compared with torque, elsewhere with the model identified from them.
    pub repeated: [f64; 2],
    /// Structured error of each joint over its torque where nothing has changed, for motions that are not
    /// repeated. Compare `nrmse` of `unexplained` with it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub usual: Option<Vec<f64>>,
}

/// Step of the ladder: errors with a set of parameters and causes.
#[derive(Clone, Debug, Serialize)]
pub struct Step {
    /// Name of the step: `as_given`, `reidentified`, an effect, `learned` or `repeatability`.
    pub step: String,
    /// Number of held-out samples that are scored; where contact is listed, those outside pushes.
    pub samples: usize,
    /// Scores over all of these held-out samples; null where nothing was judged.
    #[serde(flatten)]
    pub all: Scores,
    /// Scores over the held-out samples in which each joint moves.
    pub moving: Scores,
}

/// A region where the gap lies.
#[derive(Clone, Debug, Serialize)]
pub struct Place {
    /// Name of the joint whose gap lies in the region.
    pub joint: String,
    /// Name of the coordinate, as in docs/formats.md.
    pub coordinate: &'static str,
    /// Lower and upper end of the region, in `unit`.
    pub range: [f64; 2],
    /// Unit of the range's ends.
    pub unit: Unit,
    /// Share of the squared error on the held-out recording.
    pub share_of_gap: f64,
    /// 90 % interval of `share_of_gap`; none for a band of frequency or an order.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub share_interval: Option<[f64; 2]>,
    /// Share of the samples that lie in the region.
    pub share_of_time: f64,
}

/// A force from outside during part of a recording.
#[derive(Clone, Debug, Serialize)]
pub struct Push {
    /// Recording that holds the push: `data` or `heldout`.
    pub recording: &'static str,
    /// Label of the trajectory during which the robot is pushed.
    pub trajectory: String,
    /// First time stamp of the push, s.
    pub start: f64,
    /// Last time stamp of the push, s.
    pub end: f64,
    /// Link that is pushed: the last one whose joint is loaded.
    pub link: String,
    /// Mean torque of the push by joint, N·m (N).
    pub torque: Vec<f64>,
}

/// Evidence for the name of a cause.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Support {
    /// Gain over the best other name, parameters and the same effect at another place included, nats.
    pub lead: f64,
    /// Structure in the residual of its joints, relative to their torque.
    pub left: f64,
}

/// Accepted cause, as in the report.
#[derive(Clone, Debug, Serialize)]
pub struct Cause {
    /// Effect of the catalogue that the cause is.
    pub effect: Effect,
    /// Kind of the cause: `parameter` or `structure`.
    pub kind: &'static str,
    /// Names of the joints that the cause touches.
    pub joints: Vec<String>,
    /// Name of the driving joint; null but for a coupling.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub driver: Option<String>,
    /// Estimated probability that effect and joint are right; null where it was not estimated.
    pub confidence: Option<f64>,
    /// Evidence from which the confidence is computed; null where it was not estimated.
    pub support: Option<Support>,
    /// Gain over the best other name in its place, nats; not a probability. Null for parameters and for
    /// contact, for which no other name was tried.
    pub lead: Option<f64>,
    /// Share of the error that all causes remove: Shapley value, or the loss without the cause if that is more,
    /// over the sum of these.
    pub share_of_gap: f64,
    /// Part of the named joints' squared error that the cause removes.
    pub gap_closed: f64,
    /// 90 % interval of `gap_closed`; null for contact, which does not repeat.
    pub gap_closed_interval: Option<[f64; 2]>,
    /// Whether the interval excludes zero.
    pub confirmed: bool,
    /// Chance of so large a gain anywhere in the catalogue, or of so clear a trace, from surrogates; null where none were drawn.
    pub p_value: Option<f64>,
    /// Sizes of the effect with unit and standard deviation.
    pub parameters: Vec<Parameter>,
    /// Pushes, for contact: time, link and torque of each.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub pushes: Vec<Push>,
    /// Effects that this recording cannot tell from the cause.
    pub ambiguous_with: Vec<Effect>,
    /// Relative deviation of the description's inertial parameters up to which it is found; null where it is found at any.
    pub right_to: Option<f64>,
    /// Caveat: `short recording`, or the trace by which the cause was seen where not by the error that it removes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub remark: Option<&'static str>,
}

/// Remark on a cause from a few seconds of motion, for which no chance level is known.
pub const SHORT: &str = "short recording";

/// Remark on a play that is seen by its blows, whatever error its torque removes.
pub const STRUCK: &str = "seen by the blows that follow changes of the load's sign";

/// A candidate that was tried.
#[derive(Clone, Debug, Serialize)]
pub struct Tested {
    /// Effect of the catalogue that the candidate is of.
    pub effect: Effect,
    /// Names of the joints that the candidate names.
    pub joints: Vec<String>,
    /// Part of the joints' squared gap that the candidate closes on trajectories left out, in the place of an accepted
    /// cause or beside all of them.
    pub gap_closed: f64,
    /// Chance of so large a gain anywhere in the catalogue, or of so clear a trace, from surrogates; null where none were drawn.
    pub p_value: Option<f64>,
}

/// An effect that this recording cannot show.
#[derive(Clone, Debug, Serialize)]
pub struct NotIdentifiable {
    /// Effect that cannot be shown; none where nothing can be said of these joints.
    pub effect: Option<Effect>,
    /// Names of the joints on which the effect cannot be shown.
    pub joints: Vec<String>,
    /// Reason why the recording cannot show the effect.
    pub reason: String,
}

/// Residual of a joint out of fold, on the fitted recording; null where it was not judged.
#[derive(Clone, Debug, Serialize)]
pub struct Unexplained {
    /// Name of the joint whose residual it is.
    pub joint: String,
    /// Root mean squared error with structure away from reversals, relative to the joint's torque.
    pub nrmse: Option<f64>,
    /// Part of the structured error that a flexible learner predicts on trajectories left out.
    pub learnable: Option<f64>,
    /// Root mean squared error in motion, N·m (N).
    pub moving: Option<f64>,
    /// Root mean squared error at rest beyond the torque that friction holds there, N·m (N).
    pub standing: Option<f64>,
    /// Noise floor: spread of repeated motions, or noise of the torque, N·m (N).
    pub floor: Option<f64>,
}

/// Simulated motion against the recorded one, with the model as given (before) and with the causes (after).
#[derive(Clone, Debug, Serialize)]
pub struct Simulation {
    /// Duration of the motion that was simulated, s.
    pub seconds: f64,
    /// Tracking of the simulated robot under feedback.
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
    /// Root mean square tracking error per joint with the causes, rad (m).
    pub after: Vec<f64>,
}

/// Motion under the recorded torque from the recorded state on.
#[derive(Clone, Debug, Serialize)]
pub struct Free {
    /// Distance of each joint from the recorded motion at which a run ends, rad (m).
    pub tolerance: Vec<f64>,
    /// Number of simulated runs, each from another recorded state.
    pub starts: usize,
    /// Duration of the longest run, s.
    pub longest_s: f64,
    /// Median time of the runs within the tolerance with the model as given, s.
    pub before_s: f64,
    /// Median time of the runs within the tolerance with the causes, s.
    pub after_s: f64,
}

/// A motion that tells two causes apart.
#[derive(Clone, Debug, Serialize)]
pub struct NextExperiment {
    /// Effect of the cause that is named, and of its rival.
    pub effects: [Effect; 2],
    /// Names of the joints of the cause.
    pub joints: Vec<String>,
    /// Duration of the motion, s.
    pub seconds: f64,
    /// Evidence that the recorded data can hold for one against the other, nats.
    pub evidence_recorded: f64,
    /// Evidence expected of the recorded data and the new motion together, nats.
    pub evidence_expected: f64,
}

/// A parameter of the given structure that moved.
#[derive(Clone, Debug, Serialize)]
pub struct Moved {
    /// Name of the parameter: `m`, `mx` … of the joint's link, `viscous`, `coulomb`.
    pub name: String,
    /// Name of the joint whose link or friction it is.
    pub joint: String,
    /// Value of the parameter in the model as given, in `unit`.
    pub given: f64,
    /// Fitted value of the parameter, in `unit`.
    pub value: f64,
    /// Standard deviation of the fitted value, in `unit`.
    pub std: f64,
    /// Unit of `given`, `value` and `std`.
    pub unit: &'static str,
    /// Change of the parameter over its standard deviation.
    pub deviations: f64,
}

/// Effect of the bounds on the fit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Bounds {
    /// Names of the links that would not be possible bodies, and of the coefficients of friction that would be
    /// negative.
    pub held: Vec<String>,
    /// Rise of the mean NRMSE on the fitted rows by the bounds.
    pub cost: f64,
}

/// Friction of one joint over its speed.
#[derive(Clone, Debug, Serialize)]
pub struct Friction {
    /// Name of the joint whose friction is given.
    pub joint: String,
    /// Speeds at which friction is given, rad/s (m/s).
    pub speed: Vec<f64>,
    /// Friction torque of the model as given at these speeds, N·m (N).
    pub given: Vec<f64>,
    /// Friction found: the model's, the change of its coefficients and every cause that is friction. Mean of
    /// both directions over what was recorded at the speed; null where there was hardly any motion.
    pub found: Vec<Option<f64>>,
    /// Unit of `given` and `found`.
    pub unit: &'static str,
}

/// Resonance of a joint: a narrow peak in the residual's spectrum.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Resonance {
    /// Frequency of the peak, Hz.
    pub frequency: f64,
    /// Width of the peak at half its height, Hz; the window's resolution where that is wider.
    pub width: f64,
    /// Names of the joints that show the resonance, base first.
    pub joints: Vec<String>,
    /// Root mean square torque of the resonance on each joint of `joints`, N·m (N).
    pub rms: Vec<f64>,
    /// Whether the resonance is seen while the arm moves.
    pub in_motion: bool,
    /// Whether the resonance is seen while the arm stands.
    pub at_rest: bool,
}
