//! `time_delay`: torque and motion recorded with a shift in time, τ(t) = τ̂(t − delay), by interpolation of the whole
//! prediction, friction jumps included. All joints share it, but for a joint whose current is filtered more or less than the
//! others'. A current's filter makes it late, too: a first-order lag, which rounds the friction jumps. Confounders: presliding
//! (reversals only), elasticity (second derivative), viscous friction of the acceleration.

use super::candidate::{Bound, Candidate, Column, Quantity};
use super::effect::Effect;
use super::info::Info;
use crate::motion::delay::delayed;
use crate::motion::scene::Scene;
use ndarray::{Array1, ArrayView1};
use signal::Motion;

/// What is known of it beside its columns.
pub(super) const INFO: Info = Info {
    name: "time_delay",
    plain: "a time shift between torque and motion",
    confounders: &[Effect::JointElasticity, Effect::Backlash],
    dynamic: true,
    place: Some("MJCF"),
    remedy: "shift the torque in the recording, or delay the actuator ({})",
    ..Info::NEW
};

/// Delays in sampling intervals; the coefficient corrects what lies between.
const DELAYS: [f64; 12] = [
    -12.0, -6.0, -3.0, -1.5, -0.75, 0.75, 1.5, 3.0, 5.0, 8.0, 12.0, 18.0,
];

/// Those of a single joint, beside what all share.
const OWN: [f64; 7] = [-4.0, -2.0, -1.0, 1.0, 2.0, 4.0, 8.0];
/// Time constants of a filter, in sampling intervals.
const LAGS: [f64; 4] = [0.75, 1.5, 3.0, 6.0];

/// What makes a torque late.
#[derive(Clone, Copy, Debug)]
enum Late {
    /// A shift, s.
    Shift(f64),
    /// A first-order filter's time constant, s.
    Filter(f64),
}

/// Of the whole arm.
pub(super) fn candidates(scene: &Scene) -> Vec<Candidate> {
    all(scene, (0..scene.dof()).collect(), &DELAYS)
}

/// Of one joint alone.
pub(super) fn own(scene: &Scene, joint: usize) -> Vec<Candidate> {
    if scene.dof() > 1 {
        all(scene, vec![joint], &OWN)
    } else {
        Vec::new()
    }
}

/// How a joint's torque changes where it is early or late by about an interval, or several: what any lateness of its own is
/// made of.
pub fn changes(scene: &Scene, joint: usize) -> Vec<Array1<f64>> {
    let step = scene.scale.step;
    let shifts = [-3.0, -1.0, 1.0, 3.0, 6.0].map(|s| Late::Shift(s * step));
    let filters = [1.5, 4.0].map(|s| Late::Filter(s * step));
    let each = shifts.into_iter().chain(filters);
    each.map(|late| change(scene, joint, late)).collect()
}

/// How a joint's torque changes where it is late.
fn change(scene: &Scene, joint: usize, late: Late) -> Array1<f64> {
    let own = &scene.rigid.column(joint) + &scene.drive.column(joint);
    match late {
        Late::Shift(delay) => delayed(scene.motion, own.view(), delay) - own,
        Late::Filter(constant) => filtered(scene.motion, own.view(), constant) - own,
    }
}

fn all(scene: &Scene, joints: Vec<usize>, shifts: &[f64]) -> Vec<Candidate> {
    let step = scene.scale.step;
    let shifts = shifts.iter().map(|s| Late::Shift(s * step));
    let filters = LAGS.iter().map(|s| Late::Filter(s * step));
    let one = |late| candidate(joints.clone(), late);
    shifts.chain(filters).map(one).collect()
}

fn candidate(joints: Vec<usize>, late: Late) -> Candidate {
    let of = joints.clone();
    let column = Column::several(joints.clone(), move |s| {
        of.iter().map(|&j| change(s, j, late)).collect()
    });
    let joint = joints.first().copied().filter(|_| joints.len() == 1);
    let (Late::Shift(delay) | Late::Filter(delay)) = late;
    let corner = match late {
        Late::Shift(_) => None,
        Late::Filter(constant) => Some(("corner", 1.0 / (std::f64::consts::TAU * constant), "Hz")),
    };
    Candidate {
        effect: Effect::TimeDelay,
        joints,
        driver: None,
        columns: vec![column],
        bounds: vec![Bound::Between(0.6, 1.6)],
        quantities: vec![Quantity::scaled("delay", "s", joint, delay)],
        shape: corner.into_iter().collect(),
        change: None,
        evidence: 0.0,
    }
}

/// x behind a first-order filter, T·ẏ + y = x, settled at the start of each segment; x is taken as linear between samples.
fn filtered(motion: &Motion, x: ArrayView1<f64>, constant: f64) -> Array1<f64> {
    let time = &motion.time;
    let mut out = x.to_owned();
    for s in &motion.segments {
        for i in s.start + 1..s.end {
            let h = (time[i] - time[i - 1]) / constant;
            let kept = (-h).exp();
            // Behind a ramp of slope r the filter settles r·T late.
            let slope = (x[i] - x[i - 1]) / h;
            out[i] = x[i] - slope + (out[i - 1] - x[i - 1] + slope) * kept;
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array2;

    #[test]
    fn both_are_late_by_the_delay_and_only_the_filter_rounds() {
        let n = 500;
        let rest = Array2::zeros((n, 1));
        let motion = Motion {
            time: (0..n).map(|i| 0.004 * i as f64).collect(),
            q: rest.clone(),
            qd: rest.clone(),
            qdd: rest,
            segments: std::iter::once(0..n).collect(),
        };
        let ramp = Array1::from_shape_fn(n, |i| 3.0 * 0.004 * i as f64);
        let jump = Array1::from_shape_fn(n, |i| if i < 250 { -1.0 } else { 1.0 });
        let delay = 0.02;
        let both = [delayed, filtered].map(|f| {
            (
                f(&motion, ramp.view(), delay),
                f(&motion, jump.view(), delay),
            )
        });
        for (late, _) in &both {
            assert!((ramp[n - 1] - late[n - 1] - 3.0 * delay).abs() < 1e-9);
        }
        let between = |x: &Array1<f64>| x.iter().filter(|x| x.abs() < 0.99).count();
        assert!(between(&both[0].1) <= 1 && between(&both[1].1) > 20);
    }
}
