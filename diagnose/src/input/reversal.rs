//! Sign of each joint's friction around reversals, from the recording itself.
//!
//! Friction jumps where the filtered velocity changes its sign. Noise turns that sign at random, and a real
//! contact bends before it slides: both round the jump and leave an error that no parameter removes. A
//! simulator's friction may reverse early.

use crate::algebra::cholesky::Cholesky;
use crate::motion::channel::Channel;
use crate::motion::delay::delayed;
use crate::motion::frame::Frame;
use crate::motion::scene::SOFT_SIGN;
use crate::settings::InputSettings;
use crate::simulator::NominalModel;
use ndarray::{Array1, Array2, ArrayView1, Axis, Zip};
use physics::batch::rigid_torque;
use physics::effects::EarlySign;
use rayon::prelude::*;

/// Velocities of softening that are tried, rad/s (m/s); docs/formats.md allows up to 0.005.
const SOFTNESSES: [f64; 6] = [0.0004, 0.0007, 0.0012, 0.002, 0.0032, 0.005];

/// Velocities of softening that are tried with a lead, rad/s (m/s): a constraint that simulates friction is as
/// soft as its impedance.
const WITH_LEAD: [f64; 6] = [0.0007, 0.002, 0.005, 0.01, 0.02, 0.04];

/// Leads that are tried, s: friction reverses early, or all torque is early instead.
const LEADS: [f64; 6] = [0.001, 0.003, 0.006, 0.01, 0.015, 0.02];

/// Sign of each joint's Coulomb friction. Its velocity of softening, rad/s (m/s), is the one with the least
/// error on some of the trajectories beside a scaled model, viscous and Coulomb friction, own inertia and
/// gravity of the joint. It is [`SOFT_SIGN`] where none removes enough error over it. A lead is taken where it
/// removes enough error over a sign that is as soft, and over all joints more than an early torque as a whole.
/// All columns are delayed by `channel`.
pub fn signs(
    model: &NominalModel,
    frame: &Frame,
    trajectories: &[usize],
    channel: Option<&Channel>,
    settings: &InputSettings,
) -> Vec<EarlySign> {
    let m = frame.motion();
    let rigid = rigid_torque(&model.robot, &m.q, &m.qd, &m.qdd);
    let at = frame.samples();
    let rows: Vec<usize> = trajectories
        .iter()
        .filter_map(|&t| at.segments.get(t).cloned())
        .flatten()
        .collect();
    let some = |x: ArrayView1<f64>| x.select(Axis(0), &rows);
    let one = |joint: usize| {
        let tau = some(frame.tau.column(joint));
        let [q, qd, qdd] = [&m.q, &m.qd, &m.qdd].map(|t| t.column(joint));
        let smooth = [
            rigid.column(joint).to_owned(),
            qd.to_owned(),
            qdd.to_owned(),
            q.mapv(f64::sin),
            q.mapv(f64::cos),
        ];
        let rows = |fine: &Array1<f64>| {
            let late = channel.map(|c| c.recorded(m, joint, fine.view()));
            some(Array1::from(frame.to_samples(late.as_ref().unwrap_or(fine))).view())
        };
        let columns = |late: f64| -> Vec<Array1<f64>> {
            let moved = |x: &Array1<f64>| match late {
                0.0 => rows(x),
                late => rows(&delayed(m, x.view(), late)),
            };
            let ones = Array1::ones(tau.len());
            smooth.iter().map(moved).chain([ones]).collect()
        };
        let sign = |own: EarlySign, qd: &Array1<f64>, qdd: &Array1<f64>| {
            let mut sign = Array1::zeros(qd.len());
            let each = Zip::from(&mut sign).and(qd).and(qdd);
            each.for_each(|s, &qd, &qdd| *s = own.at(qd, qdd));
            rows(&sign)
        };
        let now = columns(0.0);
        let error = |own: EarlySign| left(&now, &sign(own, &smooth[1], &smooth[2]), &tau);
        let plain = |velocity: f64| EarlySign {
            velocity,
            lead: 0.0,
        };
        let least = |some: &mut dyn Iterator<Item = EarlySign>| {
            some.map(|s| (s, error(s)))
                .min_by(|a, b| a.1.total_cmp(&b.1))
                .expect("some are tried")
        };
        let enough = 1.0 - settings.softness;
        let usual = (plain(SOFT_SIGN), error(plain(SOFT_SIGN)));
        let softer = least(&mut SOFTNESSES.map(plain).into_iter());
        let best = Some(softer).filter(|(_, e)| *e < enough * usual.1);
        let best = best.unwrap_or(usual);
        let early = LEADS
            .iter()
            .flat_map(|&lead| WITH_LEAD.map(|velocity| EarlySign { velocity, lead }));
        let early = least(&mut { early });
        let as_soft = WITH_LEAD.map(plain);
        let as_a_whole = LEADS.iter().flat_map(|lead| {
            let now = columns(-lead);
            let [qd, qdd] = [qd, qdd].map(|x| delayed(m, x, -lead));
            as_soft.map(|own| left(&now, &sign(own, &qd, &qdd), &tau))
        });
        let at_once = as_soft.map(error).into_iter().fold(best.1, f64::min);
        Turn {
            best: best.0,
            at_once,
            early,
            as_a_whole: as_a_whole.fold(at_once, f64::min),
        }
    };
    let turns: Vec<Turn> = (0..frame.dof()).into_par_iter().map(one).collect();
    // What makes friction early, or torque, is no matter of one joint: where a joint cannot tell them apart others do.
    let enough = 1.0 - settings.softness;
    let over_whole = |t: &Turn| (t.early.1 / t.as_a_whole).ln();
    let early = turns.iter().map(over_whole).sum::<f64>() < turns.len() as f64 * enough.ln();
    let of = |t: &Turn| match early && t.early.1 < enough * t.at_once {
        true => t.early.0,
        false => t.best,
    };
    turns.iter().map(of).collect()
}

