//! The check of a recording: what is wrong with it before anything is fitted.
//!
//! What needs a regressor (conditioning, the parameters that suffer) is added by the identification.

mod channels;
mod clock;
mod torque;
mod velocity;

pub use channels::{STILL, moves, plateau};

use crate::channel::{Estimate95, TorqueChannel};
use crate::prepare::Prepared;
use crate::repeats::{self, Repeatability};
use crate::{Problem, Recording};
use serde::Serialize;

/// What is known about the robot, to judge a recording by. Everything is optional.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CheckOptions {
    /// Names of the joints, base first; `joint 1` … where there are none.
    pub joints: Vec<String>,
    /// Lower and upper joint limits in rad (m), base first; infinite where there are none.
    pub position_limits: Vec<[f64; 2]>,
}

/// How bad a finding is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Severity {
    /// Worth knowing.
    Note,
    /// Some results will be poor.
    Warning,
    /// Results for this joint, or all, cannot be trusted.
    Severe,
}

/// What was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// The joint never moves.
    NeverMoves,
    /// The joint moves too slowly to tell viscous from Coulomb friction.
    TooSlow,
    /// The torque is cut at a plateau: the motion asks for more than the drive gives.
    TorquePlateau,
    /// Fewer than three cycles.
    TooShort,
    /// The joint covers too little of its range.
    RegionTooSmall,
    /// The torque is not of the size that the robot's model expects.
    TorqueScale,
    /// A channel is constant, or stands still while the joint moves.
    DeadChannel,
    /// Positions leave the joint limits as if their unit or zero were wrong.
    PositionScale,
    /// The recorded velocity is not the derivative of the position.
    VelocityMismatch,
    /// A value jumps away and back within one sample.
    CorruptRow,
    /// Time jumps inside a trajectory.
    ClockJump,
    /// The stamps jitter.
    Jitter,
    /// Torque and motion are shifted in time.
    TorqueShift,
    /// The motion does not tell some parameters from others.
    PoorConditioning,
}

/// One finding.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// What.
    pub kind: Kind,
    /// How bad.
    pub severity: Severity,
    /// Joint, by index; `None` for the whole recording.
    pub joint: Option<usize>,
    /// Data row from 1, where there is one.
    pub row: Option<usize>,
    /// The number behind it, in the unit that `message` names.
    pub value: f64,
    /// Names of the parameters that suffer, where it is about parameters.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub parameters: Vec<String>,
    /// What is wrong and what to do, as a sentence.
    pub message: String,
}

/// Figures of one joint.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct JointFigures {
    /// Name.
    pub name: String,
    /// Smallest and largest position in rad (m).
    pub range: [f64; 2],
    /// Largest speed in rad/s (m/s).
    pub top_speed: f64,
    /// Cycles: half the number of reversals.
    pub cycles: f64,
    /// Part of the samples with |q̇| > 0.01.
    pub share_moving: f64,
    /// RMS torque in N·m (N).
    pub torque_rms: Option<f64>,
    /// Largest torque in N·m (N).
    pub torque_max: Option<f64>,
    /// Recorded velocity behind the derivative of the position, s, where velocity was recorded.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub velocity_delay: Option<Estimate95>,
}

/// The check of a recording.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CheckReport {
    /// The recording.
    pub source: String,
    /// Samples.
    pub samples: usize,
    /// Trajectories.
    pub trajectories: usize,
    /// Time in motion and rest, without the pauses between trajectories, in s.
    pub duration_s: f64,
    /// Median rate in Hz.
    pub rate_hz: f64,
    /// Figures per joint.
    pub joints: Vec<JointFigures>,
    /// Delay, scale and offset of the torque, where a model was at hand to compare it with.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub channel: Option<TorqueChannel>,
    /// Repeated motions and the floor that follows.
    pub repeatability: Option<Repeatability>,
    /// Findings, worst first.
    pub findings: Vec<Finding>,
}

impl CheckReport {
    /// Adds findings, worst first again.
    pub fn add(&mut self, findings: impl IntoIterator<Item = Finding>) {
        self.findings.extend(findings);
        self.findings.sort_by_key(|f| std::cmp::Reverse(f.severity));
    }

    /// The worst severity; `None` when nothing was found.
    pub fn worst(&self) -> Option<Severity> {
        self.findings.iter().map(|f| f.severity).max()
    }
}

/// Checks a recording. `prepared` must come from the same recording.
///
/// # Errors
/// [`Problem::Empty`] for a recording without samples.
pub fn check(
    recording: &Recording,
    prepared: &Prepared,
    options: &CheckOptions,
) -> Result<CheckReport, Problem> {
    if recording.is_empty() {
        return Err(Problem::Empty);
    }
    let mut findings = clock::findings(recording, prepared.report.jitter);
    let mut joints = Vec::with_capacity(recording.dof());
    for joint in 0..recording.dof() {
        let name = options.joints.get(joint).cloned();
        let view = channels::Channel {
            recording,
            motion: &prepared.at_samples,
            velocity: velocity::compare(recording, prepared, joint),
            joint,
            name: name.unwrap_or_else(|| format!("joint {}", joint + 1)),
        };
        let figures = view.figures();
        findings.extend(view.findings(&figures, options));
        joints.push(figures);
    }
    findings.sort_by_key(|f| std::cmp::Reverse(f.severity));
    let pairs = repeats::find(recording);
    let time = &recording.time;
    Ok(CheckReport {
        source: recording.source.clone(),
        samples: recording.len(),
        trajectories: recording.trajectories.len(),
        duration_s: recording
            .trajectories
            .iter()
            .map(|t| time[t.range.end - 1] - time[t.range.start])
            .sum(),
        rate_hz: prepared.report.rate_hz,
        joints,
        channel: None,
        repeatability: repeats::repeatability(recording, &prepared.at_samples.qd, &pairs),
        findings,
    })
}
