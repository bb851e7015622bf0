//! Torque channel from a diagnosis: relation between a joint's torque and its recorded value. It is a property
//! of the recording, not of the robot: scores compensate for it, a control loop does not have it.

use ndarray::Array2;
use serde::{Deserialize, Serialize};
use signal::Motion;

/// Recorded torque = gain·τ + offset, cut at a limit; true position = recorded position + zero. One value per joint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TorqueChannel {
    /// Gain of each joint: recorded torque over torque.
    pub gain: Vec<f64>,
    /// Bias of each joint's recorded torque, N·m (N).
    pub offset: Vec<f64>,
    /// Largest torque that is recorded of each joint, N·m (N); none where nothing is cut.
    pub limit: Vec<Option<f64>>,
    /// Zero of each joint: true position less recorded position, rad (m).
    pub zero: Vec<f64>,
}

impl TorqueChannel {
    /// Channel of `dof` joints without error.
    pub fn faithful(dof: usize) -> Self {
        Self {
            gain: vec![1.0; dof],
            offset: vec![0.0; dof],
            limit: vec![None; dof],
            zero: vec![0.0; dof],
        }
    }

    /// Whether all lists have the length `dof`.
    pub fn fits(&self, dof: usize) -> bool {
        let lengths = [
            self.gain.len(),
            self.offset.len(),
            self.limit.len(),
            self.zero.len(),
        ];
        lengths.iter().all(|&l| l == dof)
    }

    /// Turns recorded positions into true ones.
    pub fn turn(&self, motion: &mut Motion) {
        for (mut q, zero) in motion.q.columns_mut().into_iter().zip(&self.zero) {
            q += *zero;
        }
    }

    /// Turns torque, shape (samples, joints), into recorded torque.
    pub fn note(&self, torque: &mut Array2<f64>) {
        for (j, mut tau) in torque.columns_mut().into_iter().enumerate() {
            let limit = self.limit[j].unwrap_or(f64::INFINITY);
            tau.mapv_inplace(|t| (self.gain[j] * t + self.offset[j]).clamp(-limit, limit));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::array;

    #[test]
    fn by_hand() {
        let channel = TorqueChannel {
            gain: vec![2.0, 1.0],
            offset: vec![0.5, 0.0],
            limit: vec![Some(4.0), None],
            zero: vec![0.0; 2],
        };
        let mut torque = array![[1.0, 7.0], [-3.0, -7.0]];
        channel.note(&mut torque);
        assert_eq!(torque, array![[2.5, 7.0], [-4.0, -7.0]]);
        assert!(channel.fits(2) && !channel.fits(3));
        let mut same = torque.clone();
        TorqueChannel::faithful(2).note(&mut same);
        assert_eq!(same, torque);
    }
}
