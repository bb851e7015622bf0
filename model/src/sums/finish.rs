//! Estimation of the parameters from the sums.

use super::{Sums, SumsError};
use crate::assemble::{Estimated, base_parameters};
use crate::directory::BaseParameter;
use crate::identify::design::JointSystem;
use crate::identify::error::IdentifyError;
use crate::identify::estimators::{EstimatorOptions, offsets, solve_systems};
use ::identify::least_squares::{LeastSquaresError, Triangle};
use datasets::check::STILL;
use physics::torque_model::WeightedTerm;

/// Parameters identified from sums, with their terms.
#[derive(Clone, Debug)]
pub struct Summed {
    /// Base parameters of the rigid body.
    pub base: Vec<BaseParameter>,
    /// Offset, friction and rotor inertia of each joint.
    pub terms: Vec<Vec<WeightedTerm>>,
    /// Standard deviation of each joint's residual, N·m (N).
    pub residual_std: Vec<f64>,
    /// Root mean square of each joint's torque, N·m (N).
    pub torque_rms: Vec<f64>,
    /// Number of parameter combinations that the recordings determine; the others are held near zero.
    pub rank: usize,
}

impl Sums {
    /// Identified parameters: rows weighted by each joint's residual deviation, standard deviations by leaving
    /// stretches of time out, as `train --basic` estimates them.
    ///
    /// # Errors
    /// No joint moves in any recording, or a system that cannot be solved.
    pub fn finish(&self) -> Result<Summed, SumsError> {
        if !self.span.iter().any(|[low, high]| high - low >= STILL) {
            return Err(IdentifyError::NothingMoves.into());
        }
        let systems: Vec<JointSystem> = (0..self.columns.robot.dof())
            .map(|joint| {
                let own = self.places.values().map(|joints| joints[joint].clone());
                let blocks: Vec<Triangle> = own.collect();
                JointSystem::of_blocks(
                    self.columns.acting(joint),
                    self.columns.terms[joint].len(),
                    &blocks,
                )
            })
            .collect::<Result<_, LeastSquaresError>>()?;
        let solution = solve_systems(
            (&self.columns.robot, &self.columns.base),
            &systems,
            self.columns.terms.clone(),
            &EstimatorOptions::default(),
        )?;
        let estimate = &solution.estimate;
        let (firsts, _) = offsets(self.columns.base.len(), &self.columns.terms);
        let terms = self.columns.terms.iter().zip(firsts);
        Ok(Summed {
            base: base_parameters(
                &self.columns.robot,
                &Estimated {
                    values: &estimate.parameters[..self.columns.base.len()],
                    std: &estimate.std[..self.columns.base.len()],
                },
            ),
            terms: terms
                .map(|(list, first)| {
                    let own = list.iter().zip(first..);
                    own.map(|(term, at)| WeightedTerm {
                        term: term.clone(),
                        value: estimate.parameters[at],
                        std: estimate.std[at],
                    })
                    .collect()
                })
                .collect(),
            residual_std: solution.residual_std,
            torque_rms: systems.iter().map(JointSystem::target_deviation).collect(),
            rank: estimate.rank,
        })
    }
}
