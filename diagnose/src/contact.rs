//! `external_contact`: a force from outside during part of the recording.
//!
//! It does not repeat, so nothing fitted on one trajectory predicts it on another: it is found as bursts of what
//! the other causes leave, in the recording that is scored. A force on link k loads joints 1…k, not those beyond:
//! the last loaded joint names the link. Within a burst the torque is followed in time by the smoothed residual.
//! Confounders: any rare event that repeats with the motion, which a learner then predicts; a fault of one joint's
//! torque channel or transmission that comes and goes, which loads no other joint; vibration, which swings about zero.

use crate::frame::{Frame, REVERSAL_SPEED};
use ndarray::{Array1, Array2, ArrayView1, ArrayViewMut1};
use physics::dynamics::{Workspace, point_jacobian};
use physics::robot::Robot;
use std::ops::Range;

/// Length of a window, s.
const WINDOW: f64 = 0.12;
/// Height of a burst over the usual window mean of its joint.
const HEIGHT: f64 = 8.0;
/// Gap between windows of one burst, s.
const GAP: f64 = 0.4;
/// Most of the time that bursts may take.
const MOST_TIME: f64 = 0.4;
/// Least part of the squared window means that lies in bursts.
const LEAST_SHARE: f64 = 0.5;
/// Window mean below which a joint counts as unloaded, relative to its torque.
const QUIET: f64 = 0.004;

/// Half width of the running means that follow a burst, s, and their number.
const SMOOTH: f64 = 0.012;
const PASSES: usize = 2;
/// Part of the load, relative to the joints' torques, from which one joint is loaded alone: no force from outside.
const ALONE: f64 = 0.97;
/// Part of the bursts' squared torque that has to be steady. Whoever touches the robot pushes it; what swings about zero
/// inside every burst is the vibration of a joint or of the ground.
const STEADY: f64 = 0.18;

/// One burst.
#[derive(Clone, Debug, PartialEq)]
pub struct Burst {
    /// Recorded samples.
    pub samples: Range<usize>,
    /// Last joint that it loads.
    pub last_joint: usize,
    /// Largest torque over its usual level.
    pub height: f64,
}

/// Bursts of a recording and the torque that they stand for.
#[derive(Clone, Debug)]
pub struct Contact {
    /// Bursts in the order of the samples.
    pub bursts: Vec<Burst>,
    /// Torque, shape (samples, joints); zero outside bursts.
    pub torque: Array2<f64>,
    /// Part of the squared window means that lies in bursts.
    pub share: f64,
    /// Sum over joints of the torque's mean square over the variance of the measured torque.
    pub size: f64,
}

/// Windows of a trajectory: mean residual per joint.
struct Windows {
    samples: Vec<Range<usize>>,
    mean: Array2<f64>,
}

