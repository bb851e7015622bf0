//! Least possible error of a model on a case's held-out recording, and the part of an effect that parameters absorb.

use crate::SimulateError;
use datasets::Recording;
use datasets::metrics::{Scope, Scores, ShapeError};
use nalgebra::{DMatrix, DVector};
use ndarray::Array2;
use physics::dynamics::{Workspace, inverse_dynamics, regressor};
use physics::robot::{Robot, RobotError};
use plant::Friction;
use plant::arm::Arm;
use plant::mechanism::soft_sign;
use serde::Serialize;

/// Held-out NRMSE per joint, or its mean, as [`datasets::metrics`] has it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Nrmse<T> {
    /// Error of the simulator's model as given.
    pub as_given: T,
    /// Error of the true plant without the effect.
    pub without_effect: T,
    /// Error of the true plant with the effect.
    pub with_effect: T,
    /// Error that is the torque's noise alone.
    pub noise_floor: T,
}

/// Least error that a model can have on a case, on motion low-passed at `cutoff_hz`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Oracle {
    /// Cut-off of the zero-phase low-pass at which the true model does best, Hz.
    pub cutoff_hz: f64,
    /// Mean figures over joints; null where no joint has a figure.
    pub mean_nrmse: Nrmse<Option<f64>>,
    /// Figures of each joint; null for a joint that never moves.
    pub nrmse: Nrmse<Vec<Option<f64>>>,
}

/// Cut-offs of the motion's low-pass that are tried, Hz.
const CUTOFFS: [f64; 4] = [10.0, 15.0, 25.0, 40.0];
/// Softening of the sign in the model as given, rad/s: the most that docs/formats.md allows.
const GIVEN_EPS: f64 = 0.005;

impl<T> Nrmse<T> {
    fn map<U>(&self, of: impl Fn(&T) -> U) -> Nrmse<U> {
        Nrmse {
            as_given: of(&self.as_given),
            without_effect: of(&self.without_effect),
            with_effect: of(&self.with_effect),
            noise_floor: of(&self.noise_floor),
        }
    }
}

/// Filtered motion of a recording, row after row.
struct Motion {
    q: Vec<f64>,
    qd: Vec<f64>,
    qdd: Vec<f64>,
}

/// Zero-phase fourth-order Butterworth within each trajectory, central differences.
fn smooth(recording: &Recording, rate: f64, cutoff: f64) -> Motion {
    let (rows, n) = recording.q.dim();
    let mut motion = Motion {
        q: vec![0.0; rows * n],
        qd: vec![0.0; rows * n],
        qdd: vec![0.0; rows * n],
    };
    let Ok(sections) = signal::sos::butterworth(4, cutoff, rate) else {
        return motion;
    };
    let step = 1.0 / rate;
    for range in recording.segments() {
        for j in 0..n {
            let raw: Vec<f64> = range.clone().map(|k| recording.q[[k, j]]).collect();
            let q = signal::filter::filtfilt(&sections, &raw);
            let qd = gradient(&q, step);
            let qdd = gradient(&qd, step);
            for (i, k) in range.clone().enumerate() {
                motion.q[k * n + j] = q[i];
                motion.qd[k * n + j] = qd[i];
                motion.qdd[k * n + j] = qdd[i];
            }
        }
    }
    motion
}

/// A table (row after row) through a zero-phase fourth-order Butterworth within each trajectory.
pub fn low_passed(table: &[f64], bounds: &[usize], n: usize, rate: f64, cutoff: f64) -> Vec<f64> {
    let mut out = table.to_vec();
    let Ok(sections) = signal::sos::butterworth(4, cutoff, rate) else {
        return out;
    };
    for w in bounds.windows(2) {
        for j in 0..n {
            let raw: Vec<f64> = (w[0]..w[1]).map(|k| table[k * n + j]).collect();
            let smooth = signal::filter::filtfilt(&sections, &raw);
            (w[0]..w[1])
                .zip(smooth)
                .for_each(|(k, x)| out[k * n + j] = x);
        }
    }
    out
}

