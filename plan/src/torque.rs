//! The torque along a motion.

use feedforward::Feedforward;
use feedforward::clock::LONGEST_PAUSE;
use ndarray::Array2;
use signal::Motion;

/// Torque of every joint for every sample, N·m or N, from neutral memory; shape (samples, joints). Trajectories that follow each other
/// soon share what friction remembers.
pub fn along(model: &mut Feedforward, motion: &Motion) -> Array2<f64> {
    let n = model.dof();
    let mut torque = Array2::zeros((motion.time.len(), n));
    let mut last = None;
    for segment in &motion.segments {
        let start = motion.time[segment.start];
        match last.map(|end| start - end) {
            Some(pause) if (0.0..=LONGEST_PAUSE).contains(&pause) => model.pause(pause),
            _ => model.reset(None),
        }
        last = Some(motion.time[segment.end - 1]);
        let mut tau = vec![0.0; n];
        for row in segment.clone() {
            let [q, qd, qdd] = [&motion.q, &motion.qd, &motion.qdd].map(|t| t.row(row).to_vec());
            model.torque(&q, &qd, &qdd, &mut tau);
            for (cell, tau) in torque.row_mut(row).iter_mut().zip(&tau) {
                *cell = *tau;
            }
        }
    }
    torque
}
