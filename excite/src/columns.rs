//! The linear model that a motion is judged by, and the noise of its torque.

use crate::arguments::Column;
use identify::base::{BaseParameters, Extra};
use identify::excitation::{BaseRows, MotionLimits, State, torque};
use identify::least_squares::{Accumulator, LeastSquaresError, Triangle};
use physics::dynamics::Workspace;
use physics::robot::Robot;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use signal::Motion;

/// Largest number of rows of a motion that are judged, per joint.
const MOST_ROWS: usize = 20_000;

/// The columns asked for, in the order of the regressor; all where none are.
pub fn extras(columns: &[Column]) -> Vec<Extra> {
    let order = [
        (Column::Rotor, Extra::RotorInertia),
        (Column::Viscous, Extra::Viscous),
        (Column::Coulomb, Extra::Coulomb),
        (Column::Offset, Extra::Offset),
    ];
    let wanted = order
        .into_iter()
        .filter(|(c, _)| columns.is_empty() || columns.contains(c));
    wanted.map(|(_, e)| e).collect()
}

/// Values of the base parameters in a described robot.
pub fn values(robot: &Robot, base: &BaseParameters, extras: &[Extra]) -> Vec<f64> {
    let mut all = robot.parameters();
    for extra in extras {
        all.extend(robot.joints().iter().map(|j| match extra {
            Extra::RotorInertia => j.rotor_inertia,
            Extra::Viscous => j.damping,
            Extra::Coulomb => j.friction,
            Extra::Offset => 0.0,
        }));
    }
    base.base_from(&all)
}

/// Triangular factor of a motion's rows, each divided by its joint's `noise`, and the number of samples per row.
///
/// # Errors
/// Numbers that are not finite.
pub fn triangle(
    rows: &BaseRows,
    motion: &Motion,
    noise: &[f64],
) -> Result<(Triangle, f64), LeastSquaresError> {
    let mut rows = rows.clone();
    let (n, p) = (motion.dof(), rows.columns());
    let every = motion.len().div_ceil(MOST_ROWS).max(1);
    let mut sum = Accumulator::new(p);
    let mut block = vec![0.0; n * p];
    let mut used = 0;
    for i in (0..motion.len()).step_by(every) {
        let row = |t: &ndarray::Array2<f64>| t.row(i).to_vec();
        rows.fill(
            &row(&motion.q),
            &row(&motion.qd),
            &row(&motion.qdd),
            &mut block,
        );
        for (row, noise) in block.chunks_exact(p).zip(noise) {
            sum.push(row, 0.0, 1.0 / noise)?;
        }
        used += 1;
    }
    Ok((sum.finish()?, motion.len() as f64 / f64::from(used.max(1))))
}

/// A hundredth of the torque's root mean square over random states within the limits, N·m, by joint; at least a thousandth of
/// the strongest joint's.
pub fn usual_noise(robot: &Robot, limits: &[MotionLimits]) -> Vec<f64> {
    const STATES: usize = 400;
    const PART: f64 = 0.01;
    let n = robot.dof();
    let mut rng = ChaCha8Rng::seed_from_u64(0);
    let mut workspace = Workspace::new(robot);
    let mut state = State::new(n);
    let (mut tau, mut squares) = (vec![0.0; n], vec![0.0; n]);
    for _ in 0..STATES {
        for (j, l) in limits.iter().enumerate() {
            state.q[j] = rng.random_range(l.lower..l.upper);
            state.qd[j] = 0.5 * l.velocity * rng.random_range(-1.0..1.0);
            state.qdd[j] = 0.5 * l.acceleration * rng.random_range(-1.0..1.0);
        }
        torque(robot, &mut workspace, &state, &mut tau);
        squares.iter_mut().zip(&tau).for_each(|(s, t)| *s += t * t);
    }
    let rms: Vec<f64> = squares.iter().map(|s| (s / STATES as f64).sqrt()).collect();
    let strongest = rms.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    rms.iter().map(|r| PART * r.max(0.1 * strongest)).collect()
}
