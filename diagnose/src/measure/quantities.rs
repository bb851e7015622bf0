//! Sizes of causes, the lead of their names, and ambiguous names.

use crate::catalogue::effect::Effect;
use crate::catalogue::{Candidate, Parameter, Shape, Size, Unit};
use crate::input::frames::Frames;
use crate::search::find::Findings;
use crate::search::select::CandidateScore;
use crate::simulator::NominalModel;
use crate::traces::contact::Contact;
use physics::robot::PARAMETERS_PER_LINK;

/// Coefficients of a cause as the report's parameters, followed by its shape parameters.
pub fn parameters(found: &Findings, cause: usize, names: &[String]) -> Vec<Parameter> {
    let accepted = &found.accepted[cause];
    let candidate = found.candidate(cause);
    let shapes = shapes(found, cause);
    let alike = |k: usize, name: &'static str| {
        shapes.iter().filter_map(move |(weight, t)| {
            let quantities = &found.candidates[t.candidate].quantities;
            let q = quantities.get(k).filter(|q| q.name == name)?;
            Some((*weight, q.offset + q.factor * t.gamma[k]))
        })
    };
    let mut out: Vec<Parameter> = candidate
        .quantities
        .iter()
        .zip(accepted.variables.clone())
        .enumerate()
        .map(|(k, (q, i))| {
            let value = q.offset + q.factor * found.tight.1[i];
            let own = q.factor * found.std[i];
            Parameter {
                name: q.name.to_owned(),
                joint: q.joint.map(|j| names[j].clone()),
                value,
                std: Some(own.hypot(around(value, alike(k, q.name)))),
                unit: q.unit,
            }
        })
        .collect();
    let joint = candidate
        .joints
        .first()
        .filter(|_| candidate.joints.len() == 1)
        .map(|&j| names[j].clone());
    out.extend(measured(&candidate.sizes, joint.as_ref()));
    let numbers = |name: &str| -> Vec<(f64, f64)> {
        let number = |(weight, t): &(f64, &CandidateScore)| {
            let value = found.candidates[t.candidate].shape(name);
            value.map(|value| (*weight, value))
        };
        shapes.iter().filter_map(number).collect()
    };
    let grid = |&Shape { name, value, unit }: &Shape| Parameter {
        name: name.to_owned(),
        joint: joint.clone(),
        value: if value.is_finite() { value } else { 0.0 },
        std: of_grid(&numbers(name), value),
        unit,
    };
    out.extend(candidate.shape.iter().map(grid));
    (candidate.effect.info().reported)(&mut out);
    out
}

/// Shapes of a cause that were tried in its place, each with a weight of at most 1 by its gain. A gain that is
/// lower by the part `leftover` is within what a wrong form leaves behind.
fn shapes(found: &Findings, cause: usize) -> Vec<(f64, &CandidateScore)> {
    let accepted = &found.accepted[cause];
    let own = found.candidate(cause);
    let gain = |t: &CandidateScore| found.earned(t);
    let mut tried = accepted.tried.iter();
    let Some(best) = tried.find(|t| t.candidate == accepted.candidate).map(gain) else {
        return Vec::new();
    };
    let scale = (found.settings.search.leftover * best).max(1.0);
    let alike = |t: &&CandidateScore| {
        let c = &found.candidates[t.candidate];
        c.effect == own.effect && c.joints == own.joints && c.driver == own.driver
    };
    let weight = |t: &CandidateScore| ((gain(t) - best).min(0.0) / scale).exp();
    accepted
        .tried
        .iter()
        .filter(alike)
        .map(|t| (weight(t), t))
        .collect()
}

/// Weighted standard deviation of numbers about `value`.
fn around(value: f64, numbers: impl Iterator<Item = (f64, f64)>) -> f64 {
    let (sum, square) = numbers.fold((0.0, 0.0), |(sum, square), (weight, x)| {
        (sum + weight, square + weight * (x - value).powi(2))
    });
    (square / f64::max(sum, 1.0)).sqrt()
}