/// Central differences, one-sided at the ends.
fn gradient(x: &[f64], step: f64) -> Vec<f64> {
    let last = x.len() - 1;
    let at = |k: usize| {
        let (a, b) = (k.saturating_sub(1), (k + 1).min(last));
        (x[b] - x[a]) / (step * (b - a).max(1) as f64)
    };
    (0..x.len()).map(at).collect()
}

/// Torque of `robot` and a friction law on a motion, row after row.
fn torque(robot: &Robot, motion: &Motion, friction: impl Fn(usize, f64) -> f64) -> Vec<f64> {
    let n = robot.dof();
    let mut workspace = Workspace::new(robot);
    let mut tau = vec![0.0; motion.q.len()];
    let rows = motion
        .q
        .chunks(n)
        .zip(motion.qd.chunks(n))
        .zip(motion.qdd.chunks(n));
    for (((q, qd), qdd), tau) in rows.zip(tau.chunks_mut(n)) {
        inverse_dynamics(robot, &mut workspace, q, qd, qdd, tau);
        for (j, t) in tau.iter_mut().enumerate() {
            *t += friction(j, qd[j]);
        }
    }
    tau
}

/// The oracle on a held-out recording. `effect` is the effect's torque in its rows, `noise` the torque noise;
/// with `smooth_effect` the effect is filtered as the motion is.
///
/// # Errors
/// An arm is not a possible robot; torques of other sizes than the recording.
pub fn oracle(
    nominal: &Arm,
    plant: &Arm,
    held_out: &Recording,
    rate: f64,
    effect: &[f64],
    smooth_effect: bool,
    noise: &[f64],
) -> Result<Oracle, SimulateError> {
    let n = nominal.dof();
    let (given, real) = (nominal.robot()?, plant.robot()?);
    let measured: Vec<f64> = held_out.tau.iter().flatten().copied().collect();
    let table = |of: &dyn Fn(usize) -> f64| {
        Array2::from_shape_fn((measured.len() / n, n), |(row, j)| of(row * n + j))
    };
    let torques = table(&|i| measured[i]);
    let friction = frictions(plant);
    let bounds: Vec<usize> = std::iter::once(0)
        .chain(held_out.segments().iter().map(|s| s.end))
        .collect();
    let at = |cutoff: f64| {
        let smoothed = smooth_effect.then(|| low_passed(effect, &bounds, n, rate, cutoff));
        let effect = smoothed.as_deref().unwrap_or(effect);
        let motion = smooth(held_out, rate, cutoff);
        let without = torque(&real, &motion, |j, v| friction[j].torque(v));
        let as_given = torque(&given, &motion, |j, v| {
            let joint = &nominal.joints[j];
            joint.damping * v + joint.friction * (v / GIVEN_EPS).clamp(-1.0, 1.0)
        });
        let qd = table(&|i| motion.qd[i]);
        let score = |model: &dyn Fn(usize) -> f64| {
            Scores::of(torques.view(), table(model).view(), qd.view(), Scope::All)
        };
        Ok::<_, ShapeError>((
            cutoff,
            Nrmse {
                as_given: score(&|i| as_given[i])?,
                without_effect: score(&|i| without[i])?,
                with_effect: score(&|i| without[i] + effect[i])?,
                noise_floor: score(&|i| measured[i] - noise[i])?,
            },
        ))
    };
    let (mut cutoff_hz, mut scores) = at(CUTOFFS[0])?;
    for cutoff in &CUTOFFS[1..] {
        let (cutoff, other) = at(*cutoff)?;
        if other.with_effect.mean_nrmse < scores.with_effect.mean_nrmse {
            (cutoff_hz, scores) = (cutoff, other);
        }
    }
    Ok(Oracle {
        cutoff_hz,
        mean_nrmse: scores.map(|s| s.mean_nrmse),
        nrmse: scores.map(|s| s.nrmse.clone()),
    })
}

/// Friction of an arm's joints as its plant has it.
pub fn frictions(arm: &Arm) -> Vec<Friction> {
    let joints = arm.joints.iter().zip(&arm.v_eps);
    joints
        .map(|(j, &v_eps)| Friction {
            viscous: j.damping,
            coulomb: j.friction,
            v_eps,
            rest: arm.rest,
        })
        .collect()
}

