//! `friction_drift`: friction that changes over the session. Profiles over the share of the session that has
//! passed, times viscous, Coulomb or both columns; where the joint's temperature was recorded, over that as well. Confounders: one-off
//! errors of friction parameters.

use super::candidate::{Bound, Candidate, Column, Quantity};
use super::effect::Effect;
use super::experiment::Experiment;
use super::info::{Carried, Info, Need};
use super::unit::Unit;
use crate::motion::scene::Scene;
use ndarray::Array1;
use physics::effects::{Drift, Sliding, Term, WarmUp};

/// Description of `friction_drift`: confounders, needs, experiment, rules.
pub(super) const INFO: Info = Info {
    name: "friction_drift",
    plain: "friction that drifts over the session",
    confounders: &[Effect::FrictionParameters, Effect::NonlinearViscousFriction],
    friction: true,
    passing: true,
    needs: &[Need::Minute],
    coded: true,
    carried: by_clock_alone,
    experiment: Experiment::ColdAndWarm,
    unwritten: "goes with a joint's temperature, which no simulator has",
    ..Info::NEW
};

/// Time constants of the drift relative to the session's length; infinity: a straight line.
const CONSTANTS: [f64; 4] = [0.1, 0.3, 1.0, f64::INFINITY];
/// Temperature rises over which the slope of friction falls to 1/e, relative to the recorded range; infinity: a straight line.
const FADING: [f64; 3] = [0.3, 0.8, f64::INFINITY];

/// Name of the shape parameter that marks drift by temperature.
pub(crate) const REFERENCE: &str = "reference_temperature";

pub(super) fn candidates(scene: &Scene, joint: usize) -> Vec<Candidate> {
    let mut all = Vec::new();
    for constant in CONSTANTS {
        // Falling to the given value as well as leaving it: either end may be the model's.
        for end in [0.0, 1.0] {
            let drifting = |friction| Column::terms(joint, terms(scene, friction, constant, end));
            let names = [
                ("viscous", Unit::NewtonMetreSecondPerRad),
                ("coulomb", Unit::NewtonMetre),
            ];
            let each = [drifting(Sliding::Viscous), drifting(scene.coulomb(joint))];
            let three = viscous_coulomb_both(joint, names, each);
            all.extend(three.map(|c| c.with_shape("time_constant", constant, Unit::Session)));
        }
    }
    all.extend(by_temperature(scene, joint));
    all
}

