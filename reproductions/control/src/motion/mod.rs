//! Commanded motions with exact derivatives.

pub mod arm;
mod line;
mod profile;
mod sine;

pub use line::Line;
pub use profile::Profile;
pub use sine::Sine;

use identify::excitation::{Bounds, MotionLimits, Room, Series, State, model_free};
use plant::reference::Command;

use crate::ControlError;

/// A motion from rest at time 0 to rest at its end.
pub trait Motion: Sync {
    /// Its length, s.
    fn duration(&self) -> f64;

    /// The command at time `t`, 0 to the duration, s.
    fn at(&self, t: f64, command: &mut Command);
}

/// A Fourier series that fills its limits, random, at rest at both ends.
pub struct Fourier {
    series: Series,
}

/// Multiples of the base frequency.
const HARMONICS: [usize; 5] = [1, 2, 3, 4, 5];

impl Fourier {
    /// One period of `period` seconds within the limits.
    ///
    /// # Errors
    /// Limits that leave no motion.
    pub fn draw(limits: Vec<MotionLimits>, period: f64, seed: u64) -> Result<Self, ControlError> {
        let room = Room::new(Bounds::of(limits), period, &HARMONICS, seed)?;
        Ok(Self {
            series: model_free(&room, seed),
        })
    }
}

impl Motion for Fourier {
    fn duration(&self) -> f64 {
        self.series.duration
    }

    fn at(&self, t: f64, command: &mut Command) {
        let mut state = State::new(self.series.dof());
        self.series.at(t, &mut state);
        command.q.copy_from_slice(&state.q);
        command.qd.copy_from_slice(&state.qd);
        command.qdd.copy_from_slice(&state.qdd);
    }
}
