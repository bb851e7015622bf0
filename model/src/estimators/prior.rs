//! What was known of the robot before the data.

use crate::directory::ModelFile;
use crate::identification::IdentifyError;
use physics::effects::{Sliding, Term};
use physics::identify::base::BaseParameters;
use physics::robot::Robot;

/// Parameters of an earlier model.
#[derive(Clone, Debug, PartialEq)]
pub struct Known {
    /// Its name.
    pub name: String,
    /// Base parameters.
    base: Vec<f64>,
    /// Terms of each joint with their parameters.
    terms: Vec<Vec<(Term, f64)>>,
}

impl Known {
    /// The robot as its description has it: inertias, rotor inertia, damping and friction.
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

    /// An older model of the same robot.
    ///
    /// # Errors
    /// Other base parameters than `robot` has.
    pub fn model(file: &ModelFile, robot: &Robot) -> Result<Self, IdentifyError> {
        // Arms of like structure have base parameters of the same names; the formulae hold the lengths.
        let formulae = BaseParameters::of_robot(robot, &[]).formulae();
        let older = file.base_parameters.iter().map(|p| &p.formula);
        if !formulae.iter().eq(older) {
            return Err(IdentifyError::Prior {
                prior: file.physics.robot.clone(),
                robot: robot.name().to_owned(),
            });
        }
        let values = |list: &Vec<physics::torque_model::WeightedTerm>| {
            list.iter().map(|w| (w.term.clone(), w.value)).collect()
        };
        Ok(Self {
            name: format!("model of {}", file.physics.robot),
            base: file.base_parameters.iter().map(|p| p.value).collect(),
            terms: file.physics.terms.iter().map(values).collect(),
        })
    }

    /// Values of `base` base parameters and of the terms; zero for terms that the earlier model lacks.
    pub(super) fn mean(&self, base: usize, terms: &[Vec<Term>]) -> Vec<f64> {
        let mut mean = self.base.clone();
        mean.resize(base, 0.0);
        for (list, known) in terms.iter().zip(&self.terms) {
            mean.extend(list.iter().map(|term| {
                // However soft its sign, it is the same coefficient.
                let coulomb = |t: &Term| matches!(t, Term::Sliding(s) if s.is_coulomb());
                let same = |t: &Term| t == term || coulomb(t) && coulomb(term);
                let value = known.iter().find(|(t, _)| same(t));
                value.map_or(0.0, |(_, v)| *v)
            }));
        }
        mean
    }
}
