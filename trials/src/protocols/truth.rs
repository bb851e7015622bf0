//! True torque of a recorded motion by a simulated robot's own equations.

use super::effects::Effect;
use super::kr300;
use super::recorded::Protocol;
use super::runs::Machine;
use crate::SimulateError;
use ndarray::Array2;
use signal::Motion;

impl Protocol {
    /// Gain of the recording for slow motion: recorded positions, velocities and accelerations over the true ones.
    pub fn motion_gain(self) -> f64 {
        match self {
            Self::Ur5 | Self::FoxbotA05 => 1.0,
            Self::Kr300 => kr300::motion_gain(),
        }
    }
}

impl Machine {
    /// The robot without one effect.
    #[must_use]
    pub fn without(mut self, effect: Effect) -> Self {
        for own in &mut self.effects {
            *own = own.without(effect);
        }
        self
    }

    /// The robot without noise on the recorded torque; all other draws are unchanged.
    #[must_use]
    pub fn noiseless(mut self) -> Self {
        self.errors.torque.fill(0.0);
        self
    }

    /// Torque by the robot's true equations over a motion up to each of its samples, N·m, shape (samples, joints): bristles
    /// start unbent, gears at the temperature of their mean power, and both go on from segment to segment.
    ///
    /// # Errors
    /// The bodies make no possible robot, or gears are elastic: a motor's motion alone does not tell the torque then.
    pub fn torque(&self, motion: &Motion) -> Result<Array2<f64>, SimulateError> {
        if !self.gears.is_empty() {
            return Err(SimulateError::Elastic);
        }
        let mut table = Array2::zeros(motion.q.dim());
        if motion.is_empty() {
            return Ok(table);
        }
        let at = |table: &Array2<f64>, row: usize| table.row(row).to_vec();
        let (mut plant, _) = self.plant(&at(&motion.q, 0), f64::INFINITY)?;
        let mut torque = vec![0.0; motion.dof()];
        for segment in &motion.segments {
            for row in segment.clone() {
                // The first sample of a segment is as far from the one before as the second is from it.
                let end = (row + 1).clamp(segment.start + 1, segment.end - 1);
                let dt = motion.time[end] - motion.time[end - 1];
                let state = [&motion.q, &motion.qd, &motion.qdd].map(|table| at(table, row));
                let [q, v, a] = [0, 1, 2].map(|k: usize| &state[k][..]);
                plant.invert([motion.time[row], dt], [q, v, a], &mut torque);
                table
                    .row_mut(row)
                    .assign(&ndarray::ArrayView1::from(&torque));
            }
        }
        Ok(table)
    }
}
