//! `external_contact`: a force from outside during part of the recording.
//!
//! It does not repeat, so nothing fitted on one trajectory predicts it on another. It is found as bursts in the
//! residual of the other causes, in either recording, each by itself. A force on link k loads joints 1…k, not
//! those beyond: the last loaded joint names the link. For a joint at rest, the departure from the torque that
//! it holds most of the time counts. Pushed samples are neither fitted nor scored. Confounders: any rare event
//! that repeats with the motion, which a learner then predicts; a fault of one joint's torque channel or
//! transmission that comes and goes, which loads no other joint; a torque that is cut off; vibration, which
//! swings about zero.

mod crossings;
mod cut_off;
mod repeated;
mod steady;
mod windows;

use crate::motion::frame::Frame;
use crate::motion::standing::Judged;
use crate::schema::Push;
use crate::settings::ContactSettings;
use crossings::cross;
use cut_off::cut_off;
use ndarray::{Array2, ArrayView1, ArrayViewMut1};
use physics::dynamics::{Workspace, point_jacobian};
use physics::robot::Robot;
use repeated::repeats;
use std::ops::Range;
use steady::steadiness;
pub use windows::suspected;
use windows::{WINDOW, adjacent, windows};

/// Half width of the running mean that smooths the torque within a burst, s.
const SMOOTH: f64 = 0.012;
/// Number of passes of that running mean.
const PASSES: usize = 2;

/// Burst of a residual: a stretch of time in which some joint's residual is far above its level in the recording.
#[derive(Clone, Debug, PartialEq)]
pub struct Burst {
    /// Range of the recorded samples that are in the burst.
    pub samples: Range<usize>,
    /// Index of the outermost joint that the burst loads: a force on its link loads this joint and those before it.
    pub last_joint: usize,
    /// Largest residual in the burst, relative to the joint's level in this recording.
    pub height: f64,
    /// Whether a joint that the burst loads was at rest.
    pub at_rest: bool,
}

/// Pushes of a recording: bursts of the residual that a force from outside made, and their torque.
#[derive(Clone, Debug)]
pub struct Contact {
    /// Bursts in the order of the samples.
    pub bursts: Vec<Burst>,
    /// Torque of the pushes, N·m (N), shape (samples, joints); zero outside bursts.
    pub torque: Array2<f64>,
    /// Size of the contact: sum over joints of the mean square of `torque` over the variance of the measured torque.
    pub size: f64,
    /// Whether some push came while a joint was at rest.
    pub at_rest: bool,
}

