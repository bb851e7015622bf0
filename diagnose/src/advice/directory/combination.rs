//! Torque model as a linear combination of a fit's coefficients: every parameter is its given value plus a weighted sum of them.

use crate::catalogue::{Column, ColumnTorque};
use crate::motion::scene::Scale;
use crate::simulator::NominalModel;
use identify::base::BaseParameters;
use ndarray::{Array1, Array2};
use physics::effects::{
    Coupling, EarlySign, Harmonic, Phase, Polynomial, PositionFriction, Sliding, Term,
};
use physics::torque_model::WeightedTerm;

/// Sum that gives one parameter: its given value and the coefficients that move it, each with its factor.
#[derive(Clone, Debug, Default)]
struct Sum {
    given: f64,
    moved: Vec<(usize, f64)>,
}

impl Sum {
    fn value(&self, beta: &Array1<f64>) -> f64 {
        self.given + self.moved.iter().map(|(i, f)| f * beta[*i]).sum::<f64>()
    }

    /// Row of the matrix from coefficients to parameters.
    fn row(&self, coefficients: usize) -> Array1<f64> {
        let mut row = Array1::zeros(coefficients);
        self.moved.iter().for_each(|(i, f)| row[*i] += f);
        row
    }
}

/// Rigid-body parameters, and terms of each joint.
pub(super) struct Combination {
    rigid: Vec<Sum>,
    terms: Vec<Vec<(Term, Sum)>>,
    softness: Vec<f64>,
    lead: Vec<f64>,
    zeros: Vec<f64>,
}

impl Combination {
    /// The given model. Its terms use true positions, which are `zeros` beyond the recorded ones on which columns were evaluated.
    pub(super) fn of(given: &NominalModel, scale: &Scale, zeros: &[f64]) -> Self {
        let robot = &given.robot;
        let rigid = robot.parameters().into_iter().map(|given| Sum {
            given,
            moved: Vec::new(),
        });
        let mut own = Self {
            rigid: rigid.collect(),
            terms: vec![Vec::new(); robot.dof()],
            softness: scale.softness.clone(),
            lead: scale.lead.clone(),
            zeros: zeros.to_vec(),
        };
        match given.file() {
            Some(file) => {
                for (joint, list) in file.physics.terms.iter().enumerate() {
                    for w in list {
                        own.entry(joint, w.term.clone()).given += w.value;
                    }
                }
            }
            None => {
                for (joint, j) in robot.joints().iter().enumerate() {
                    for (term, value) in [
                        (Term::Sliding(Sliding::Viscous), j.damping),
                        (own.coulomb(joint), j.friction),
                        (Term::RotorInertia, j.rotor_inertia),
                    ] {
                        if value != 0.0 {
                            own.entry(joint, term).given += value;
                        }
                    }
                }
                for p in robot.passive() {
                    own.entry(p.joint(), Term::from(*p)).given += 1.0;
                }
            }
        }
        own
    }

    fn coulomb(&self, joint: usize) -> Term {
        let (velocity, lead) = (self.softness[joint], self.lead[joint]);
        if lead == 0.0 {
            Term::Sliding(Sliding::SoftCoulomb { velocity })
        } else {
            Term::EarlySign(EarlySign { velocity, lead })
        }
    }

    fn entry(&mut self, joint: usize, term: Term) -> &mut Sum {
        let list = &mut self.terms[joint];
        let known = list.iter().position(|(t, _)| *t == term);
        let at = known.unwrap_or(list.len());
        if known.is_none() {
            list.push((term, Sum::default()));
        }
        &mut list[at].1
    }

    /// Adds a column with the coefficient of a variable. A column that a torque model cannot hold adds nothing.
    pub(super) fn add_column(&mut self, column: &Column, variable: usize) {
        let dof = self.terms.len();
        match &column.torque {
            ColumnTorque::Base(c) => {
                let friction = c.checked_sub(self.rigid.len());
                match friction.map(|f| (f / dof, f % dof)) {
                    None => self.rigid[*c].moved.push((variable, 1.0)),
                    Some((0, joint)) => {
                        let viscous = Term::Sliding(Sliding::Viscous);
                        self.add(joint, viscous, variable, 1.0);
                    }
                    Some((_, joint)) => self.add(joint, self.coulomb(joint), variable, 1.0),
                }
            }
            ColumnTorque::Terms(terms) => {
                for (factor, term) in terms {
                    let joint = column.joints[0];
                    for (part, term) in at_true_positions(joint, term, &self.zeros) {
                        self.add(joint, term, variable, factor * part);
                    }
                }
            }
            ColumnTorque::Link(..) | ColumnTorque::Made(_) => {}
        }
    }

