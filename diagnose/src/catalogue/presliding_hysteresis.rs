//! `presliding_hysteresis`: friction with memory of displacement, by stop operators (one Maxwell-slip element) and
//! Dahl's state over a grid of widths. The state runs on from one trajectory to the next.
//!
//! Two forms of each: friction on top of the Coulomb friction that the model has, and memory that replaces the
//! jump of that friction (state minus sign). Confounders: Stribeck friction, backlash, a delay.

use super::candidate::{Bound, Candidate, Column, Quantity};
use super::effect::Effect;
use super::info::{Info, Need};
use super::unit::Unit;
use crate::motion::scene::Scene;
use physics::effects::{Dahl, Stop, Term};
use signal::quantile::median;

/// Description of `presliding_hysteresis`: confounders, needs, rules.
pub(super) const INFO: Info = Info {
    name: "presliding_hysteresis",
    plain: "presliding hysteresis",
    confounders: &[
        Effect::FrictionParameters,
        Effect::StribeckFriction,
        Effect::Backlash,
        Effect::JointElasticity,
        Effect::TimeDelay,
    ],
    friction: true,
    least_fraction: 0.06,
    needs: &[Need::Reversals],
    coded: true,
    memory: true,
    ..Info::NEW
};

/// Widths of memory that are tried, relative to the recorded range of the joint. The narrowest are a few steps
/// of an encoder: gears give way by tenths of a milliradian.
const WIDTHS: [f64; 9] = [3e-5, 1e-4, 3e-4, 1e-3, 3e-3, 8e-3, 0.02, 0.05, 0.12];

/// Fewest sampling intervals from a reversal to the end of the width. Memory that ends sooner is the shape of
/// the reversal itself, which no recording shows.
const SEEN: f64 = 1.0;

/// Usual distance that a joint moves within `SEEN` intervals after a reversal, rad (m).
fn least_width(scene: &Scene, joint: usize) -> f64 {
    let m = scene.motion;
    let (qd, qdd) = (m.qd.column(joint), m.qdd.column(joint));
    let inside = m.segments.iter().flat_map(|s| s.start + 1..s.end);
    let turns = inside.filter(|&i| qd[i - 1] * qd[i] < 0.0);
    let turning: Vec<f64> = turns.map(|i| qdd[i].abs()).collect();
    let time = SEEN * scene.scale.step;
    median(turning).map_or(0.0, |a| 0.5 * a * time * time)
}

pub(super) fn candidates(scene: &Scene, joint: usize) -> Vec<Candidate> {
    let least = least_width(scene, joint);
    let (low, high) = scene.scale.range[joint];
    let range = (high - low).max(1e-6);
    let amplitude = || Quantity::plain("hysteresis", Unit::NewtonMetre, Some(joint));
    let single = |width: f64, column: Column| {
        Candidate::single(
            Effect::PreslidingHysteresis,
            joint,
            amplitude(),
            Bound::Positive,
            column,
        )
        .with_shape("width", width, Unit::Rad)
    };
    let mut all = Vec::new();
    let mut elements = Vec::new();
    for width in WIDTHS.map(|w| w * range) {
        if width < least {
            continue;
        }
        let (stop, dahl) = (
            Stop { width },
            Dahl {
                stiffness: 1.0 / width,
            },
        );
        let coulomb = || Term::Sliding(scene.coulomb(joint));
        let whole = |term: Term| Column::term(joint, term);
        // In place of the joint's Coulomb friction.
        let instead = |term: Term| Column::terms(joint, vec![(1.0, term), (-1.0, coulomb())]);
        all.push(single(width, whole(Term::Stop(stop))));
        all.push(single(width, whole(Term::Dahl(dahl))));
        all.push(single(width, instead(Term::Stop(stop))));
        all.push(single(width, instead(Term::Dahl(dahl))));
        // Micro-damping: the rate of the state, as bristles have it.
        let damping = Quantity::plain("micro_damping", Unit::NewtonMetreSecond, Some(joint));
        let damped = single(width, instead(Term::Dahl(dahl)));
        all.push(damped.and(damping, Bound::Free, whole(Term::DahlRate(dahl))));
        elements.push((width, instead(Term::Stop(stop))));
    }
    // A distribution of widths: three neighbouring elements at once.
    for three in elements.windows(3) {
        let mut c = single(three[0].0, three[0].1.clone());
        for (width, element) in &three[1..] {
            c = c.and(amplitude(), Bound::Free, element.clone()).with_shape(
                "width",
                *width,
                Unit::Rad,
            );
        }
        c.bounds = vec![Bound::Free; 3];
        all.push(c);
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::scene::Scale;
    use ndarray::Array2;
    use physics::robot::Robot;
    use signal::Motion;

    /// Narrowest width that is tried on a UR5's first joint, which swings by 1 rad with an amplitude of 4 rad/s².
    fn narrowest(step: f64) -> f64 {
        let robot = Robot::builtin("ur5").unwrap();
        let (n, dof) = ((8.0 / step) as usize, robot.dof());
        let table = |f: &dyn Fn(f64) -> f64| {
            Array2::from_shape_fn((n, dof), |(i, _)| f(2.0 * step * i as f64))
        };
        let motion = Motion {
            time: (0..n).map(|i| step * i as f64).collect(),
            q: table(&f64::sin),
            qd: table(&|x| 2.0 * x.cos()),
            qdd: table(&|x| -4.0 * x.sin()),
            segments: std::iter::once(0..n).collect(),
        };
        let scale = Scale {
            softness: vec![0.01; dof],
            lead: vec![0.0; dof],
            speed: vec![1.0; dof],
            range: vec![(-1.0, 1.0); dof],
            torque: vec![3.0; dof],
            session: (0.0, 8.0),
            step,
            channel: None,
            correlation_rows: None,
        };
        let all = candidates(&Scene::new(&robot, &motion, &scale), 0);
        let widths = all.iter().map(|c| c.shape[0].value);
        widths.fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn what_is_over_within_a_sample_is_not_tried() {
        // 4 rad/s² and one interval: 0.8 mrad at 50 Hz, 0.002 mrad at 1 kHz.
        assert!((narrowest(0.001) - 2.0 * WIDTHS[0]).abs() < 1e-12);
        assert!((narrowest(0.02) - 2.0 * WIDTHS[3]).abs() < 1e-12);
    }
}