/// Detects pushes in a residual at the recorded samples. Joints in motion count only with `moving`, where the motion
/// does not explain the residual. `load` is the torque that the links need, shape (samples, joints). None where no
/// burst stands out, or bursts take too much of the time.
pub fn detect(
    frame: &Frame,
    left: &Judged,
    load: &Array2<f64>,
    moving: bool,
    settings: &ContactSettings,
) -> Option<Contact> {
    let dof = frame.dof();
    let windows = windows(frame, left, moving);
    let n = windows.samples.len();
    if n < settings.fewest_windows {
        return None;
    }
    let levels: Vec<[f64; 2]> = (0..dof)
        .map(|j| {
            let least = settings.quiet * frame.tau.column(j).std(0.0);
            [false, true].map(|standing| windows.usual(j, standing, least))
        })
        .collect();
    let usual: Vec<f64> = levels.iter().map(|l| l[0].max(l[1])).collect();
    let relative = |w: usize, j: usize| {
        let usual = levels[j][usize::from(windows.standing[[w, j]])];
        windows.mean[[w, j]].map_or(0.0, |m| m.abs() / usual)
    };
    let highest = |w: usize| (0..dof).map(|j| relative(w, j)).fold(0.0, f64::max);
    let reach = ((settings.gap / WINDOW).round() as usize).max(1);
    let mut bursts: Vec<Range<usize>> = Vec::new();
    for w in (0..n).filter(|&w| highest(w) > settings.height) {
        match bursts.last_mut() {
            Some(b) if w - (b.end - 1) <= reach && adjacent(&windows.samples, b.end - 1, w) => {
                b.end = w + 1
            }
            _ => bursts.push(w..w + 1),
        }
    }
    let at_rest = |b: &Range<usize>| {
        let loaded = |w: usize, j: usize| relative(w, j) > settings.height;
        b.clone()
            .any(|w| (0..dof).any(|j| loaded(w, j) && windows.standing[[w, j]]))
    };
    // Bursts at rest count where the joint was quiet before and is so again afterwards: a joint that comes to rest is
    // no push. A hard push moves a joint a little, and it stands again soon.
    let budging = ((settings.budging / WINDOW).round() as usize).max(1);
    let between = |b: &Range<usize>| {
        let pushed = |j: &usize| {
            let mut each = b.clone();
            each.any(|w| windows.standing[[w, *j]] && relative(w, *j) > settings.height)
        };
        let pushed: Vec<usize> = (0..dof).filter(pushed).collect();
        let stands = |w: usize| pushed.iter().any(|&j| windows.standing[[w, j]]);
        let quiet = |w: usize| stands(w) && highest(w) <= settings.height;
        let mut before = b.start.saturating_sub(budging)..b.start;
        let mut after = b.end..(b.end + budging).min(n);
        before.any(|w| adjacent(&windows.samples, w, b.start) && quiet(w))
            && after.any(|w| adjacent(&windows.samples, b.end - 1, w) && quiet(w))
    };
    // Friction can hold a joint that was pushed away a little: against a push, motor torque and displacement are
    // opposite.
    let unheld = |w: usize, j: usize| {
        let of = windows.samples[w].clone();
        let mean = of.clone().map(|i| left.beyond[[i, j]]).sum::<f64>() / of.len() as f64;
        windows.standing[[w, j]] && mean.abs() > settings.height * levels[j][1]
    };
    let pushed = |b: &Range<usize>| b.clone().any(|w| (0..dof).any(|j| unheld(w, j)));
    bursts.retain(|b| {
        if at_rest(b) {
            pushed(b) && between(b)
        } else {
            b.len() >= settings.fewest
        }
    });
    let height = |b: &Range<usize>| b.clone().map(highest).fold(0.0, f64::max);
    let most = bursts.iter().map(height).fold(0.0, f64::max);
    bursts.retain(|b| height(b) >= settings.least_height * most);
    for b in &mut bursts {
        let start = b.start.saturating_sub(1);
        if adjacent(&windows.samples, start, b.start) {
            b.start = start;
        }
        if b.end < n && adjacent(&windows.samples, b.end - 1, b.end) {
            b.end += 1;
        }
    }
    let samples = |b: &Range<usize>| windows.samples[b.start].start..windows.samples[b.end - 1].end;
    let time = &frame.samples().time;
    let last = windows.samples[n - 1].end;
    // Bursts that have not ended, or are very long, are loads and no pushes.
    bursts.retain(|b| {
        let s = samples(b);
        s.end < last && time[s.end - 1] - time[s.start] <= settings.longest
    });
    // Bursts that recur with the motion are the robot's own.
    bursts.retain(|b| !repeats(frame, &left.departure, &samples(b), &usual, settings.again));
    let inside: usize = bursts.iter().map(Range::len).sum();
    // Joints in motion do not count where all bursts are at rest: the residual in motion tells nothing of those.
    let resting = bursts.iter().all(at_rest);
    let counts = |w: usize, j: &usize| !resting || windows.standing[[w, *j]];
    let energy = |w: usize| {
        let own = (0..dof).filter(|j| counts(w, j));
        own.map(|j| relative(w, j).powi(2)).sum::<f64>()
    };
    let all: f64 = (0..n).map(energy).sum();
    let share = bursts.iter().cloned().flatten().map(energy).sum::<f64>() / all;
    let long = inside as f64 > settings.most_time * n as f64;
    if bursts.is_empty() || long || share < settings.least_share {
        return None;
    }
    let rate = frame.report().rate_hz;
    let mut torque = Array2::zeros(left.departure.dim());
    let bursts: Vec<Burst> = bursts
        .into_iter()
        .map(|b| {
            let peak = |j: usize| b.clone().map(|w| relative(w, j)).fold(0.0, f64::max);
            let highest = (0..dof).map(peak).fold(0.0, f64::max);
            let last = (0..dof)
                .rev()
                .find(|&j| peak(j) > (settings.loaded * highest).max(settings.loaded_height))
                .unwrap_or(0);
            let samples = samples(&b);
            for j in 0..=last {
                follow(
                    left.departure.column(j),
                    samples.clone(),
                    rate,
                    torque.column_mut(j),
                );
            }
            Burst {
                samples,
                last_joint: last,
                height: highest,
                at_rest: at_rest(&b),
            }
        })
        .collect();
    let part: Vec<f64> = (0..dof)
        .map(|j| {
            let square = torque.column(j).dot(&torque.column(j)) / torque.nrows() as f64;
            square / frame.tau.column(j).var(0.0).max(1e-12)
        })
        .collect();
    let size: f64 = part.iter().sum();
    if dof > 1 && part.iter().any(|p| *p > settings.alone * size) {
        return None;
    }
    if dof > 1 && together(&torque, &bursts, frame, settings.alone) < settings.several {
        return None;
    }
    let pushed: Vec<Range<usize>> = bursts.iter().map(|b| b.samples.clone()).collect();
    let blows = |j: usize| cross(frame, torque.column(j), load.column(j), &pushed, settings);
    let most = (0..dof).max_by(|&a, &b| part[a].total_cmp(&part[b]));
    if most.is_some_and(blows) {
        return None;
    }
    let cut = |j: usize| cut_off(frame.tau.column(j), torque.column(j)) > settings.cut_off;
    if most.is_some_and(cut) {
        return None;
    }
    let piece = (settings.steady_time * rate).round() as usize;
    let loads = || bursts.iter().map(|b| (b.samples.clone(), b.last_joint));
    if steadiness(&torque, loads(), &usual, piece) < settings.steady {
        return None;
    }
    Some(Contact {
        at_rest: bursts.iter().any(|b| b.at_rest),
        bursts,
        torque,
        size,
    })
}

