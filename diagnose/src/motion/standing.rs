//! State of motion of the joints at each sample, and the part of a residual at rest that counts as gap.
//!
//! A joint at rest holds any torque up to its Coulomb torque. A residual that is constant within one rest and
//! below that torque is friction, not a gap. A change within the rest, or a larger residual, is a gap.
//! Exception: a joint that creeps, whose friction turns against the creep and holds that torque afterwards. A
//! push that moves a joint leaves torque of the other sign. Slow passages through a reversal are exempt: there
//! not even the true plant's model reaches the noise.

use crate::motion::frame::Frame;
use crate::settings::MotionSettings;
use ndarray::Array2;
use signal::quantile::median;
use std::ops::Range;

/// State of motion of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// Faster than the reversal speed.
    Moving,
    /// Slower than the reversal speed, but not for long.
    Passing,
    /// At rest for longer than the setting `rest`.
    Standing,
}

/// Coulomb friction in a prediction.
pub struct Coulomb {
    /// Coulomb torque of each joint, N·m (N).
    pub torque: Vec<f64>,
    /// Softened sign of the velocity at the recorded samples, shape (samples, joints).
    pub sign: Array2<f64>,
}

/// A residual judged by the joints' state of motion. Tables of shape (samples, joints).
pub struct Judged {
    /// State of motion of each joint.
    pub state: Array2<State>,
    /// The residual; for a joint at rest, the part that friction at rest cannot hold.
    pub gap: Array2<f64>,
    /// The residual; for a joint at rest, its departure from the torque that it holds most of the time.
    pub departure: Array2<f64>,
    /// Departure beyond the torque that friction holds where a joint at rest gave way a little.
    pub beyond: Array2<f64>,
}

/// State of motion of each joint at the recorded samples, shape (samples, joints).
pub fn states(frame: &Frame, settings: &MotionSettings) -> Array2<State> {
    let motion = frame.samples();
    let mut state = Array2::from_elem(motion.qd.dim(), State::Moving);
    for j in 0..frame.dof() {
        for rest in rests(frame, j, settings) {
            let span = motion.time[rest.end - 1] - motion.time[rest.start];
            let stands =
                span > settings.rest && stays(frame, j, &rest, settings) >= settings.staying;
            for i in rest.clone() {
                let (before, after) = (
                    motion.time[i] - motion.time[rest.start],
                    motion.time[rest.end - 1] - motion.time[i],
                );
                let inside = stands && before.min(after) >= settings.rest_edge;
                let slow = motion.qd[[i, j]].abs() < settings.reversal_speed;
                state[[i, j]] = match (inside, slow) {
                    (true, _) => State::Standing,
                    (false, true) => State::Passing,
                    (false, false) => State::Moving,
                };
            }
        }
    }
    state
}

/// Part of a rest's samples at which the joint keeps its position.
fn stays(frame: &Frame, joint: usize, rest: &Range<usize>, settings: &MotionSettings) -> f64 {
    let creep = creep(frame, joint, rest, settings);
    creep.iter().filter(|c| c.is_none()).count() as f64 / rest.len() as f64
}

/// Direction in which a joint creeps around each sample of a rest: sign of its velocity; none where it keeps its position.
fn creep(
    frame: &Frame,
    joint: usize,
    rest: &Range<usize>,
    settings: &MotionSettings,
) -> Vec<Option<f64>> {
    way(
        frame,
        joint,
        rest,
        settings,
        settings.stays_speed * settings.stays_time,
    )
}

/// Direction in which a joint moves by `least` or more around each sample of a rest. Its motor or its
/// neighbours move it in that direction; where a push does, the motor's torque has the opposite sign.
fn way(
    frame: &Frame,
    joint: usize,
    rest: &Range<usize>,
    settings: &MotionSettings,
    least: f64,
) -> Vec<Option<f64>> {
    let q = frame.samples().q.column(joint);
    let half = ((0.5 * settings.stays_time * frame.report().rate_hz).round() as usize).max(1);
    let way = |i: usize| {
        let a = i.saturating_sub(half).max(rest.start);
        let travel = q[(i + half).min(rest.end - 1)] - q[a];
        (travel.abs() >= least).then(|| travel.signum())
    };
    rest.clone().map(way).collect()
}

