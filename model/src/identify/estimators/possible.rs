//! Links constrained to possible bodies, with friction terms beside them.

use super::solution::offsets;
use crate::identify::error::IdentifyError;
use ::identify::base::BaseParameters;
use ::identify::feasible::{Constraints, Feasibility, Feasible, Nominal};
use ::identify::least_squares::Triangle;
use faer::Mat;
use physics::effects::{Sliding, Term};
use physics::robot::{PARAMETERS_PER_LINK, Robot};

/// Bound of a term: multiple of the size at which it alone would explain the whole torque.
const GENEROUS: f64 = 10.0;

/// Condition on base parameters and terms: possible links and no negative rotor inertia. Viscous and Coulomb
/// friction must not be negative, where no other term shares a joint's friction with them. `triangle` gives the
/// terms' scale.
pub(super) fn condition(
    robot: &Robot,
    base: &BaseParameters,
    terms: &[Vec<Term>],
    triangle: &Triangle,
) -> Result<Feasibility, IdentifyError> {
    let rigid = PARAMETERS_PER_LINK * robot.dof();
    let (firsts, total) = offsets(base.len(), terms);
    let extra = total - base.len();
    let grouping = Mat::from_fn(total, rigid + extra, |i, j| {
        if i < base.len() {
            if j < rigid {
                base.grouping()[(i, j)]
            } else {
                0.0
            }
        } else {
            f64::from(u8::from(j == rigid + i - base.len()))
        }
    });
    let target = triangle.target_sum_of_squares().sqrt();
    let extras: Vec<(f64, f64)> = (base.len()..total)
        .map(|c| {
            let norm = triangle.r().col(c).norm_l2();
            (
                0.0,
                if norm > 0.0 {
                    GENEROUS * target / norm
                } else {
                    1.0
                },
            )
        })
        .collect();
    let mut nonnegative = Vec::new();
    for (list, first) in terms.iter().zip(firsts) {
        let plain = is_plain(list);
        for (k, term) in list.iter().enumerate() {
            if *term == Term::RotorInertia || plain && matches!(term, Term::Sliding(_)) {
                nonnegative.push(rigid + first + k - base.len());
            }
        }
    }
    Ok(Feasibility::new(
        grouping.as_ref(),
        Constraints::new(robot.dof(), nonnegative),
        Nominal::of_robot(robot, &extras),
    )?)
}

/// Estimate with possible links from the same rows.
///
/// # Errors
/// A system that cannot be solved.
pub fn constrained(
    robot: &Robot,
    base: &BaseParameters,
    terms: &[Vec<Term>],
    triangle: &Triangle,
    sigma2: f64,
) -> Result<Feasible, IdentifyError> {
    Ok(condition(robot, base, terms, triangle)?.fit(triangle, sigma2)?)
}

/// Whether a joint's friction is viscous (or a power of speed), Coulomb and offset alone.
pub(super) fn is_plain(terms: &[Term]) -> bool {
    terms.iter().all(|t| {
        matches!(
            t,
            Term::Offset
                | Term::RotorInertia
                | Term::EarlySign(_)
                | Term::Sliding(
                    Sliding::Viscous
                        | Sliding::Coulomb
                        | Sliding::SoftCoulomb { .. }
                        | Sliding::Power { .. }
                )
        )
    })
}