/// Part of the bursts' load that lies in bursts of which no joint bears more than the part `alone`. The load is the
/// squared mean torque relative to the joint's torque variance.
fn together(torque: &Array2<f64>, bursts: &[Burst], frame: &Frame, alone: f64) -> f64 {
    let (mut several, mut all) = (0.0, 0.0);
    for burst in bursts {
        let rows = burst.samples.len() as f64;
        let part = |j: usize| {
            let sum: f64 = burst.samples.clone().map(|i| torque[[i, j]]).sum();
            sum * sum / (rows * frame.tau.column(j).var(0.0).max(1e-12))
        };
        let parts: Vec<f64> = (0..torque.ncols()).map(part).collect();
        let sum: f64 = parts.iter().sum();
        all += sum;
        // A joint at rest shows a push that the noise of those in motion hides.
        if burst.at_rest || parts.iter().all(|p| *p <= alone * sum) {
            several += sum;
        }
    }
    several / all
}

/// Writes a joint's residual in the range `samples`, smoothed by running means that shorten towards its ends, to
/// `torque`.
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
    /// Whether each recorded sample lies in a push, or within `margin` samples of one.
    pub fn pushed(&self, samples: usize, margin: usize) -> Vec<bool> {
        let near =
            |i: usize, b: &Burst| i + margin >= b.samples.start && i < b.samples.end + margin;
        (0..samples)
            .map(|i| self.bursts.iter().any(|b| near(i, b)))
            .collect()
    }

    /// Indices of the joints that the pushes load.
    pub fn loaded(&self) -> Vec<usize> {
        let last = self.bursts.iter().map(|b| b.last_joint).max();
        (0..=last.unwrap_or(0)).collect()
    }

    /// Pushes for the report; `recording` is `data` or `heldout`.
    pub fn pushes(&self, recording: &'static str, robot: &Robot, frame: &Frame) -> Vec<Push> {
        let motion = frame.samples();
        let one = |b: &Burst| {
            let segment = motion
                .segments
                .iter()
                .position(|s| s.contains(&b.samples.start));
            let rows = b.samples.len() as f64;
            let mean =
                |j: usize| b.samples.clone().map(|i| self.torque[[i, j]]).sum::<f64>() / rows;
            Push {
                recording,
                trajectory: segment.map_or(String::new(), |s| frame.label(s).to_owned()),
                start: motion.time[b.samples.start],
                end: motion.time[b.samples.end - 1],
                link: robot.joints()[b.last_joint].link.name.clone(),
                torque: (0..robot.dof()).map(mean).collect(),
            }
        };
        self.bursts.iter().map(one).collect()
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
    fn bursts_of_one_joint_each_load_no_joints_together() {
        let n = 400;
        let q = Array2::from_shape_fn((n, 2), |(i, j)| (0.02 * (i + j) as f64).sin());
        let time = (0..n).map(|i| 0.01 * i as f64).collect();
        let recording = datasets::Recording::new("r", time, q.clone(), Some(q.clone()));
        let frame = Frame::new(&recording, q, &datasets::PrepareOptions::low_passed(8.0)).unwrap();
        let bursts = [50..90, 200..260].map(|samples| Burst {
            samples,
            last_joint: 1,
            height: 20.0,
            at_rest: false,
        });
        let of = |loads: [[f64; 2]; 2]| {
            let mut torque = Array2::zeros((n, 2));
            for (burst, load) in bursts.iter().zip(loads) {
                for i in burst.samples.clone() {
                    torque[[i, 0]] = load[0];
                    torque[[i, 1]] = load[1];
                }
            }
            together(&torque, &bursts, &frame, 0.97)
        };
        assert!(of([[1.0, 0.01], [0.01, 1.0]]) < 0.1);
        assert!(of([[1.0, 0.5], [0.4, 1.0]]) > 0.9);
    }
}
