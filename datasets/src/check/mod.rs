//! The check of a recording: what is wrong with it before anything is fitted.
//!
//! What needs a regressor (conditioning, the parameters that suffer) is added by the identification.

mod channels;
mod clock;
pub mod command;
mod complaint;
mod finding;
mod torque;
mod velocity;

pub use channels::{STILL, moves, plateau};
pub use complaint::{Ailment, Complaint};
pub use finding::{CheckOptions, Finding, JointFigures, Kind, Severity};

use crate::channel::ChannelEstimate;
use crate::prepare::Prepared;
use crate::repeats::{self, Repeatability};
use crate::{Problem, Recording};
use serde::Serialize;

/// The check of a recording.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CheckReport {
    /// Name of the recording that was checked.
    pub source: String,
    /// Number of samples of the recording.
    pub samples: usize,
    /// Number of trajectories of the recording.
    pub trajectories: usize,
    /// Time in motion and rest, without the pauses between trajectories, in s.
    pub duration_s: f64,
    /// Median sampling rate, Hz.
    pub rate_hz: f64,
    /// Figures of each joint, base first.
    pub joints: Vec<JointFigures>,
    /// Delay, scale and offset of the torque, where a model was at hand to compare it with.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub channel: Option<ChannelEstimate>,
    /// Complaints about the torque channel, where a model was at hand: worst first.
    pub doctor: Vec<Complaint>,
    /// Repeated motions, and the torque's noise floor from them.
    pub repeatability: Option<Repeatability>,
    /// Findings of the check, worst first.
    pub findings: Vec<Finding>,
}

impl CheckReport {
    /// Adds findings, worst first again.
    pub fn add(&mut self, findings: impl IntoIterator<Item = Finding>) {
        self.findings.extend(findings);
        self.findings.sort_by_key(|f| std::cmp::Reverse(f.severity));
    }

    /// Whether the doctor tells of a finding's torque already, and more.
    pub fn is_told(&self, finding: &Finding) -> bool {
        use Ailment::{
            Columns, Current, Dead, Description, Motor, PerMille, Percent, Saturated, Scale, Sign,
            Turned,
        };
        let told: &[Ailment] = match finding.kind {
            Kind::TorqueScale => &[
                Current,
                Motor,
                PerMille,
                Percent,
                Scale,
                Sign,
                Description,
                Columns,
                Turned,
            ],
            Kind::DeadChannel => &[Dead],
            Kind::TorquePlateau => &[Saturated],
            _ => return false,
        };
        let mut own = self.doctor.iter().filter(|c| told.contains(&c.ailment));
        own.any(|c| finding.joint.is_none_or(|j| c.joints.contains(&j)))
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
    let mut names = Vec::with_capacity(recording.dof());
    for joint in 0..recording.dof() {
        let name = options.joints.get(joint).cloned();
        let view = channels::Channel {
            recording,
            motion: &prepared.at_samples,
            velocity: velocity::compare(recording, prepared, joint),
            joint,
            name: name.unwrap_or_else(|| format!("joint {}", joint + 1)),
            slides: options.slides.get(joint).copied().unwrap_or(false),
        };
        let figures = view.figures();
        findings.extend(view.findings(&figures, options));
        joints.push(figures);
        names.push(view.name);
    }
    findings.extend(command::findings(recording, &names));
    findings.extend(recording.notes.iter().map(|note| Finding::reading(note)));
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
        doctor: Vec::new(),
        repeatability: repeats::repeatability(recording, &prepared.at_samples.qd, &pairs),
        findings,
    })
}
