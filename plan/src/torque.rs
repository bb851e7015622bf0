//! The torque along a motion.

use feedforward::Feedforward;
use feedforward::clock::LONGEST_PAUSE;
use feedforward::network::Inside;
use ndarray::Array2;
use signal::Motion;
use std::fmt;

/// How far the compensator of one joint was outside its training.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outside {
    /// Samples in which it was faded, and those of them in which nothing of it was left.
    samples: usize,
    off: usize,
    /// Time of the first of them, s.
    first: f64,
}

impl fmt::Display for Outside {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(
            f,
            "from {:.3} s on the motion is at times unlike that of the training; the compensator is switched off in {}, faded in {} more",
            self.first,
            self.off,
            self.samples - self.off
        )
    }
}

/// Counts a sample outside the training.
fn count(outside: &mut Option<Outside>, inside: Inside, time: f64) {
    if inside.weight < 1.0 {
        let seen = outside.get_or_insert(Outside {
            samples: 0,
            off: 0,
            first: time,
        });
        seen.samples += 1;
        seen.off += usize::from(inside.weight <= 0.0);
    }
}

/// Torque of every joint for every sample, N·m or N, from neutral memory; shape (samples, joints). Beside it the joints whose
/// compensator is faded on the way. Trajectories that follow each other soon share what friction remembers.
pub fn along(model: &mut Feedforward, motion: &Motion) -> (Array2<f64>, Vec<Option<Outside>>) {
    let n = model.dof();
    let mut torque = Array2::zeros((motion.time.len(), n));
    let mut outside = vec![None; n];
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
            for (joint, outside) in outside.iter_mut().enumerate() {
                count(outside, model.inside(joint), motion.time[row]);
            }
        }
    }
    (torque, outside)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_outside_are_counted() {
        let mut outside = None;
        count(&mut outside, Inside::NOTHING_LEARNED, 0.0);
        assert_eq!(outside, None);
        for (time, (weight, excess)) in [(1.0, -0.2), (0.7, 0.2), (0.0, 0.9), (0.0, 0.8)]
            .into_iter()
            .enumerate()
        {
            count(&mut outside, Inside { weight, excess }, time as f64);
        }
        let text = outside.unwrap().to_string();
        assert!(text.starts_with("from 1.000 s on"), "{text}");
        assert!(
            text.ends_with("switched off in 2, faded in 1 more"),
            "{text}"
        );
    }
}
