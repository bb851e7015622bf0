//! Friction in steady motion.

use datasets::metrics::REST;
use physics::effects::{Sample, Term, TermBank};
use signal::Motion;
use signal::quantile::quantile;

/// Quantile of a joint's speeds that is taken as its top speed.
const TOP: f64 = 0.99;
/// Simulation of steady motion: time until friction memory has settled, time over which torque is then averaged, and step, s.
const STEADY: [f64; 3] = [2.0, 2.0, 0.002];
/// Number of speeds at which friction is looked at, evenly spaced in their logarithm from rest to the top speed.
const SPEEDS: usize = 12;

/// Top speed of a joint, rad/s (m/s); none where it rests.
pub(crate) fn top_speed<'a>(
    motions: impl IntoIterator<Item = &'a Motion>,
    joint: usize,
) -> Option<f64> {
    let of = |m: &Motion| {
        m.qd.column(joint)
            .iter()
            .map(|v| v.abs())
            .collect::<Vec<_>>()
    };
    quantile(motions.into_iter().flat_map(of).collect(), TOP).filter(|v| *v > REST)
}

/// Half the difference of a joint's torque in steady motion forwards and backwards at `speed`, N·m (N). `list` are its terms with their
/// parameters.
pub(crate) fn steady(list: &[(Term, f64)], joint: usize, joints: usize, speed: f64) -> f64 {
    let [settle, average, dt] = STEADY;
    let (rows, from) = (((settle + average) / dt) as usize, (settle / dt) as usize);
    let zeros = vec![0.0; joints];
    let torque = |direction: f64| {
        let mut bank = TermBank::new(joint, list.iter().map(|w| w.0.clone()).collect());
        let (mut q, mut qd) = (zeros.clone(), zeros.clone());
        let mut values = vec![0.0; list.len()];
        qd[joint] = direction * speed;
        let mut sum = 0.0;
        for row in 0..rows {
            q[joint] = direction * speed * dt * row as f64;
            let sample = Sample {
                clock: None,
                dt: if row == 0 { 0.0 } else { dt },
                q: &q,
                qd: &qd,
                qdd: &zeros,
                load: &zeros,
            };
            bank.step(&sample, &mut values);
            if row >= from {
                let friction = list.iter().zip(&values);
                sum += friction
                    .filter(|((term, _), _)| term.passive().is_none())
                    .map(|((_, value), v)| value * v)
                    .sum::<f64>();
            }
        }
        sum / (rows - from) as f64
    };
    0.5 * (torque(1.0) - torque(-1.0))
}

/// Index of a friction shape, beyond the first `kept` terms of `list`, without which a joint's friction resists better: with it
/// friction would push with the motion at some speed up to `top`, rad/s (m/s). Speeds that a recording only passes through leave the
/// friction there open. None where friction resists at all of them.
pub(crate) fn pushing(
    list: &[(Term, f64)],
    kept: usize,
    (joint, joints): (usize, usize),
    top: f64,
) -> Option<usize> {
    let shapes: Vec<usize> = (kept..list.len())
        .filter(|&k| list[k].0.is_friction())
        .collect();
    if shapes.is_empty() {
        return None;
    }
    let friction: Vec<(Term, f64)> = list.iter().filter(|w| w.0.is_friction()).cloned().collect();
    let speed = |k: usize| REST * (top / REST).powf(k as f64 / (SPEEDS - 1) as f64);
    let (least, at) = (0..SPEEDS)
        .map(|k| (steady(&friction, joint, joints, speed(k)), speed(k)))
        .min_by(|a, b| a.0.total_cmp(&b.0))?;
    if least >= 0.0 {
        return None;
    }
    let own = |k: &usize| steady(&list[*k..=*k], joint, joints, at);
    shapes.into_iter().min_by(|a, b| own(a).total_cmp(&own(b)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use physics::effects::Sliding;

    /// Coulomb friction of 15 N·m with Stribeck's of −31 N·m pushes at low speed, with one of −10 N·m it does not.
    #[test]
    fn friction_that_pushes_is_found() {
        let list = |stribeck: f64| {
            vec![
                (Term::Sliding(Sliding::Viscous), 5.0),
                (Term::Sliding(Sliding::Coulomb), 15.0),
                (
                    Term::Sliding(Sliding::Stribeck { velocity: 0.01 }),
                    stribeck,
                ),
            ]
        };
        assert_eq!(pushing(&list(-31.0), 2, (0, 1), 1.0), Some(2));
        assert_eq!(pushing(&list(-10.0), 2, (0, 1), 1.0), None);
        assert_eq!(pushing(&list(31.0), 2, (0, 1), 1.0), None);
    }
}