/// Candidates with the viscous column, the Coulomb column, and both.
fn viscous_coulomb_both(
    joint: usize,
    names: [(&'static str, Unit); 2],
    [viscous, coulomb]: [Column; 2],
) -> [Candidate; 3] {
    let [v, c] = names.map(|(name, unit)| Quantity::plain(name, unit, Some(joint)));
    let new = |q: &Quantity, column: &Column| {
        let (effect, column) = (Effect::FrictionDrift, column.clone());
        Candidate::single(effect, joint, q.clone(), Bound::Free, column)
    };
    [
        new(&v, &viscous),
        new(&c, &coulomb),
        new(&v, &viscous).and(c, Bound::Free, coulomb),
    ]
}

/// Candidates over the joint's recorded temperature; none where it was not recorded.
fn by_temperature(scene: &Scene, joint: usize) -> Vec<Candidate> {
    let Some(t) = scene.temperature(joint) else {
        return Vec::new();
    };
    let low = t.iter().copied().fold(f64::INFINITY, f64::min);
    let high = t.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let mut all = Vec::new();
    for fading in FADING {
        let law = Warmth {
            fading: fading * (high - low),
            reference: low,
        };
        // Either end may be the model's, as with time.
        for neutral in [0.0, law.at(high)] {
            let usual = t.mapv(|t| law.at(t)).mean().unwrap_or(0.0);
            let column = |friction: Sliding| {
                Column::own(joint, move |s| {
                    let rubs = s.terms(joint, &[(1.0, Term::Sliding(friction))]);
                    law.factor(s, joint, usual).mapv_into(|x| x - neutral) * rubs
                })
            };
            let names = [
                ("viscous_per_kelvin", Unit::NewtonMetreSecondPerRadKelvin),
                ("coulomb_per_kelvin", Unit::NewtonMetrePerKelvin),
            ];
            let each = [column(Sliding::Viscous), column(scene.coulomb(joint))];
            let given = if neutral == 0.0 { low } else { high };
            let three = viscous_coulomb_both(joint, names, each).map(|c| {
                let c = c.with_shape(REFERENCE, low, Unit::Celsius);
                let c = c.with_shape("given_temperature", given, Unit::Celsius);
                match fading.is_finite() {
                    true => c.with_shape("fading", law.fading, Unit::Kelvin),
                    false => c,
                }
            });
            all.extend(three);
        }
    }
    all
}

/// Factor on friction over temperature, with slope 1 at the reference.
#[derive(Clone, Copy, Debug)]
struct Warmth {
    /// Rise over which the slope falls to 1/e, K; infinity: a straight line.
    fading: f64,
    /// Reference temperature, °C.
    reference: f64,
}

impl Warmth {
    fn at(self, temperature: f64) -> f64 {
        let rise = temperature - self.reference;
        if self.fading.is_finite() {
            -self.fading * (-rise / self.fading).exp_m1()
        } else {
            rise
        }
    }

    /// Rise of the joint's temperature that scales its friction, at each sample, K: it fades with growing temperature.
    /// `usual` stands in where the temperature is unknown.
    fn factor(self, scene: &Scene, joint: usize, usual: f64) -> Array1<f64> {
        match scene.temperature(joint) {
            Some(t) => t.mapv(|t| self.at(t)),
            None => Array1::from_elem(scene.len(), usual),
        }
    }
}

/// Terms of friction times the progress since the session's start, less `end`: 1 − exp(−progress/constant), or
/// the progress itself.
fn terms(scene: &Scene, friction: Sliding, constant: f64, end: f64) -> Vec<(f64, Term)> {
    let (start, stop) = scene.scale.session;
    let span = (stop - start).max(1e-9);
    let plain = Term::Sliding(friction);
    let term = Box::new(plain.clone());
    let mut terms = if constant.is_infinite() {
        let mut drift = Drift {
            term,
            start,
            span,
            neutral: 0.0,
        };
        drift.neutral = scene.mean_over_session(|t| drift.factor(Some(t)));
        vec![(1.0, Term::Drift(drift)), (-end, plain)]
    } else {
        let mut warm_up = WarmUp {
            term,
            time_constant: constant * span,
            start,
            neutral: 0.0,
        };
        warm_up.neutral = scene.mean_over_session(|t| warm_up.factor(Some(t)));
        vec![(-1.0, Term::WarmUp(warm_up)), (1.0 - end, plain)]
    };
    terms.retain(|t| t.0 != 0.0);
    terms
}

/// Place of a drift of friction in a model directory: terms of the torque model for a drift over the clock. A drift
/// over temperature has no place, since no control loop knows a temperature.
fn by_clock_alone(candidate: &Candidate) -> Carried {
    match candidate.shape(REFERENCE) {
        Some(_) => Carried::Not,
        None => Carried::Terms,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn warmth_has_slope_one_at_its_reference_and_fades() {
        let (straight, fading) = (
            Warmth {
                fading: f64::INFINITY,
                reference: 25.0,
            },
            Warmth {
                fading: 5.0,
                reference: 25.0,
            },
        );
        for law in [straight, fading] {
            assert_eq!(law.at(25.0), 0.0);
            assert!((law.at(25.01) - 0.01).abs() < 1e-4);
        }
        assert_eq!(straight.at(35.0), 10.0);
        assert!((fading.at(30.0) - 5.0 * (1.0 - (-1.0f64).exp())).abs() < 1e-12);
        assert!(fading.at(1000.0) < 5.0 + 1e-9);
    }
}
