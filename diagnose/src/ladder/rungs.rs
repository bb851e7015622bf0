//! Refits with the accepted causes: the steps of the ladder, and the fit near the given parameters.

use crate::algebra::fit::{Fit, Variable};
use crate::catalogue::effect::Effect;
use crate::motion::scene::Scale;
use crate::search::find::Findings;
use crate::search::objective::Objective;
use crate::simulator::NominalModel;
use physics::robot::PARAMETERS_PER_LINK;

/// Parameters of the given structure that a fit may move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Free {
    /// Inertial parameters of links, and friction.
    All,
    /// Inertial parameters alone.
    Links,
    /// Friction coefficients alone.
    Friction,
    /// No parameter: all are held as given.
    Nothing,
}

impl Findings {
    /// Accepted causes of kind `structure`, by index among the accepted.
    pub fn structure(&self) -> Vec<usize> {
        (0..self.accepted.len())
            .filter(|&c| !self.candidate(c).effect.info().parameter)
            .collect()
    }

    /// Fit of the given structure and the accepted causes `causes`, with the parameters `free` identified
    /// again. Coulomb friction that was found to build up slowly counts as part of the given structure.
    pub fn refit(
        &self,
        model: &NominalModel,
        scale: &Scale,
        causes: &[usize],
        free: Free,
    ) -> Fit<'_> {
        let objective = Objective::new(&self.grams, scale, &self.settings.search);
        let inertial = PARAMETERS_PER_LINK * model.robot.dof();
        let (links, friction) = (
            matches!(free, Free::All | Free::Links),
            matches!(free, Free::All | Free::Friction),
        );
        let mut variables = objective.base(model, self.freedom);
        variables.retain(|v| if v.column < inertial { links } else { friction });
        let slow = (0..self.accepted.len())
            .filter(|&c| friction && self.candidate(c).effect == Effect::FrictionParameters);
        let columns = |c: usize| self.dictionary.members[self.accepted[c].candidate].iter();
        let beyond = slow.flat_map(|c| columns(c).filter(|&&m| m >= self.base));
        let named = causes.iter().flat_map(|&c| columns(c));
        variables.extend(beyond.chain(named).map(|&m| objective.wide(m)));
        objective.fit(variables)
    }

    /// Chooses the factor on the tolerances within which parameters are identified again.
    pub fn choose_freedom(&mut self, model: &NominalModel, scale: &Scale) {
        let structure = self.structure();
        let (freedoms, gain) = (
            self.settings.search.freedoms,
            self.settings.search.freedom_gain,
        );
        let mut best = (f64::INFINITY, freedoms[0]);
        for freedom in freedoms {
            self.freedom = freedom;
            let fit = self.refit(model, scale, &structure, Free::All);
            let objective = Objective::new(&self.grams, scale, &self.settings.search);
            let error: f64 = objective.relative(&fit.error()).iter().map(|e| e * e).sum();
            if error < (1.0 - gain) * best.0 {
                best = (error, freedom);
            }
        }
        self.freedom = best.1;
    }

    /// Fit near the given parameters with all accepted causes.
    pub fn tight_fit(&self, scale: &Scale) -> Fit<'_> {
        Objective::new(&self.grams, scale, &self.settings.search).fit(self.tight.0.clone())
    }

    /// Fit near the given parameters without one accepted cause, by its index.
    pub fn tight_without(&self, cause: usize, scale: &Scale) -> Fit<'_> {
        let own = &self.accepted[cause].variables;
        let each = self.tight.0.iter().enumerate();
        let others = each.filter(|(i, _)| !own.contains(i)).map(|(_, v)| *v);
        let objective = Objective::new(&self.grams, scale, &self.settings.search);
        objective.fit(others.collect())
    }

    /// Takes an accepted cause back, by its index. It becomes the first of the candidates that were not accepted.
    pub fn take_back(&mut self, cause: usize, scale: &Scale) {
        let taken = self.accepted.remove(cause);
        let (start, n) = (taken.variables.start, taken.variables.len());
        let mut variables: Vec<Variable> = std::mem::take(&mut self.tight.0);
        variables.drain(taken.variables);
        for later in self
            .accepted
            .iter_mut()
            .filter(|a| a.variables.start > start)
        {
            later.variables = later.variables.start - n..later.variables.end - n;
        }
        let (beta, std) = {
            let objective = Objective::new(&self.grams, scale, &self.settings.search);
            let fit = objective.fit(variables.clone());
            (fit.beta().clone(), fit.deviations())
        };
        self.tight = (variables, beta);
        self.std = std;
        let own = taken
            .tried
            .into_iter()
            .find(|t| t.candidate == taken.candidate);
        self.rest.splice(0..0, own);
    }

    /// Coulomb friction in the prediction of a fit, by joint, N·m (N).
    pub fn coulomb(&self, model: &NominalModel, fit: &Fit) -> Vec<f64> {
        let dof = model.robot.dof();
        let first = (PARAMETERS_PER_LINK + 1) * dof;
        let change = |j: usize| -> f64 {
            let own = fit.variables.iter().zip(fit.beta());
            own.filter(|(v, _)| v.column == first + j)
                .map(|(_, b)| b)
                .sum()
        };
        let joints = model.robot.joints().iter().enumerate();
        joints
            .map(|(j, joint)| joint.friction + change(j))
            .collect()
    }
}
