//! Outcome of the doctor on one simulated recording, and on all of a kind.

use datasets::check::{Ailment, Complaint, Severity};
use datasets::prepare::{PrepareOptions, prepare};
use datasets::{Recording, TorqueFilter};
use model::failure::Failure;
use model::preparation::{channel, doctor};
use nalgebra::Vector3;
use physics::robot::Robot;
use physics::robot::drive::Drive;
use serde::Serialize;
use trials::channels::{ChannelCase, Fault, Wrong, against, generate};

/// Contents of `train doctor --json`.
#[derive(Serialize)]
pub struct Figures {
    /// Schema of the file: `doctor/1`.
    pub schema: &'static str,
    /// Seed of the simulated recordings.
    pub seed: u64,
    /// Outcomes of the recordings of each kind of fault.
    pub kinds: Vec<Counted>,
}

/// True fault of a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Fault of the torque channel.
    Channel(Fault),
    /// Wrong description or columns, while the channel is healthy.
    Description(Wrong),
}

impl Kind {
    /// All kinds: faults of channels, then wrong descriptions.
    pub fn all() -> impl Iterator<Item = Self> {
        let channels = Fault::ALL.into_iter().map(Self::Channel);
        channels.chain(Wrong::ALL.into_iter().map(Self::Description))
    }

    /// Name of the kind, as in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Self::Channel(fault) => fault.name(),
            Self::Description(wrong) => wrong.name(),
        }
    }
}

/// Recordings of one kind with their outcomes.
#[derive(Serialize)]
pub struct Counted {
    /// Kind of the recordings: their true fault.
    #[serde(rename = "fault", serialize_with = "name")]
    pub kind: Kind,
    /// Number of recordings that were recognised; of healthy ones, those without a complaint; of wrong
    /// descriptions, those without a complaint of a fault of the channel alone.
    pub right: usize,
    /// Exact 95 % interval of the share of recognised recordings.
    pub interval: [f64; 2],
    /// Number of recordings with a further complaint.
    pub more: usize,
    /// Recordings whose remedy was tried, and those that are healthy behind it.
    pub mended: [usize; 2],
    /// Outcome of each recording.
    pub outcomes: Vec<Outcome>,
}

/// Outcome of one recording.
#[derive(Serialize)]
pub struct Outcome {
    /// Index of the recording in the run.
    pub index: u64,
    /// Indices of the joints with the fault, from 0.
    pub joints: Vec<usize>,
    /// Whether the fault was recognised, on one of its joints at least and on no other; of a healthy recording,
    /// whether there was no complaint.
    pub right: bool,
    /// Whether the recording is healthy after the remedy; null where no line can mend it.
    pub mended: Option<bool>,
    /// Complaints of the doctor.
    pub complaints: Vec<Complaint>,
    /// Complaints after the remedy is applied, without notes.
    pub left: Vec<Complaint>,
}

fn name<S: serde::Serializer>(kind: &Kind, to: S) -> Result<S::Ok, S::Error> {
    to.serialize_str(kind.name())
}

impl Counted {
    /// Figures of a kind from the outcomes of its recordings.
    pub fn new(kind: Kind, outcomes: Vec<Outcome>) -> Self {
        let count = |f: &dyn Fn(&Outcome) -> bool| outcomes.iter().filter(|o| f(o)).count();
        let right = count(&|o| o.right);
        let expected = usize::from(kind != Kind::Channel(Fault::None));
        Self {
            kind,
            right,
            interval: signal::proportion::interval(right, outcomes.len(), 0.05),
            more: count(&|o| o.complaints.len() > if o.right { expected } else { 0 }),
            mended: [
                count(&|o| o.mended.is_some()),
                count(&|o| o.mended == Some(true)),
            ],
            outcomes,
        }
    }
}