/// Sign of one joint's friction, and the squared errors of the alternatives.
struct Turn {
    /// Best sign of friction without lead.
    best: EarlySign,
    /// Squared error with the best sign without lead.
    at_once: f64,
    /// Best sign of friction with a lead, and its squared error.
    early: (EarlySign, f64),
    /// Least squared error with a torque that is early as a whole, or not at all.
    as_a_whole: f64,
}

/// Squared error of a least-squares fit of the columns `smooth` and one more.
fn left(smooth: &[Array1<f64>], last: &Array1<f64>, y: &Array1<f64>) -> f64 {
    let columns: Vec<&Array1<f64>> = smooth.iter().chain([last]).collect();
    let k = columns.len();
    let a = Array2::from_shape_fn((k, k), |(i, j)| columns[i].dot(columns[j]));
    let b: Array1<f64> = columns.iter().map(|c| c.dot(y)).collect();
    let x = Cholesky::raised(a, 1e-9).solve(b.view());
    (y.dot(y) - x.dot(&b)).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use physics::robot::Robot;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    #[test]
    fn least_squares_by_hand() {
        // y = 2 + 3 x leaves nothing; without the slope, 9·(1 + 0 + 1).
        let (one, x) = (Array1::ones(3), Array1::from(vec![-1.0, 0.0, 1.0]));
        let y = &one * 2.0 + &x * 3.0;
        assert!(left(std::slice::from_ref(&one), &x, &y) < 1e-6);
        assert!((left(std::slice::from_ref(&one), &one, &y) - 18.0).abs() < 1e-6);
    }

    /// A UR5 that moves as sines, with 8 N·m of Coulomb friction that turns round `lead` before the motion, its torque
    /// `early` as a whole, and what is made of it.
    fn of_ur5(lead: f64, early: f64) -> Vec<EarlySign> {
        let robot = Robot::builtin("ur5").unwrap();
        let n = 4000;
        let angle = |j: usize, t: f64, k: i32| {
            let [a, b] =
                [0.31 + 0.05 * j as f64, 0.73 - 0.04 * j as f64].map(|f| f * std::f64::consts::TAU);
            // k-th derivative of 0.4 sin(a t) + 0.2 sin(b t + 1).
            let turn = f64::from(k) * std::f64::consts::FRAC_PI_2;
            0.4 * a.powi(k) * (a * t + turn).sin() + 0.2 * b.powi(k) * (b * t + 1.0 + turn).sin()
        };
        let table = |shift: f64, k: i32| {
            Array2::from_shape_fn((n, robot.dof()), |(i, j)| {
                angle(j, 0.004 * i as f64 + shift, k)
            })
        };
        let [q, qd, qdd] = [0, 1, 2].map(|k| table(early, k));
        let own = EarlySign {
            velocity: 0.01,
            lead,
        };
        let mut tau = rigid_torque(&robot, &q, &qd, &qdd);
        Zip::from(&mut tau)
            .and(&qd)
            .and(&qdd)
            .for_each(|t, &qd, &qdd| *t += 8.0 * own.at(qd, qdd));
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        tau.mapv_inplace(|t| t + rng.random_range(-0.2..0.2));
        let time = (0..n).map(|i| 0.004 * i as f64).collect();
        let recording = datasets::Recording::new("r", time, table(0.0, 0), Some(tau.clone()));
        let options = datasets::PrepareOptions::low_passed(40.0);
        let frame = Frame::new(&recording, tau, &options).unwrap();
        let model = NominalModel::new(robot);
        signs(&model, &frame, &[0], None, &InputSettings::default())
    }

    #[test]
    fn friction_that_is_early_is_told_from_torque_that_is() {
        assert!(of_ur5(0.0, 0.0).iter().all(|s| s.lead == 0.0));
        assert!(of_ur5(0.0, 0.01).iter().all(|s| s.lead == 0.0));
        let early = of_ur5(0.01, 0.0);
        assert!(
            early.iter().all(|s| (s.lead, s.velocity) == (0.01, 0.01)),
            "{early:?}"
        );
    }
}
