//! Accepted causes that belong to the recording (torque channel, delay), to the base (tilt), or to no torque model.

use crate::algebra::fit::Fit;
use crate::catalogue::Candidate;
use crate::catalogue::base_tilt::DIRECTION;
use crate::catalogue::info::Carried;
use crate::catalogue::saturation::LIMIT;
use crate::outcome::Outcome;
use crate::simulator::NominalModel;
use datasets::channel::Estimate95;
use model::torque_channel::TorqueChannel;
use nalgebra::{Rotation3, Vector3};
use physics::robot::Robot;

/// Two-sided 95 % quantile of a normal distribution, in standard deviations.
const TWO_SIDED: f64 = 1.96;

/// Torque channel, delay, tilt, and causes that are left out.
pub(super) struct Recorded {
    pub(super) channel: TorqueChannel,
    pub(super) delay: Option<Estimate95>,
    tilt: Vector3<f64>,
    /// Causes that a torque model cannot hold, as text.
    pub(super) left_out: Vec<String>,
    /// Columns of the fit that are held here.
    columns: Vec<usize>,
}

impl Recorded {
    /// Causes among the outcome's that belong to the recording or the base. `fit` is that of the last structural step.
    pub(super) fn new(given: &NominalModel, outcome: &Outcome, fit: &Fit) -> Self {
        let found = &outcome.findings;
        let file = given.file();
        let mut own = Self {
            channel: file
                .and_then(|f| f.channel.clone())
                .unwrap_or_else(|| TorqueChannel::faithful(given.robot.dof())),
            delay: file.and_then(|f| f.torque_delay),
            tilt: Vector3::zeros(),
            left_out: Vec::new(),
            columns: Vec::new(),
        };
        let (beta, std) = (fit.beta(), fit.std());
        for cause in found.structure() {
            let candidate = found.candidate(cause);
            let members = &found.dictionary.members[found.accepted[cause].candidate];
            // Value of the candidate's quantity k, and its deviation.
            let value = |k: usize| {
                let quantity = &candidate.quantities[k];
                let own = fit.variables.iter().position(|v| v.column == members[k]);
                own.map_or((quantity.offset, 0.0), |i| {
                    let moved = quantity.factor * beta[i];
                    (quantity.offset + moved, quantity.factor.abs() * std[i])
                })
            };
            if own.takes(candidate, &value) {
                own.columns.extend(members);
            }
        }
        let causes = &outcome.diagnosis.causes;
        let pushes = causes.iter().filter(|c| c.effect.info().outside);
        own.left_out
            .extend(pushes.map(|c| c.effect.name().to_owned()));
        own
    }

    /// Whether the candidate is held here and not among the model's terms.
    fn takes(&mut self, candidate: &Candidate, value: &dyn Fn(usize) -> (f64, f64)) -> bool {
        let joint = candidate.joints[0];
        let info = candidate.effect.info();
        match (info.carried)(candidate) {
            Carried::Terms => return false,
            Carried::Gain => self.channel.gain[joint] += value(0).0 - 1.0,
            Carried::Offset => self.channel.offset[joint] += value(0).0,
            Carried::Limit => self.channel.limit[joint] = candidate.shape(LIMIT),
            Carried::Zero => {
                let of = candidate.quantities[0].joint.unwrap_or(joint);
                self.channel.zero[of] += value(0).0;
            }
            Carried::Delay if candidate.joints.len() == self.channel.gain.len() => {
                let (seconds, std) = value(0);
                let before = self.delay.and_then(|d| d.value).unwrap_or(0.0);
                let sum = before + seconds;
                self.delay = Some(Estimate95 {
                    value: Some(sum),
                    interval: Some([sum - TWO_SIDED * std, sum + TWO_SIDED * std]),
                });
            }
            Carried::Gravity => {
                self.tilt += match candidate.shape(DIRECTION) {
                    Some(angle) => Vector3::new(angle.cos(), angle.sin(), 0.0) * value(0).0,
                    None => Vector3::new(value(0).0, value(1).0, 0.0),
                };
            }
            // The directory has one delay for all joints.
            Carried::Delay | Carried::Not => self.left_out.push(info.name.to_owned()),
        }
        true
    }

    /// Whether a column of the fit is held here.
    pub(super) fn holds(&self, column: usize) -> bool {
        self.columns.contains(&column)
    }

    /// Gravity in the frame of the tilted base, m/s².
    pub(super) fn gravity(&self, robot: &Robot) -> Vector3<f64> {
        Rotation3::new(-self.tilt) * robot.gravity()
    }

    /// The torque channel, where it changes the torque.
    pub(super) fn named(&self) -> Option<TorqueChannel> {
        let faithful = TorqueChannel::faithful(self.channel.gain.len());
        Some(self.channel.clone()).filter(|c| *c != faithful)
    }
}