impl Outcome {
    /// Simulates a recording, examines it, and tries the remedy.
    pub fn of(kind: Kind, seed: u64, index: u64) -> Result<Self, Failure> {
        let fault = match kind {
            Kind::Channel(fault) => fault,
            Kind::Description(wrong) => return Self::of_description(wrong, seed, index),
        };
        let case = generate(fault, seed, index).map_err(|e| Failure::other(e.to_string()))?;
        let complaints = examined(&case.robot, &case.recording)?;
        let own = complaints.iter().find(|c| names(c.ailment, fault));
        let right = match own {
            None => fault == Fault::None && complaints.is_empty(),
            Some(found) => found.joints.iter().all(|j| case.joints.contains(j)),
        };
        let left = match own.filter(|_| right) {
            Some(complaint) => left(&case, complaint)?,
            None => None,
        };
        Ok(Self {
            index,
            right,
            mended: left.as_ref().map(Vec::is_empty),
            joints: case.joints,
            complaints,
            left: left.unwrap_or_default(),
        })
    }
}

impl Outcome {
    /// Outcome of a healthy recording against a wrong description. It is wrong where a fault of the channel alone is reported.
    fn of_description(wrong: Wrong, seed: u64, index: u64) -> Result<Self, Failure> {
        let case = against(wrong, seed, index).map_err(|e| Failure::other(e.to_string()))?;
        let complaints = examined(&case.robot, &case.recording)?;
        let other = |c: &Complaint| {
            matches!(
                c.ailment,
                Ailment::Description | Ailment::Columns | Ailment::Turned
            )
        };
        let blamed = |c: &Complaint| !other(c) && c.severity != Severity::Note;
        Ok(Self {
            index,
            joints: case.joints,
            right: complaints.iter().any(other) || !complaints.iter().any(blamed),
            mended: None,
            complaints,
            left: Vec::new(),
        })
    }
}

/// Whether an ailment is the name of a fault.
fn names(ailment: Ailment, fault: Fault) -> bool {
    ailment.name() == fault.name()
}

fn examined(robot: &Robot, recording: &Recording) -> Result<Vec<Complaint>, Failure> {
    let options = PrepareOptions::default();
    let prepared = prepare(recording, &options).map_err(|e| Failure::other(e.to_string()))?;
    let channel = channel::estimate(robot, recording, &prepared);
    Ok(doctor::examine(robot, recording, &prepared, &channel))
}

/// Complaints on the recording after the complaint's remedy is applied: the lines of the drive file, or gravity as on
/// the command line. None where the complaint has no remedy. Notes do not count: a sensor behind the gear is not a
/// fault.
fn left(case: &ChannelCase, complaint: &Complaint) -> Result<Option<Vec<Complaint>>, Failure> {
    let mut robot = case.robot.clone();
    let mut recording = case.recording.clone();
    match (&complaint.drive, complaint.ailment) {
        (_, Ailment::GravityRemoved) => robot = robot.with_gravity(Vector3::zeros()),
        (Some(lines), _) => {
            let failed = |e: &dyn std::fmt::Display| {
                Failure::other(format!("the remedy {lines:?} is no drive file: {e}"))
            };
            let drive = Drive::from_toml(lines, &robot).map_err(|e| failed(&e))?;
            let conversion = drive.torque_conversion(&robot).map_err(|e| failed(&e))?;
            recording.torque_filter = drive.torque_filter.map(|f| TorqueFilter {
                order: f.order,
                cutoff_hz: f.cutoff_hz,
                ripple_db: f.ripple_db,
                recognised: false,
            });
            if let Some(tau) = &mut recording.tau {
                for (mut column, c) in tau.columns_mut().into_iter().zip(conversion) {
                    column.mapv_inplace(|t| c.scale * t + c.offset);
                }
            }
        }
        (None, _) => return Ok(None),
    }
    let mut left = examined(&robot, &recording)?;
    left.retain(|c| c.severity != Severity::Note);
    Ok(Some(left))
}