/// Looks for bursts in a residual at the recorded samples. None where nothing stands out, or too much does.
pub fn detect(frame: &Frame, residual: &Array2<f64>) -> Option<Contact> {
    let windows = windows(frame, residual);
    let n = windows.samples.len();
    if n < 20 {
        return None;
    }
    let usual: Vec<f64> = (0..frame.dof())
        .map(|j| {
            let mut size: Vec<f64> = windows.mean.column(j).iter().map(|m| m.abs()).collect();
            size.sort_by(f64::total_cmp);
            let least = QUIET * frame.tau.column(j).std(0.0);
            (1.4826 * size[n / 2]).max(least).max(1e-9)
        })
        .collect();
    let height = |w: usize| {
        (0..frame.dof())
            .map(|j| windows.mean[[w, j]].abs() / usual[j])
            .fold(0.0, f64::max)
    };
    let reach = ((GAP / WINDOW).round() as usize).max(1);
    let mut bursts: Vec<Range<usize>> = Vec::new();
    for w in (0..n).filter(|&w| height(w) > HEIGHT) {
        match bursts.last_mut() {
            Some(b) if w - (b.end - 1) <= reach && adjacent(&windows.samples, b.end - 1, w) => {
                b.end = w + 1
            }
            _ => bursts.push(w..w + 1),
        }
    }
    // Short ones may be reversals.
    bursts.retain(|b| b.len() >= 3);
    for b in &mut bursts {
        let start = b.start.saturating_sub(1);
        if adjacent(&windows.samples, start, b.start) {
            b.start = start;
        }
        if b.end < n && adjacent(&windows.samples, b.end - 1, b.end) {
            b.end += 1;
        }
    }
    let inside: usize = bursts.iter().map(Range::len).sum();
    let energy = |w: usize| {
        (0..frame.dof())
            .map(|j| (windows.mean[[w, j]] / usual[j]).powi(2))
            .sum::<f64>()
    };
    let all: f64 = (0..n).map(energy).sum();
    let share = bursts.iter().cloned().flatten().map(energy).sum::<f64>() / all;
    if bursts.is_empty() || inside as f64 > MOST_TIME * n as f64 || share < LEAST_SHARE {
        return None;
    }
    let rate = frame.report().rate_hz;
    let mut torque = Array2::zeros(residual.dim());
    let bursts: Vec<Burst> = bursts
        .into_iter()
        .map(|b| {
            let peak = |j: usize| {
                b.clone()
                    .map(|w| windows.mean[[w, j]].abs() / usual[j])
                    .fold(0.0, f64::max)
            };
            let highest = (0..frame.dof()).map(peak).fold(0.0, f64::max);
            let last = (0..frame.dof())
                .rev()
                .find(|&j| peak(j) > (0.15 * highest).max(4.0))
                .unwrap_or(0);
            let samples = windows.samples[b.start].start..windows.samples[b.end - 1].end;
            for j in 0..=last {
                follow(
                    residual.column(j),
                    samples.clone(),
                    rate,
                    torque.column_mut(j),
                );
            }
            Burst {
                samples,
                last_joint: last,
                height: highest,
            }
        })
        .collect();
    let load: Vec<f64> = (0..frame.dof())
        .map(|j| {
            let square = torque.column(j).dot(&torque.column(j)) / residual.nrows() as f64;
            square / frame.tau.column(j).var(0.0).max(1e-12)
        })
        .collect();
    let size: f64 = load.iter().sum();
    if frame.dof() > 1 && load.iter().any(|l| *l > ALONE * size) {
        return None;
    }
    if steadiness(&torque, &bursts, &usual) < STEADY {
        return None;
    }
    Some(Contact {
        bursts,
        torque,
        share,
        size,
    })
}

/// Part of the bursts' squared torque, relative to the joints' usual level, that their means make.
fn steadiness(torque: &Array2<f64>, bursts: &[Burst], usual: &[f64]) -> f64 {
    let (mut mean, mut all) = (0.0, 0.0);
    for burst in bursts {
        for (j, level) in usual.iter().enumerate().take(burst.last_joint + 1) {
            let (sum, square) = burst
                .samples
                .clone()
                .map(|i| torque[[i, j]] / level)
                .fold((0.0, 0.0), |(s, q), x| (s + x, q + x * x));
            mean += sum * sum / burst.samples.len() as f64;
            all += square;
        }
    }
    mean / all
}

/// Whether two windows follow each other without a break between trajectories.
fn adjacent(samples: &[Range<usize>], a: usize, b: usize) -> bool {
    a <= b && (a..b).all(|w| samples[w].end == samples[w + 1].start)
}

fn windows(frame: &Frame, residual: &Array2<f64>) -> Windows {
    let length = ((WINDOW * frame.report().rate_hz).round() as usize).max(2);
    let samples: Vec<Range<usize>> = frame
        .samples()
        .segments
        .iter()
        .flat_map(|s| {
            (0..s.len() / length).map(move |w| s.start + w * length..s.start + (w + 1) * length)
        })
        .collect();
    // What happens while a joint turns round is friction's.
    let qd = &frame.samples().qd;
    let mean = Array2::from_shape_fn((samples.len(), residual.ncols()), |(w, j)| {
        if samples[w].clone().any(|i| {
            qd[[i, j]] * qd[[samples[w].start, j]] <= 0.0 || qd[[i, j]].abs() < REVERSAL_SPEED
        }) {
            return 0.0;
        }
        samples[w].clone().map(|i| residual[[i, j]]).sum::<f64>() / length as f64
    });
    Windows { samples, mean }
}

