//! The choice with the largest posterior, in the form of a report that the proof's scores read.

use super::search::{Hypothesis, name_of};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// Posterior of a name from which it is reported as a rival: as `ambiguous_with` of a diagnosis.
const RIVAL: f64 = 0.1;

/// Posterior of a case.
pub struct Posterior {
    /// Probability of each set of effects, by their names in order; `unknown` for any outside the catalogue.
    pub answers: BTreeMap<Vec<&'static str>, f64>,
    /// Index of the likeliest hypothesis among those of the likeliest answer.
    pub chosen: usize,
}

/// Names of the effects of a hypothesis, in order.
pub fn names(hypothesis: &Hypothesis) -> Vec<&'static str> {
    let parts = hypothesis.point.parts.iter();
    let mut names: Vec<&'static str> = parts.map(|(m, _)| name_of(m.origin)).collect();
    names.sort_unstable();
    names
}

/// Posterior over hypotheses.
pub fn posterior(hypotheses: &[Hypothesis]) -> Posterior {
    let told = hypotheses.iter().map(|h| (names(h), h.weight));
    weighed(&told.collect::<Vec<_>>())
}

/// Posterior of names by the logarithms of their weights, of which there is at least one.
fn weighed(hypotheses: &[(Vec<&'static str>, f64)]) -> Posterior {
    let weights = || hypotheses.iter().map(|h| h.1);
    let top = weights().fold(f64::NEG_INFINITY, f64::max);
    let parts: Vec<f64> = weights().map(|w| (w - top).exp()).collect();
    let all: f64 = parts.iter().sum();
    let mut answers: BTreeMap<Vec<&'static str>, f64> = BTreeMap::new();
    for ((names, _), part) in hypotheses.iter().zip(&parts) {
        *answers.entry(names.clone()).or_default() += part / all;
    }
    let likeliest = answers.iter().max_by(|a, b| a.1.total_cmp(b.1));
    let own = |i: &usize| likeliest.is_some_and(|(names, _)| *names == hypotheses[*i].0);
    let chosen = (0..hypotheses.len()).filter(own);
    let chosen = chosen
        .max_by(|&a, &b| parts[a].total_cmp(&parts[b]))
        .unwrap_or(0);
    Posterior { answers, chosen }
}

/// The choice as a report, for a robot with `dof` joints.
pub fn report(hypotheses: &[Hypothesis], posterior: &Posterior, dof: usize) -> Value {
    let chosen = &hypotheses[posterior.chosen];
    let own = names(chosen);
    let mut rivals: BTreeMap<&str, f64> = BTreeMap::new();
    for (names, p) in &posterior.answers {
        for name in names
            .iter()
            .filter(|n| !own.contains(n) && **n != "unknown")
        {
            *rivals.entry(name).or_default() += p;
        }
    }
    let rivals: Vec<&str> = rivals
        .into_iter()
        .filter(|r| r.1 >= RIVAL)
        .map(|r| r.0)
        .collect();
    let mut parts: Vec<_> = chosen.point.parts.iter().collect();
    parts.retain(|(m, _)| name_of(m.origin) != "unknown");
    parts.sort_by(|a, b| b.0.share.total_cmp(&a.0.share));
    let causes = parts.iter().map(|(m, size)| {
        let joints = m.joints(dof).unwrap_or_else(|| (0..dof).collect());
        let joints: Vec<String> = joints.iter().map(|j| format!("joint{}", j + 1)).collect();
        json!({"effect": name_of(m.origin), "joints": joints, "size": size, "ambiguous_with": rivals})
    });
    let verdict = match &own[..] {
        [] => "no_gap",
        names if names.contains(&"unknown") => "unknown_effect",
        _ => "explained",
    };
    let causes: Vec<Value> = causes.collect();
    let answers: Vec<Value> = posterior
        .answers
        .iter()
        .filter(|(_, p)| **p > 1e-6)
        .map(|(names, p)| json!({"effects": names, "probability": p}))
        .collect();
    json!({"verdict": verdict, "causes": causes, "ladder": [], "posterior": answers})
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mechanisms_that_are_the_same_torque_share_the_probability() {
        let same = [(vec!["payload"], -3.0), (vec!["link_parameters"], -3.0)];
        let told = weighed(&same);
        assert!(told.answers.values().all(|p| (p - 0.5).abs() < 1e-12));
        // Two places of one name count together; the likelier is chosen of them.
        let places = [
            (vec!["backlash"], 0.0),
            (vec!["torque_gain"], 0.5f64.ln()),
            (vec!["torque_gain"], 0.75f64.ln()),
        ];
        let told = weighed(&places);
        assert!((told.answers[&vec!["torque_gain"]] - 1.25 / 2.25).abs() < 1e-12);
        assert_eq!(told.chosen, 2);
    }
}
