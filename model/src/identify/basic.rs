//! The basic model of a joint: rigid body, offset, viscous and Coulomb friction, rotor inertia.

use crate::identify::design::{Data, JointSystem};
use crate::identify::dictionary;
use crate::identify::estimators;
use crate::identify::out_of_fold::OutOfFold;
use crate::identify::selection::{FoldGrams, ForwardOptions};
use crate::identify::shrinkage::{self, GivenInertias};
use ::identify::base::{BaseParameters, Extra};
use ::identify::least_squares::LeastSquaresError;
use ndarray::Array2;
use physics::effects::{Sliding, Term};
use physics::robot::{PARAMETERS_PER_LINK, Robot};
use rayon::prelude::*;

/// Velocities of softening of the sign that are tried, rad/s or m/s. Smooth velocities suit a true sign; noise,
/// encoder counts and the low-pass soften it.
const SOFTNESSES: [f64; 6] = [0.002, 0.005, 0.01, 0.02, 0.05, 0.1];

/// Basic terms of each joint, with a true sign. They include rotor inertia where the rigid body does not contain it.
pub fn terms(robot: &Robot) -> Vec<Vec<Term>> {
    let with_rotors = BaseParameters::of_robot(robot, &[Extra::RotorInertia]);
    let rigid = PARAMETERS_PER_LINK * robot.dof();
    (0..robot.dof())
        .map(|joint| {
            let mut terms = dictionary::basic();
            if with_rotors.independent().contains(&(rigid + joint)) {
                terms.push(Term::RotorInertia);
            }
            terms
        })
        .collect()
}

/// Softens each joint's sign where that lowers the error on rows left out by more than chance.
///
/// # Errors
/// Columns that are not finite.
pub fn with_signs(
    data: &Data,
    basic: Vec<Vec<Term>>,
    load: &[Array2<f64>],
    options: &ForwardOptions,
) -> Result<Vec<Vec<Term>>, LeastSquaresError> {
    let soft = SOFTNESSES.map(|velocity| Term::Sliding(Sliding::SoftCoulomb { velocity }));
    basic
        .into_par_iter()
        .enumerate()
        .map(|(joint, mut list)| {
            let Some(sign) = list
                .iter()
                .position(|t| *t == Term::Sliding(Sliding::Coulomb))
            else {
                return Ok(list);
            };
            let all: Vec<Term> = list.iter().cloned().chain(soft.clone()).collect();
            let system = JointSystem::new(data, joint, &all, load, false)?;
            if system.rows() == 0 {
                return Ok(list);
            }
            let folds = FoldGrams::new(&system.grams(), &data.target.folds)?;
            if folds.is_empty() {
                return Ok(list);
            }
            let own = list.len();
            let errors = |column: usize| {
                let mut columns: Vec<usize> = (0..system.rigid() + own).collect();
                columns[system.rigid() + sign] = column;
                folds.errors(&columns, options.ridge)
            };
            let Some(mut best) = errors(system.rigid() + sign)? else {
                return Ok(list);
            };
            for (k, term) in soft.iter().enumerate() {
                let Some(tried) = errors(system.rigid() + own + k)? else {
                    continue;
                };
                if options.falls(&best, &tried) {
                    best = tried;
                    list[sign] = term.clone();
                }
            }
            Ok(list)
        })
        .collect()
}

/// Prior from the given inertias for a fit of the basic model, with its strength chosen on rows left out.
///
/// # Errors
/// Columns that are not finite.
pub fn given_inertias(
    data: &Data,
    basic: &[Vec<Term>],
    load: &[Array2<f64>],
) -> Result<Option<GivenInertias>, LeastSquaresError> {
    let systems = data.systems(basic, load, false)?;
    let (offsets, total) = estimators::offsets(data.base.len(), basic);
    let fits = OutOfFold::new(&systems, &offsets, total, &data.target.folds)?;
    let deviation: Vec<f64> = systems.iter().map(JointSystem::target_deviation).collect();
    let rate = data.session.parts[0].report.rate_hz / data.every as f64;
    shrinkage::choose(data.robot, data.base, &fits, total, &deviation, rate)
}