/// Standard deviation of a shape parameter that was tried on a grid. `numbers` are the values on the grid with
/// their weights. It is their deviation from `value`, and at least that of a number between its neighbours.
/// None where there is but one.
fn of_grid(numbers: &[(f64, f64)], value: f64) -> Option<f64> {
    let beside = |sign: f64| {
        let steps = numbers.iter().map(|(_, x)| sign * (x - value));
        steps
            .filter(|d| *d > 0.0 && d.is_finite())
            .min_by(f64::total_cmp)
    };
    let cell = match (beside(1.0), beside(-1.0)) {
        (Some(up), Some(down)) => 0.5 * (up + down),
        (one, other) => one.or(other)?,
    };
    let finite = numbers.iter().copied().filter(|n| n.1.is_finite());
    Some(around(value, finite).max(cell / 12.0_f64.sqrt()))
}

/// Sizes that a sensor measured, as the report's parameters.
pub fn measured(sizes: &[Size], joint: Option<&String>) -> Vec<Parameter> {
    let one = |s: &Size| Parameter {
        name: s.name.to_owned(),
        joint: joint.cloned(),
        value: s.value,
        std: Some(s.std),
        unit: s.unit,
    };
    sizes.iter().map(one).collect()
}

/// Changed parameters of the named joints that moved clearly, most deviations first. A payload does not count as a change of the last
/// link.
pub fn moved(
    model: &NominalModel,
    found: &Findings,
    effect: Effect,
    joints: &[usize],
    names: &[String],
) -> Vec<Parameter> {
    let n = model.robot.dof();
    let mut out: Vec<(f64, Parameter)> = Vec::new();
    let changes = found.changes(|i| !found.is_structure(i));
    let total = |parameter: usize| changes[parameter];
    let parameter = |name: String, j: usize, value, std, unit: Unit| Parameter {
        name,
        joint: Some(names[j].clone()),
        value,
        std: Some(std).filter(|s: &f64| s.is_finite()),
        unit,
    };
    if effect.info().friction {
        for &j in joints {
            let joint = &model.robot.joints()[j];
            let (dv, sv) = total(PARAMETERS_PER_LINK * n + j);
            let (dc, sc) = total((PARAMETERS_PER_LINK + 1) * n + j);
            let viscous = (joint.damping + dv, sv, Unit::NewtonMetreSecondPerRad);
            let coulomb = (joint.friction + dc, sc, Unit::NewtonMetre);
            for (name, change, (value, std, unit)) in
                [("viscous", dv, viscous), ("coulomb", dc, coulomb)]
            {
                let new = parameter(name.into(), j, value, std, unit);
                out.push((change.abs() / std, new));
            }
            out.extend(slow(found, j, names).into_iter().map(|p| (0.0, p)));
        }
    } else {
        let given = model.robot.parameters();
        let labels = model.robot.parameter_names();
        let said = &found.settings.measure.said;
        for (c, (p, label)) in given.iter().zip(labels).enumerate() {
            let (change, std) = total(c);
            if said.is_changed(*p, change, std) {
                let unit = [Unit::Kilogram, Unit::KilogramMetre, Unit::KilogramMetre2]
                    [[0, 1, 1, 1, 2, 2, 2, 2, 2, 2][c % PARAMETERS_PER_LINK]];
                let j = c / PARAMETERS_PER_LINK;
                let new = parameter(label, j, p + change, std, unit);
                out.push((change.abs() / std, new));
            }
        }
    }
    out.sort_by(|(a, _), (b, _)| b.total_cmp(a));
    out.into_iter().map(|(_, p)| p).collect()
}

/// Those of `joints` whose friction has changed by more than its deviations allow; all of them where none has. A joint's friction may
/// be freed for what another cause explains in the end.
pub fn rubbing(model: &NominalModel, found: &Findings, joints: Vec<usize>) -> Vec<usize> {
    let n = model.robot.dof();
    let changes = found.changes(|i| !found.is_structure(i));
    let clearly =
        |(change, std): (f64, f64)| change.abs() > found.settings.measure.said.changed * std;
    let names = model.robot.joint_names();
    let changed = |j: &usize| {
        let own = [
            PARAMETERS_PER_LINK * n + j,
            (PARAMETERS_PER_LINK + 1) * n + j,
        ];
        own.iter().any(|&p| clearly(changes[p])) || !slow(found, *j, &names).is_empty()
    };
    let kept: Vec<usize> = joints.iter().copied().filter(changed).collect();
    if kept.is_empty() { joints } else { kept }
}