/// Runs of samples in which a joint is slower than the reversal speed, or is only budged by a push.
fn rests(frame: &Frame, joint: usize, settings: &MotionSettings) -> Vec<Range<usize>> {
    let motion = frame.samples();
    let mut out: Vec<Range<usize>> = Vec::new();
    for segment in &motion.segments {
        let mut open: Option<usize> = None;
        for i in segment.clone() {
            let slow = motion.qd[[i, joint]].abs() < settings.reversal_speed;
            match (slow, open) {
                (true, None) => open = Some(i),
                (false, Some(start)) => {
                    out.push(start..i);
                    open = None;
                }
                _ => {}
            }
        }
        out.extend(open.map(|start| start..segment.end));
        out.dedup_by(|next, last| {
            let goes_on = last.start >= segment.start
                && motion.time[next.start] - motion.time[last.end - 1] < settings.budges_time
                && (motion.q[[next.start, joint]] - motion.q[[last.end - 1, joint]]).abs()
                    < settings.budges_way;
            if goes_on {
                last.end = next.end;
            }
            goes_on
        });
    }
    out
}

impl Judged {
    /// The judged residual with samples at reversals marked as [`State::Passing`], as far as the low-pass smears them.
    pub fn off_turns(mut self, frame: &Frame, settings: &MotionSettings) -> Self {
        let states = self.state.iter_mut();
        for (state, turning) in states.zip(&frame.samples_at_reversals(settings)) {
            if *turning && *state == State::Moving {
                *state = State::Passing;
            }
        }
        self
    }
}

/// Judges a residual at the recorded samples, shape (samples, joints). `coulomb` is the Coulomb friction in its prediction.
pub fn judge(
    frame: &Frame,
    residual: &Array2<f64>,
    coulomb: &Coulomb,
    settings: &MotionSettings,
) -> Judged {
    let mut state = states(frame, settings);
    let [mut gap, mut departure, mut beyond] = [0; 3].map(|_| residual.clone());
    for j in 0..frame.dof() {
        let most = coulomb.torque[j].abs();
        let mut start = 0;
        while start < state.nrows() {
            if state[[start, j]] != State::Standing {
                start += 1;
                continue;
            }
            let end = (start..state.nrows())
                .find(|&i| state[[i, j]] != State::Standing)
                .unwrap_or(state.nrows());
            // The sign of a velocity that is noise is no prediction.
            let held: Vec<f64> = (start..end)
                .map(|i| residual[[i, j]] + coulomb.torque[j] * coulomb.sign[[i, j]])
                .collect();
            let usual = usual(&held, most, settings);
            let creep = creep(frame, j, &(start..end), settings);
            let lead = (settings.stays_time * frame.report().rate_hz).round() as usize;
            let gave = way(frame, j, &(start..end), settings, settings.gives);
            let long = (settings.gives_time * frame.report().rate_hz).round() as usize;
            let (mut least, mut largest) = (usual, usual);
            for (i, x) in (start..end).zip(&held) {
                // Friction of a joint that is about to creep, creeps or has crept has turned towards its creep.
                let about = &creep[i - start..(i + lead + 1).min(end) - start];
                if let Some(way) = about.iter().flatten().next() {
                    let turned = way * settings.breakaway * most;
                    (least, largest) = (least.min(turned), largest.max(turned));
                }
                let change = x - x.clamp(least, largest);
                // Friction of one that gave way a little is turned that way, for a while.
                let there = (i - start).saturating_sub(long)..(i + lead + 1).min(end) - start;
                let there = gave[there].iter().flatten();
                let there = there.map(|way| way * settings.breakaway * most);
                let (lower, upper) = there.fold((least, largest), |(a, b), x| (a.min(x), b.max(x)));
                beyond[[i, j]] = x - x.clamp(lower, upper);
                // What counts as constant is no change.
                let constant = change.clamp(-settings.constant * most, settings.constant * most);
                gap[[i, j]] = usual - usual.clamp(-most, most) + change - constant;
                departure[[i, j]] = change;
            }
            let stands = plateau(&held, usual, most, settings);
            for i in (start..end).filter(|i| !stands.contains(&(i - start))) {
                state[[i, j]] = State::Passing;
            }
            start = end;
        }
    }
    Judged {
        state,
        gap,
        departure,
        beyond,
    }
}

