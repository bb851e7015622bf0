//! Identification as a sum over recordings: triangular factors that workers fill apart and that add up exactly.
//!
//! The parameters are those of `train --basic`: base parameters, offset, viscous and Coulomb friction and rotor
//! inertia. A recording becomes, for every joint, the triangular factors of a few stretches of its rows. The
//! factors of two sets of recordings stack into those of both, in whatever order. Weights of joints, parameters
//! and deviations come from the sums alone ([`Sums::finish`]), so that recordings need never be in one place.
//!
//! All workers have to prepare alike: the cut-off of the motion is given, or chosen from the first recording and then
//! kept ([`Preparation`]). Sums of other preparations or robots are refused.

mod bytes;
mod columns;
mod error;
mod finish;
mod preparation;
mod rows;

pub use error::SumsError;
pub use finish::Summed;
pub use preparation::Preparation;

use ::identify::least_squares::Triangle;
use columns::Columns;
use datasets::Recording;
use physics::effects::Term;
use physics::robot::Robot;
use physics::torque_model::{TorqueModelRecord, WeightedTerm};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;

/// Sums of the recordings of one robot. Their size does not depend on the number of recordings.
#[derive(Clone, Debug)]
pub struct Sums {
    columns: Columns,
    /// Hex digest of all from which the robot's torque is computed.
    which: String,
    preparation: Option<Preparation>,
    /// Factors of each joint, by the place of their stretch of rows: see [`rows`].
    places: BTreeMap<usize, Vec<Triangle>>,
    recordings: usize,
    /// Lowest and highest position of each joint, rad or m.
    span: Vec<[f64; 2]>,
}

impl Sums {
    /// Empty sums of `robot`; without a cut-off (Hz) the first recording determines it.
    pub fn new(robot: Robot, cutoff_hz: Option<f64>) -> Self {
        Self {
            which: which(&robot),
            preparation: cutoff_hz.map(Preparation::given),
            places: BTreeMap::new(),
            recordings: 0,
            span: vec![[f64::INFINITY, f64::NEG_INFINITY]; robot.dof()],
            columns: Columns::of(robot),
        }
    }

    /// Empty sums with the robot and the preparation, as the start of a worker.
    pub fn emptied(&self) -> Self {
        let mut empty = Self::new(self.columns.robot.clone(), None);
        empty.preparation = self.preparation;
        empty
    }

    /// Preparation of the recordings; none before the first one where it was not given.
    pub fn preparation(&self) -> Option<Preparation> {
        self.preparation
    }

    /// Number of recordings in the sums.
    pub fn recordings(&self) -> usize {
        self.recordings
    }

    /// Number of samples in the sums.
    pub fn samples(&self) -> usize {
        self.places.values().map(|joints| joints[0].rows()).sum()
    }

    /// Adds a recording. Where it cannot be used the sums stay unchanged.
    ///
    /// # Errors
    /// See [`SumsError`].
    pub fn add(&mut self, recording: &Recording) -> Result<(), SumsError> {
        let preparation = match self.preparation {
            Some(preparation) => preparation,
            None => Preparation::chosen(&self.columns.robot, recording)?,
        };
        let places = rows::factors(&self.columns, recording, preparation)?;
        self.preparation = Some(preparation);
        self.recordings += 1;
        for (span, q) in self.span.iter_mut().zip(recording.q.columns()) {
            for &q in q {
                *span = [span[0].min(q), span[1].max(q)];
            }
        }
        self.stack(places)
    }

    /// Adds the recordings of `other`.
    ///
    /// # Errors
    /// Another robot or another preparation.
    pub fn merge(&mut self, other: &Self) -> Result<(), SumsError> {
        if self.which != other.which {
            return Err(SumsError::OtherRobot);
        }
        match (self.preparation, other.preparation) {
            (Some(own), Some(others)) if own != others => {
                return Err(SumsError::OtherPreparation { own, others });
            }
            (own, others) => self.preparation = own.or(others),
        }
        self.recordings += other.recordings;
        for (span, [low, high]) in self.span.iter_mut().zip(&other.span) {
            *span = [span[0].min(*low), span[1].max(*high)];
        }
        self.stack(other.places.clone())
    }

    /// Adds factors to those in the same places.
    fn stack(&mut self, places: BTreeMap<usize, Vec<Triangle>>) -> Result<(), SumsError> {
        for (place, joints) in places {
            match self.places.get_mut(&place) {
                None => {
                    self.places.insert(place, joints);
                }
                Some(own) => {
                    for (own, new) in own.iter_mut().zip(&joints) {
                        own.merge(new)?;
                    }
                }
            }
        }
        Ok(())
    }
}

/// Hex digest of a robot: joints, frames, inertials, gravity, springs.
fn which(robot: &Robot) -> String {
    let mut terms: Vec<Vec<WeightedTerm>> = vec![Vec::new(); robot.dof()];
    for p in robot.passive() {
        terms[p.joint()].push(WeightedTerm {
            term: Term::from(*p),
            value: 1.0,
            std: 0.0,
        });
    }
    let record = TorqueModelRecord::new(robot, robot.parameters(), Vec::new(), terms);
    hex(&Sha256::digest(crate::directory::json(&record)))
}

/// Bytes as hexadecimal text.
fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|b| format!("{b:02x}")).collect()
}
