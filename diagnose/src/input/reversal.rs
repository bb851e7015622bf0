//! How sharply each joint's friction turns round, from the recording itself.
//!
//! Friction jumps where the filtered velocity changes its sign, but noise turns that sign at random, a real contact bends
//! before it slides, and both round the jump: error that no parameter removes.

use crate::algebra::cholesky::Cholesky;
use crate::motion::frame::Frame;
use crate::motion::rigid::rigid_torque;
use crate::motion::scene::SOFT_SIGN;
use crate::settings::InputSettings;
use crate::simulator::NominalModel;
use ndarray::{Array1, Array2, ArrayView1, Axis};

/// Velocities tried below which the sign of a motion is softened, rad/s (m/s); docs/formats.md allows up to 0.005.
const SOFTNESSES: [f64; 6] = [0.0004, 0.0007, 0.0012, 0.002, 0.0032, 0.005];

/// Velocity below which each joint's sign is softened, rad/s (m/s): the one that leaves least error beyond a scaled model,
/// viscous and Coulomb friction, own inertia and gravity of the joint, on some of the trajectories; [`SOFT_SIGN`] where none
/// saves enough over it.
pub fn softness(
    model: &NominalModel,
    frame: &Frame,
    trajectories: &[usize],
    settings: &InputSettings,
) -> Vec<f64> {
    let m = frame.motion();
    let rigid = frame.table_to_samples(&rigid_torque(&model.robot, &m.q, &m.qd, &m.qdd));
    let at = frame.samples();
    let rows: Vec<usize> = trajectories
        .iter()
        .filter_map(|&t| at.segments.get(t).cloned())
        .flatten()
        .collect();
    let some = |x: ArrayView1<f64>| x.select(Axis(0), &rows);
    (0..frame.dof())
        .map(|j| {
            let tau = some(frame.tau.column(j));
            let q = some(at.q.column(j));
            let smooth = [
                some(rigid.column(j)),
                some(at.qd.column(j)),
                some(at.qdd.column(j)),
                q.mapv(f64::sin),
                q.mapv(f64::cos),
                Array1::ones(q.len()),
            ];
            let error = |soft: f64| {
                let sign = m.qd.column(j).mapv(|v| (v / soft).tanh());
                let sign = Array1::from(frame.to_samples(&sign));
                left(&smooth, &some(sign.view()), &tau)
            };
            let usual = error(SOFT_SIGN);
            SOFTNESSES
                .into_iter()
                .map(|s| (s, error(s)))
                .min_by(|a, b| a.1.total_cmp(&b.1))
                .filter(|(_, e)| *e < (1.0 - settings.softness) * usual)
                .map_or(SOFT_SIGN, |b| b.0)
        })
        .collect()
}

/// Squared error of a least-squares fit of some columns and one more.
fn left(smooth: &[Array1<f64>], last: &Array1<f64>, y: &Array1<f64>) -> f64 {
    let columns: Vec<&Array1<f64>> = smooth.iter().chain([last]).collect();
    let k = columns.len();
    let mut a = Array2::from_shape_fn((k, k), |(i, j)| columns[i].dot(columns[j]));
    for i in 0..k {
        a[[i, i]] *= 1.0 + 1e-9;
        a[[i, i]] += f64::MIN_POSITIVE;
    }
    let b: Array1<f64> = columns.iter().map(|c| c.dot(y)).collect();
    let x = Cholesky::new(&a).solve(b.view());
    (y.dot(y) - x.dot(&b)).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn least_squares_by_hand() {
        // y = 2 + 3 x leaves nothing; without the slope, 9·(1 + 0 + 1).
        let (one, x) = (Array1::ones(3), Array1::from(vec![-1.0, 0.0, 1.0]));
        let y = &one * 2.0 + &x * 3.0;
        assert!(left(std::slice::from_ref(&one), &x, &y) < 1e-6);
        assert!((left(std::slice::from_ref(&one), &one, &y) - 18.0).abs() < 1e-6);
    }
}