/// Part of a joint's Coulomb friction that builds up over a wider velocity than the model's, and that velocity.
fn slow(found: &Findings, joint: usize, names: &[String]) -> Vec<Parameter> {
    let own = (0..found.accepted.len()).find(|&c| {
        let candidate = found.candidate(c);
        candidate.effect == Effect::FrictionParameters
            && candidate.joints == [joint]
            && !candidate.shape.is_empty()
    });
    let mut all = own.map_or_else(Vec::new, |c| parameters(found, c, names));
    all.retain(|p| p.name.starts_with("slow_"));
    all
}

/// Force of the strongest push, its link and time, from the held-out recording, else from the fitted one.
pub fn pushed(
    model: &NominalModel,
    frames: &Frames,
    data: Option<&Contact>,
    heldout: Option<&Contact>,
) -> Vec<Parameter> {
    let both = [(heldout, &frames.heldout), (data, &frames.data)];
    let Some((contact, frame)) = both.into_iter().find_map(|(c, f)| Some((c?, f))) else {
        return Vec::new();
    };
    let strongest = contact
        .bursts
        .iter()
        .max_by(|a, b| a.height.total_cmp(&b.height));
    let Some(burst) = strongest else {
        return Vec::new();
    };
    let time = &frame.samples().time;
    let joint = Some(model.robot.joints()[burst.last_joint].name.clone());
    let new = |name: &str, value: f64, unit: Unit| Parameter {
        name: name.to_owned(),
        joint: joint.clone(),
        value,
        std: None,
        unit,
    };
    let mut out = vec![
        new("start", time[burst.samples.start], Unit::Second),
        new("end", time[burst.samples.end - 1], Unit::Second),
        new("bursts", contact.bursts.len() as f64, Unit::One),
    ];
    let force = contact.force(&model.robot, frame);
    out.extend(force.map(|f| new("force", f, Unit::Newton)));
    out
}

/// Lead of the name: gain over the best other name, nats.
pub fn lead(found: &Findings, tried: &[CandidateScore], own: usize) -> f64 {
    let effect = found.candidates[own].effect;
    let best = |f: &dyn Fn(&Candidate) -> bool| {
        tried
            .iter()
            .find(|t| f(&found.candidates[t.candidate]))
            .map_or(0.0, |t| t.gain.max(0.0))
    };
    best(&|c| c.effect == effect) - best(&|c| c.effect != effect)
}

/// Effects whose gain in its place is nearly as large.
pub fn ambiguous(found: &Findings, tried: &[CandidateScore], own: usize) -> Vec<Effect> {
    let effect = found.candidates[own].effect;
    let gain = tried
        .iter()
        .find(|t| t.candidate == own)
        .map_or(0.0, |t| t.gain);
    let said = &found.settings.measure.said;
    let near = gain - said.ambiguous.max(said.ambiguous_part * gain);
    let mut out: Vec<Effect> = Vec::new();
    // A free refit that leaves less is a rival, however many parameters it takes.
    let accepted = found.accepted.iter().find(|a| a.candidate == own);
    if accepted
        .and_then(|a| a.against.over_refit)
        .is_some_and(|r| r > found.settings.search.as_good)
    {
        out.push(Effect::LinkParameters);
    }
    for t in tried
        .iter()
        .filter(|t| t.gain > near && t.gain > said.rival * gain)
    {
        let e = found.candidates[t.candidate].effect;
        if e != effect && !out.contains(&e) {
            out.push(e);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_deviation_over_a_grid_is_at_least_that_of_its_cell() {
        // Weights of 1.6 in all; squares of 0.5 · 0.1² and 0.1 · 0.05².
        let numbers = [(1.0, 0.1), (0.5, 0.2), (0.1, 0.05)];
        let deviation = of_grid(&numbers, 0.1).unwrap();
        assert!((deviation - (0.00525_f64 / 1.6).sqrt()).abs() < 1e-12);
        // One shape that is far better than its neighbours: a uniform number in a cell of (0.1 + 0.05) / 2.
        let alone = [(1.0, 0.1), (0.0, 0.2), (0.0, 0.05), (1.0, f64::INFINITY)];
        let deviation = of_grid(&alone, 0.1).unwrap();
        assert!((deviation - 0.075 / 12.0_f64.sqrt()).abs() < 1e-12);
        assert_eq!(of_grid(&[(1.0, 0.1)], 0.1), None);
        // Less than a whole weight does not make a deviation larger.
        assert!((around(1.0, [(0.25, 3.0)].into_iter()) - 1.0).abs() < 1e-12);
    }
}