    fn add(&mut self, joint: usize, term: Term, variable: usize, factor: f64) {
        self.entry(joint, term).moved.push((variable, factor));
    }

    /// Rigid-body parameters and terms for the coefficients `beta` with a covariance.
    pub(super) fn values(
        &self,
        beta: &Array1<f64>,
        covariance: &Array2<f64>,
    ) -> (Vec<f64>, Vec<Vec<WeightedTerm>>) {
        let weighted = |(term, sum): &(Term, Sum)| {
            let row = sum.row(beta.len());
            WeightedTerm {
                term: term.clone(),
                value: sum.value(beta),
                std: row.dot(&covariance.dot(&row)).max(0.0).sqrt(),
            }
        };
        let terms = self.terms.iter().map(|l| l.iter().map(weighted).collect());
        let rigid = self.rigid.iter().map(|s| s.value(beta));
        (rigid.collect(), terms.collect())
    }

    /// Covariance of base parameters, then each joint's terms, in the order of a model file. A known
    /// counterbalance or spring has no entry.
    pub(super) fn covariance(&self, base: &BaseParameters, of: &Array2<f64>) -> Array2<f64> {
        let n = of.nrows();
        let mut rows: Vec<Array1<f64>> = vec![Array1::zeros(n); base.len()];
        let mut unit = vec![0.0; self.rigid.len()];
        for (p, sum) in self.rigid.iter().enumerate() {
            unit[p] = 1.0;
            let (own, share) = (sum.row(n), base.base_from(&unit));
            unit[p] = 0.0;
            for (row, share) in rows.iter_mut().zip(share) {
                row.scaled_add(share, &own);
            }
        }
        let fitted = self.terms.iter().flatten();
        let fitted = fitted.filter(|(t, _)| t.passive().is_none());
        rows.extend(fitted.map(|(_, sum)| sum.row(n)));
        let map = Array2::from_shape_fn((rows.len(), n), |(i, k)| rows[i][k]);
        map.dot(of).dot(&map.t())
    }
}

/// Terms of true positions that equal a term of recorded positions; the true ones are `zeros` beyond the recorded ones.
fn at_true_positions(joint: usize, term: &Term, zeros: &[f64]) -> Vec<(f64, Term)> {
    let zero = zeros[joint];
    match term {
        Term::Harmonic(h) => turned(*h, zero)
            .into_iter()
            .map(|(f, h)| (f, Term::Harmonic(h)))
            .collect(),
        Term::Position(p) => turned(p.harmonic, zero)
            .into_iter()
            .map(|(f, harmonic)| (f, Term::Position(PositionFriction { harmonic, ..*p })))
            .collect(),
        Term::Polynomial(p) => {
            let middle = p.middle + zero;
            vec![(1.0, Term::Polynomial(Polynomial { middle, ..*p }))]
        }
        Term::Coupling(Coupling::Spring { driver, middle }) => {
            let (driver, middle) = (*driver, middle + zeros[*driver]);
            vec![(1.0, Term::Coupling(Coupling::Spring { driver, middle }))]
        }
        other => vec![(1.0, other.clone())],
    }
}

/// Expansion of sin(k q) or cos(k q) in sines and cosines of k (q + zero).
fn turned(shape: Harmonic, zero: f64) -> Vec<(f64, Harmonic)> {
    if zero == 0.0 {
        return vec![(1.0, shape)];
    }
    let (s, c) = (shape.order * zero).sin_cos();
    let with = |phase| Harmonic { phase, ..shape };
    match shape.phase {
        Phase::Sin => vec![(c, with(Phase::Sin)), (-s, with(Phase::Cos))],
        Phase::Cos => vec![(c, with(Phase::Cos)), (s, with(Phase::Sin))],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_turned_wave_is_the_same_wave(order in 1.0..40.0f64, zero in -0.5..0.5f64, q in -3.0..3.0f64, sine: bool) {
            let phase = if sine { Phase::Sin } else { Phase::Cos };
            let wave = Harmonic { order, phase };
            let sum: f64 = turned(wave, zero).iter().map(|(f, h)| f * h.at(q + zero)).sum();
            prop_assert!((sum - wave.at(q)).abs() < 1e-12);
        }
    }
}