/// Step in rows between those used for the projection.
const STRIDE: usize = 7;
/// Eigenvalues of the scaled Gram matrix below this share of the largest belong to no base parameter.
const RANK: f64 = 1e-11;

/// Root mean square residual per joint of each effect, N·m, beside rigid-body parameters, Coulomb and viscous
/// friction of all joints. The effects are torques in the rows of the motion. All joints are fitted together
/// with the weights 1/`noise`.
///
/// # Errors
/// The arm is not a possible robot.
pub fn unabsorbed(
    arm: &Arm,
    q: &[f64],
    qd: &[f64],
    qdd: &[f64],
    noise: &[f64],
    effects: &[Vec<f64>],
) -> Result<Vec<Vec<f64>>, RobotError> {
    let robot = arm.robot()?;
    let n = robot.dof();
    let rigid = 10 * n;
    let width = rigid + 2 * n;
    let mut workspace = Workspace::new(&robot);
    let mut y = vec![0.0; n * rigid];
    let samples: Vec<usize> = (0..q.len() / n).step_by(STRIDE).collect();
    let mut columns = DMatrix::<f64>::zeros(width, samples.len() * n);
    for (s, &k) in samples.iter().enumerate() {
        let at = k * n..(k + 1) * n;
        regressor(
            &robot,
            &mut workspace,
            &q[at.clone()],
            &qd[at.clone()],
            &qdd[at],
            &mut y,
        );
        for j in 0..n {
            let mut row = columns.column_mut(s * n + j);
            for (c, value) in y[j * rigid..(j + 1) * rigid].iter().enumerate() {
                row[c] = value / noise[j];
            }
            let v = qd[k * n + j];
            row[rigid + 2 * j] = v / noise[j];
            row[rigid + 2 * j + 1] = soft_sign(v, arm.v_eps[j]) / noise[j];
        }
    }
    let scale =
        DVector::from_iterator(width, columns.row_iter().map(|r| 1.0 / r.norm().max(1e-12)));
    for (mut row, s) in columns.row_iter_mut().zip(scale.iter()) {
        row *= *s;
    }
    let gram = (&columns * columns.transpose()).symmetric_eigen();
    let top = gram.eigenvalues.max();
    let left = effects.iter().map(|effect| {
        let target = DVector::from_fn(samples.len() * n, |i, _| {
            effect[samples[i / n] * n + i % n] / noise[i % n]
        });
        let mut rest = target;
        // Twice: the second pass takes away what rounding in the Gram matrix left.
        for _ in 0..2 {
            let mut in_base = gram.eigenvectors.tr_mul(&(&columns * &rest));
            for (x, value) in in_base.iter_mut().zip(gram.eigenvalues.iter()) {
                *x = if *value > RANK * top { *x / value } else { 0.0 };
            }
            rest -= columns.tr_mul(&(&gram.eigenvectors * in_base));
        }
        (0..n)
            .map(|j| rms(rest.iter().skip(j).step_by(n).map(|r| r * noise[j])))
            .collect()
    });
    Ok(left.collect())
}

/// Root mean square residual per joint of a recording's torque beside rigid-body parameters, Coulomb and
/// viscous friction. The motion is low-passed at `cutoff` Hz.
///
/// # Errors
/// The arm is not a possible robot.
#[cfg(test)]
pub fn left_by_parameters(
    arm: &Arm,
    recording: &Recording,
    rate: f64,
    cutoff: f64,
) -> Result<Vec<f64>, RobotError> {
    let motion = smooth(recording, rate, cutoff);
    let torque: Vec<f64> = recording.tau.iter().flatten().copied().collect();
    let equal = vec![1.0; arm.dof()];
    Ok(unabsorbed(arm, &motion.q, &motion.qd, &motion.qdd, &equal, &[torque])?.remove(0))
}

/// Root mean square of the values `x`; zero where there are none.
pub fn rms(x: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = x.fold((0.0, 0.0), |(s, c), v| (s + v * v, c + 1.0));
    if count == 0.0 {
        0.0
    } else {
        f64::sqrt(sum / count)
    }
}
