//! Friction of flexible shape, linear in its parameters, for the comparison of cut-offs.
//!
//! Cut-offs can be compared only where the other parts of the model are right: under a sign that is too soft
//! for a joint the errors of all cut-offs are alike. So the sign is a sum of soft ones, and friction may grow
//! with the square of the speed and build up over a displacement after a reversal. No terms are selected.
//! Parameters that little motion leaves undetermined are held by a weak prior.

use crate::identify::basic;
use crate::identify::design::JointSystem;
use crate::identify::shrinkage::CORRELATED;
use ::identify::least_squares::{Gram, LeastSquaresError, Triangle};
use ndarray::{Array1, Array2};
use physics::effects::{Sliding, Stop, Term};
use physics::robot::Robot;

/// Velocities of softening of the signs, rad/s or m/s.
const SOFTNESSES: [f64; 3] = [0.004, 0.02, 0.1];
/// Displacements over which friction builds up, rad or m: 0.05° and 0.5°.
const WIDTHS: [f64; 2] = [8.7e-4, 8.7e-3];

/// Terms of each joint for the comparison.
pub(super) fn terms(robot: &Robot) -> Vec<Vec<Term>> {
    let all = basic::terms(robot).into_iter();
    all.map(|list| {
        let others = list
            .into_iter()
            .filter(|t| *t != Term::Sliding(Sliding::Coulomb));
        others.chain(shapes()).collect()
    })
    .collect()
}

fn shapes() -> impl Iterator<Item = Term> {
    let soft = SOFTNESSES.map(|velocity| Term::Sliding(Sliding::SoftCoulomb { velocity }));
    let grows = Term::Sliding(Sliding::Power { exponent: 2.0 });
    let builds_up = WIDTHS.map(|width| Term::Stop(Stop { width }));
    soft.into_iter().chain([grows]).chain(builds_up)
}

/// Prior as rows of unit standard deviation over `total` parameters: each shape's torque has the size of the
/// joint's torque. `offsets`: index of the first parameter of each joint's terms; `rate_hz`: rate of the rows,
/// Hz.
pub(super) fn prior(
    systems: &[JointSystem],
    offsets: &[usize],
    total: usize,
    rate_hz: f64,
) -> Result<Gram, LeastSquaresError> {
    let weight = (CORRELATED * rate_hz).max(1.0).sqrt();
    let mut places = Vec::new();
    for (system, &offset) in systems.iter().zip(offsets) {
        let mut sum = Gram::from(&Triangle::empty(system.columns()));
        for cell in system.grams() {
            sum = sum.plus(&cell)?;
        }
        let deviation = system.target_deviation();
        // A dead channel tells of no shape.
        if deviation <= f64::MIN_POSITIVE {
            continue;
        }
        let terms = system.columns() - system.rigid();
        for term in terms - shapes().count()..terms {
            let size = sum.rms(system.rigid() + term)? / deviation;
            if size.is_finite() {
                places.push((offset + term, weight * size));
            }
        }
    }
    let mut rows = Array2::zeros((places.len(), total));
    for (row, (column, size)) in places.into_iter().enumerate() {
        rows[[row, column]] = size;
    }
    let none = Array1::zeros(rows.nrows());
    Ok(Gram::from(&Triangle::of(rows.view(), none.view())?))
}
