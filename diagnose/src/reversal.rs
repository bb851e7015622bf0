//! What the recording itself says of how its motion is to be seen: the cut-off of the low-pass, and how sharply
//! each joint's friction turns round.
//!
//! Too low a cut-off takes real acceleration away, too high a one lets noise in; friction jumps where the filtered
//! velocity changes its sign, but noise turns that sign at random, a real contact bends before it slides, and both
//! round the jump. Neither is known beforehand, and both show as error that no parameter removes.

use crate::analysis::{MOST_CUTOFF, fresh};
use crate::cholesky::Cholesky;
use crate::error::DiagnoseError;
use crate::frame::Frame;
use crate::model::NominalModel;
use crate::scene::{SOFT_SIGN, rigid_torque};
use datasets::Recording;
use ndarray::{Array1, Array2};

/// Cut-offs tried for the motion, Hz, beside the one that its noise suggests.
const CUTOFFS: [f64; 4] = [15.0, 20.0, 27.0, 40.0];
/// Velocities tried below which the sign of a motion is softened, rad/s (m/s); the contract allows up to 0.005.
const SOFTNESSES: [f64; 6] = [0.0004, 0.0007, 0.0012, 0.002, 0.0032, 0.005];
/// Trajectories that they are tried on.
const TRAJECTORIES: usize = 4;
/// Part of the error that a softness must save over [`SOFT_SIGN`] to be taken.
const WORTH: f64 = 0.02;

/// How motion is to be filtered and its sign softened.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// Cut-off of the low-pass, Hz; none where a recording is interpolated as it is.
    pub cutoff_hz: Option<f64>,
    /// Velocity below which the sign is softened, per joint, rad/s (m/s).
    pub softness: Vec<f64>,
}

/// Chooses the view on some trajectories spread over a recording: the one that leaves least error beyond a scaled
/// model, viscous and Coulomb friction, own inertia and gravity of each joint.
///
/// With `given`, the cut-off is that, in Hz, and only the softness is chosen.
///
/// # Errors
/// A recording without torque, or one that cannot be prepared.
pub fn choose(
    model: &NominalModel,
    data: &Recording,
    given: Option<f64>,
) -> Result<View, DiagnoseError> {
    let n = data.trajectories.len();
    let few = n.min(TRAJECTORIES);
    let spread: Vec<usize> = (0..few).map(|i| i * n / few).collect();
    let sample = data.select(&spread);
    let first = fresh(&sample, given)?;
    if given.is_some() {
        return Ok(View {
            cutoff_hz: given,
            softness: seen(model, &first).1,
        });
    }
    let Some(automatic) = first.report().cutoff_hz else {
        let softness = seen(model, &first).1;
        return Ok(View {
            cutoff_hz: None,
            softness,
        });
    };
    let rate = first.report().rate_hz;
    let most = CUTOFFS[CUTOFFS.len() - 1].min(MOST_CUTOFF * rate);
    let options = CUTOFFS
        .into_iter()
        .filter(|c| *c < most)
        .chain([automatic.min(most), most]);
    let mut best: Option<(f64, f64, Vec<f64>)> = None;
    for cutoff in options {
        let Ok(frame) = fresh(&sample, Some(cutoff)) else {
            continue;
        };
        let (error, softness) = seen(model, &frame);
        if best.as_ref().is_none_or(|b| error < b.1) {
            best = Some((cutoff, error, softness));
        }
    }
    let (cutoff, softness) = best.map_or_else(
        || (automatic, vec![SOFT_SIGN; data.q.ncols()]),
        |b| (b.0, b.2),
    );
    Ok(View {
        cutoff_hz: Some(cutoff),
        softness,
    })
}

/// Sum over joints of the relative squared error under each joint's best softness, and these.
fn seen(model: &NominalModel, frame: &Frame) -> (f64, Vec<f64>) {
    let m = frame.motion();
    let rigid = frame.table_to_samples(&rigid_torque(&model.robot, &m.q, &m.qd, &m.qdd));
    let at = frame.samples();
    let mut sum = 0.0;
    let mut softness = Vec::with_capacity(frame.dof());
    for j in 0..frame.dof() {
        let tau = frame.tau.column(j);
        let q = at.q.column(j);
        let smooth = [
            rigid.column(j).to_owned(),
            at.qd.column(j).to_owned(),
            at.qdd.column(j).to_owned(),
            q.mapv(f64::sin),
            q.mapv(f64::cos),
            Array1::ones(q.len()),
        ];
        let error = |soft: f64| {
            let sign = m.qd.column(j).mapv(|v| (v / soft).tanh());
            left(
                &smooth,
                &Array1::from(frame.to_samples(&sign)),
                &tau.to_owned(),
            )
        };
        let usual = error(SOFT_SIGN);
        let best = SOFTNESSES
            .into_iter()
            .map(|s| (s, error(s)))
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .filter(|(_, e)| *e < (1.0 - WORTH) * usual);
        let (soft, error) = best.unwrap_or((SOFT_SIGN, usual));
        softness.push(soft);
        sum += error / tau.var(0.0).max(1e-12) / tau.len().max(1) as f64;
    }
    (sum, softness)
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
