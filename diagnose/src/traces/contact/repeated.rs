//! Bursts that recur when the motion is repeated, which no force from outside does.

use crate::motion::frame::Frame;
use ndarray::Array2;
use std::ops::Range;

/// Whether a burst recurs when its motion is repeated: another execution shows at least the part `again` of it at the
/// same time. `departure` is the residual at the recorded samples, shape (samples, joints), and `usual` its typical
/// size on each joint.
pub(super) fn repeats(
    frame: &Frame,
    departure: &Array2<f64>,
    samples: &Range<usize>,
    usual: &[f64],
    again: f64,
) -> bool {
    let motion = frame.samples();
    let Some(own) = motion
        .segments
        .iter()
        .position(|s| s.contains(&samples.start))
    else {
        return false;
    };
    let mean = |rows: &Range<usize>| -> Vec<f64> {
        let of = |j: usize| rows.clone().map(|i| departure[[i, j]]).sum::<f64>();
        let size = rows.len().max(1) as f64;
        (0..usual.len())
            .map(|j| of(j) / (size * usual[j]))
            .collect()
    };
    let burst = mean(samples);
    let size: f64 = burst.iter().map(|x| x * x).sum();
    let start = motion.time[samples.start] - motion.time[motion.segments[own].start];
    executions(frame.repeats(), own).into_iter().any(|other| {
        let segment = motion.segments[other].clone();
        let first = motion.time[segment.start];
        let Some(at) = segment
            .clone()
            .find(|&i| motion.time[i] - first >= start - 1e-9)
        else {
            return false;
        };
        let there = mean(&(at..(at + samples.len()).min(segment.end)));
        let product: f64 = burst.iter().zip(&there).map(|(a, b)| a * b).sum();
        product > again * size
    })
}

/// Indices of the other executions of the motion of execution `of`. `pairs` link each execution with the next one.
fn executions(pairs: &[(usize, usize)], of: usize) -> Vec<usize> {
    let mut found = vec![of];
    let mut k = 0;
    while k < found.len() {
        for &(a, b) in pairs {
            let next = if a == found[k] {
                b
            } else if b == found[k] {
                a
            } else {
                continue;
            };
            if !found.contains(&next) {
                found.push(next);
            }
        }
        k += 1;
    }
    found.split_off(1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use datasets::{Recording, Trajectory};

    #[test]
    fn a_burst_in_every_execution_repeats_and_one_in_one_does_not() {
        assert_eq!(executions(&[(0, 2), (2, 5), (1, 3)], 2), [0, 5]);
        let n = 900;
        let time: Vec<f64> = (0..n).map(|i| 0.01 * i as f64).collect();
        let q = Array2::from_shape_fn((n, 1), |(i, _)| (0.021 * (i % 300) as f64).sin());
        let tau = q.clone();
        let mut recording = Recording::new("r", time, q, Some(tau.clone()));
        recording.trajectories = (0..3)
            .map(|k| Trajectory {
                label: k.to_string(),
                range: 300 * k..300 * (k + 1),
            })
            .collect();
        let frame =
            Frame::new(&recording, tau, &datasets::PrepareOptions::low_passed(8.0)).unwrap();
        let mut departure = Array2::zeros((n, 1));
        for i in [100, 400, 700] {
            (i..i + 40).for_each(|k| departure[[k, 0]] = 5.0);
        }
        (820..860).for_each(|k| departure[[k, 0]] = 5.0);
        assert!(repeats(&frame, &departure, &(400..440), &[1.0], 0.3));
        assert!(!repeats(&frame, &departure, &(820..860), &[1.0], 0.3));
    }
}
