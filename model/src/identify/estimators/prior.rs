//! Prior knowledge of the robot's parameters.

use crate::identify::error::IdentifyError;
use ::identify::base::BaseParameters;
use physics::effects::{Sliding, Term};
use physics::robot::Robot;

/// Parameters of an earlier model, used as a prior.
#[derive(Clone, Debug, PartialEq)]
pub struct Known {
    /// Name of the earlier model.
    pub name: String,
    /// Values of the base parameters.
    base: Vec<f64>,
    /// Terms of each joint with their parameters.
    terms: Vec<Vec<(Term, f64)>>,
}

impl Known {
    /// Parameters of the robot's description: inertias, rotor inertia, damping and friction.
    pub fn nominal(robot: &Robot) -> Self {
        let base = BaseParameters::of_robot(robot, &[]);
        let terms = robot.joints().iter().map(|joint| {
            vec![
                (Term::RotorInertia, joint.rotor_inertia),
                (Term::Sliding(Sliding::Viscous), joint.damping),
                (Term::Sliding(Sliding::Coulomb), joint.friction),
            ]
        });
        Self {
            name: "nominal".to_owned(),
            base: base.base_from(&robot.parameters()),
            terms: terms.collect(),
        }
    }

    /// Base parameters and terms of an earlier model of the same robot. `robot` is its name there, `formulae`
    /// are those of its base parameters.
    ///
    /// # Errors
    /// Other base parameters than `nominal` has.
    pub fn earlier<'a>(
        robot: &str,
        formulae: impl Iterator<Item = &'a String>,
        base: Vec<f64>,
        terms: Vec<Vec<(Term, f64)>>,
        nominal: &Robot,
    ) -> Result<Self, IdentifyError> {
        // Arms of like structure have base parameters of the same names; the formulae hold the lengths.
        let own = BaseParameters::of_robot(nominal, &[]).formulae();
        if !own.iter().eq(formulae) {
            return Err(IdentifyError::Prior {
                prior: robot.to_owned(),
                robot: nominal.name().to_owned(),
            });
        }
        Ok(Self {
            name: format!("model of {robot}"),
            base,
            terms,
        })
    }

    /// Values of `base` base parameters and of the terms; zero for terms that the earlier model lacks.
    pub(super) fn mean(&self, base: usize, terms: &[Vec<Term>]) -> Vec<f64> {
        let mut mean = self.base.clone();
        mean.resize(base, 0.0);
        for (list, known) in terms.iter().zip(&self.terms) {
            mean.extend(list.iter().map(|term| {
                // However soft its sign, it is the same coefficient.
                let coulomb = |t: &Term| match t {
                    Term::Sliding(s) => s.is_coulomb(),
                    t => matches!(t, Term::EarlySign(_)),
                };
                let same = |t: &Term| t == term || coulomb(t) && coulomb(term);
                let value = known.iter().find(|(t, _)| same(t));
                value.map_or(0.0, |(_, v)| *v)
            }));
        }
        mean
    }
}