/// The residual of a joint inside a burst, smoothed by running means, which shorten towards its ends.
fn follow(
    residual: ArrayView1<f64>,
    samples: Range<usize>,
    rate: f64,
    mut torque: ArrayViewMut1<f64>,
) {
    let half = ((SMOOTH * rate).round() as usize).max(1);
    let mut x: Vec<f64> = samples.clone().map(|i| residual[i]).collect();
    for _ in 0..PASSES {
        let mut sums = vec![0.0];
        for v in &x {
            sums.push(sums[sums.len() - 1] + v);
        }
        let n = x.len();
        for (i, v) in x.iter_mut().enumerate() {
            let h = half.min(i).min(n - 1 - i);
            *v = (sums[i + h + 1] - sums[i - h]) / (2 * h + 1) as f64;
        }
    }
    for (i, v) in samples.zip(x) {
        torque[i] = v;
    }
}

impl Contact {
    /// Whether a row that is fitted lies in a burst, on any joint; `margin` in samples on either side.
    pub fn covers(&self, frame: &Frame, margin: usize) -> Vec<bool> {
        let index: Array1<f64> = (0..frame.tau.nrows()).map(|i| i as f64).collect();
        frame
            .pick(index.view())
            .iter()
            .map(|&i| {
                let i = i as usize;
                self.bursts
                    .iter()
                    .any(|b| i + margin >= b.samples.start && i < b.samples.end + margin)
            })
            .collect()
    }

    /// Largest force at the origin of the frame after the loaded link, N, by least squares over J_vᵀ f, for the
    /// strongest burst.
    pub fn force(&self, robot: &Robot, frame: &Frame) -> Option<f64> {
        let burst = self
            .bursts
            .iter()
            .max_by(|a, b| a.height.total_cmp(&b.height))?;
        let n = robot.dof();
        let point = robot
            .joints()
            .get(burst.last_joint + 1)
            .map_or(nalgebra::Vector3::zeros(), |j| j.translation);
        let mut workspace = Workspace::new(robot);
        let mut jacobian = vec![0.0; 6 * n];
        let mut most = 0.0f64;
        for i in burst.samples.clone().step_by(8) {
            let q = frame.samples().q.row(i).to_vec();
            point_jacobian(
                robot,
                &mut workspace,
                &q,
                burst.last_joint,
                &point,
                &mut jacobian,
            );
            let j = nalgebra::DMatrix::from_row_slice(6, n, &jacobian)
                .rows(0, 3)
                .transpose();
            let tau = nalgebra::DVector::from_iterator(n, self.torque.row(i).iter().copied());
            let jtj = j.transpose() * &j + nalgebra::DMatrix::identity(3, 3) * 1e-4;
            let f = jtj.lu().solve(&(j.transpose() * tau))?;
            most = most.max(f.norm());
        }
        Some(most)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_push_is_steady_and_a_vibration_is_not() {
        let n = 400;
        let burst = Burst {
            samples: 100..300,
            last_joint: 1,
            height: 50.0,
        };
        let of = |f: &dyn Fn(f64) -> f64| {
            let torque = Array2::from_shape_fn((n, 2), |(i, j)| {
                (1.0 + j as f64) * f((i as f64 - 100.0) / 200.0)
            });
            steadiness(&torque, std::slice::from_ref(&burst), &[0.1, 0.3])
        };
        let push = of(&|x| (std::f64::consts::PI * x).sin());
        let swing = of(&|x| (std::f64::consts::TAU * 6.0 * x).sin() * (1.0 - x));
        assert!(push > 0.7 && swing < 0.05, "{push} {swing}");
    }
}