/// Torque that a joint holds for most of a rest, N·m (N): the median of the values within `most`, its Coulomb torque.
/// Of the whole rest where too little of it lies within.
fn usual(held: &[f64], most: f64, settings: &MotionSettings) -> f64 {
    let within: Vec<f64> = held.iter().copied().filter(|x| x.abs() <= most).collect();
    let long = within.len() as f64 >= settings.held * held.len() as f64;
    median(if long { within } else { held.to_vec() }).unwrap_or(0.0)
}

/// Samples of a rest that are judged. At its start a joint gives way, and at its end it is loaded, until it
/// holds its torque or breaks away. As long as friction can hold that torque, such a part belongs to the motion
/// before or after.
fn plateau(held: &[f64], usual: f64, most: f64, settings: &MotionSettings) -> Range<usize> {
    let steps = held.windows(2).map(|x| (x[1] - x[0]).abs()).collect();
    let band = settings.constant * most + settings.constant_steps * median(steps).unwrap_or(0.0);
    let constant = |x: &f64| (x - usual).abs() <= band;
    let possible = |x: &[f64]| {
        x.iter()
            .all(|x| x.abs() <= settings.breakaway * most + band)
    };
    let flat = held.iter().filter(|x| constant(x)).count();
    if (flat as f64) < settings.plateau * held.len() as f64 && possible(held) {
        return 0..0;
    }
    let first = held.iter().position(constant).unwrap_or(0);
    let last = held
        .iter()
        .rposition(constant)
        .map_or(held.len(), |l| l + 1);
    let start = if possible(&held[..first]) { first } else { 0 };
    let end = if possible(&held[last..]) {
        last
    } else {
        held.len()
    };
    start..end
}

#[cfg(test)]
mod tests {
    use super::*;
    use datasets::Recording;

    /// A joint that turns for 4 s, then rests for 4 s, but for the way that it creeps from 6 to 6.8 s, rad/s; its motor's torque.
    fn frame(creep: f64, tau: &Array2<f64>) -> Frame {
        let time: Vec<f64> = (0..800).map(|i| 0.01 * f64::from(i)).collect();
        let q = Array2::from_shape_fn((800, 1), |(i, _)| {
            let t = time[i].min(4.0);
            let crept = creep * (time[i].min(6.8) - 6.0).max(0.0);
            1.0 - (std::f64::consts::TAU * t / 4.0).cos() + crept
        });
        let tau = tau.clone();
        let recording = Recording::new("r", time, q, Some(tau.clone()));
        Frame::new(&recording, tau, &datasets::PrepareOptions::low_passed(8.0)).unwrap()
    }

    #[test]
    fn friction_at_rest_is_no_gap_and_a_push_is() {
        let coulomb = Coulomb {
            torque: vec![2.0],
            sign: Array2::zeros((800, 1)),
        };
        let settings = MotionSettings::default();
        let mut residual = Array2::from_elem((800, 1), 1.5);
        let still = frame(0.0, &residual);
        let states = states(&still, &settings);
        assert_eq!(states[[100, 0]], State::Moving);
        assert_eq!(states[[600, 0]], State::Standing);
        let held = judge(&still, &residual, &coulomb, &settings).gap;
        assert_eq!((held[[100, 0]], held[[600, 0]]), (1.5, 0.0));
        // A push of 10 N·m in part of the rest, and a rest that friction cannot hold.
        (600..650).for_each(|i| residual[[i, 0]] += 10.0);
        let pushed = judge(&frame(0.0, &residual), &residual, &coulomb, &settings).gap;
        assert!(
            (pushed[[620, 0]] - 9.7).abs() < 1e-9,
            "all but 15 % of 2 N·m"
        );
        assert_eq!(pushed[[700, 0]], 0.0);
        let heavy = Array2::from_elem((800, 1), 5.0);
        assert_eq!(
            judge(&frame(0.0, &heavy), &heavy, &coulomb, &settings).gap[[700, 0]],
            3.0
        );
    }

    /// A joint that creeps down turns its friction down, before the way shows; a push that moves it down leaves torque upwards.
    #[test]
    fn friction_that_turns_towards_a_creep_is_no_departure() {
        let settings = MotionSettings::default();
        let coulomb = Coulomb {
            torque: vec![2.0],
            sign: Array2::zeros((800, 1)),
        };
        let departure =
            |creep: f64, crept: f64| {
                let residual = Array2::from_shape_fn((800, 1), |(i, _)| {
                    if (590..700).contains(&i) { crept } else { 1.5 }
                });
                let judged = judge(&frame(creep, &residual), &residual, &coulomb, &settings);
                assert_eq!(judged.state[[650, 0]], State::Standing);
                [595, 650].map(|i| judged.departure[[i, 0]])
            };
        assert_eq!(departure(-0.004, -2.2), [0.0, 0.0]);
        assert_eq!(departure(-0.004, 6.0), [4.5, 4.5]);
        assert_eq!(departure(0.0, -2.2).map(f64::round), [-4.0, -4.0]);
    }

    /// A joint that its motor moved up a little is held up there; where a push moved it up, its motor pulls down.
    #[test]
    fn friction_holds_a_joint_that_gave_way() {
        let coulomb = Coulomb {
            torque: vec![2.0],
            sign: Array2::zeros((800, 1)),
        };
        let settings = MotionSettings::default();
        let beyond =
            |speed: f64, held: f64| {
                let residual = Array2::from_shape_fn((800, 1), |(i, _)| {
                    if (600..680).contains(&i) { held } else { -1.0 }
                });
                let judged = judge(&frame(speed, &residual), &residual, &coulomb, &settings);
                judged.beyond[[650, 0]]
            };
        assert_eq!(beyond(1e-3, 2.0), 0.0);
        assert!(
            (beyond(1e-3, 3.0) - 0.6).abs() < 1e-9,
            "1.2 · 2 N·m are friction's"
        );
        assert_eq!((beyond(-1e-3, 2.0), beyond(0.0, 2.0)), (3.0, 3.0));
    }

    #[test]
    fn how_long_a_rest_is_judged_is_a_setting() {
        let frame = frame(0.0, &Array2::zeros((800, 1)));
        let longer = MotionSettings {
            rest: 5.0,
            ..MotionSettings::default()
        };
        assert_eq!(states(&frame, &longer)[[600, 0]], State::Passing);
    }

    /// A joint that is loaded until it breaks away, and one that turns round slowly, do not stand; one that is pushed does.
    #[test]
    fn what_friction_does_before_a_motion_is_no_rest() {
        let ramp = |from: usize| -> Vec<f64> {
            (0..100)
                .map(|i| {
                    if i < from {
                        0.0
                    } else {
                        2.0 * (i - from) as f64 / (100 - from) as f64
                    }
                })
                .collect()
        };
        let plateau = |held: &[f64], usual| plateau(held, usual, 2.0, &MotionSettings::default());
        let late = plateau(&ramp(70), 0.0);
        assert!(late.start == 0 && (70..80).contains(&late.end), "{late:?}");
        assert_eq!(plateau(&ramp(0), 1.0), 0..0);
        let mut pushed = vec![0.0; 100];
        (80..100).for_each(|i| pushed[i] = 9.0);
        assert_eq!(plateau(&pushed, 0.0), 0..100);
    }
}
