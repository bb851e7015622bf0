//! Doubts of a diagnosis: effects that could stand in a cause's place, unlisted candidates, and values the motion does
//! not show.

use super::spread::Spread;
use super::values::named;
use crate::catalogue::Effect;
use crate::decide::Found;
use crate::given::Given;
use crate::parameter::{Kind, Parameter, Scale};
use crate::schema::{Candidate, Finding, Named, NotIdentifiable};
use crate::tracks::Replayed;

/// Magnitude of the posterior correlation of two values beyond which they are reported as inseparable.
pub(super) const INSEPARABLE: f64 = 0.95;

/// Least weight of a swap for which another effect is reported as ambiguous with a cause. The weight is the posterior
/// of the swapped set relative to the found set.
pub(super) const AMBIGUOUS: f64 = 0.1;

/// Names of the effects that this motion can hardly tell from `effect`. `members` are indices of its mechanisms in the
/// found set.
pub(super) fn ambiguous(
    found: &Found,
    effect: Effect,
    members: &[usize],
    data: &Replayed,
) -> Vec<&'static str> {
    let mut names: Vec<&'static str> = Vec::new();
    for &m in members {
        let Ok(at) = found.decision.set.binary_search(&m) else {
            continue;
        };
        for swap in found.decision.swaps[at]
            .iter()
            .filter(|s| s.weight >= AMBIGUOUS)
        {
            names.push(found.mechanisms[swap.other].effect.name());
        }
    }
    // What was fitted in the effect's place and is about as probable.
    let set = &found.decision.set;
    for other in found.around.iter().filter(|n| n.weight >= AMBIGUOUS) {
        let gone: Vec<&usize> = set.iter().filter(|m| !other.set.contains(m)).collect();
        let came = other.set.iter().filter(|m| !set.contains(m));
        let came: Vec<Effect> = came.map(|&m| found.mechanisms[m].effect).collect();
        let one = came.iter().all(|e| *e == came[0] && *e != Effect::Unknown);
        let here = gone.iter().all(|m| members.contains(m));
        if one && here && !came.is_empty() && !gone.is_empty() {
            names.push(came[0].name());
        }
    }
    // Without commanded velocities the drive's damping and viscous friction are one number.
    if data.whole.iter().any(|t| t.rates.is_none()) {
        match effect {
            Effect::FrictionParameters => names.push(Effect::ServoDamping.name()),
            Effect::ServoDamping => names.push(Effect::FrictionParameters.name()),
            _ => {}
        }
    }
    names.sort_unstable();
    names.dedup();
    names.retain(|n| *n != effect.name());
    names
}

/// Effects with an inclusion probability between 0.01 and 0.5, most probable first.
pub(super) fn candidates(found: &Found, joints: &[String]) -> Vec<Candidate> {
    let mut out: Vec<Candidate> = (0..found.mechanisms.len())
        .filter(|m| found.decision.inclusion[*m] < 0.5 && found.decision.inclusion[*m] > 0.01)
        .map(|m| Candidate {
            effect: found.mechanisms[m].effect.name(),
            joints: match found.mechanisms[m].joint {
                Some(j) => vec![joints[j].clone()],
                None => joints.to_vec(),
            },
            probability: found.decision.inclusion[m],
        })
        .collect();
    out.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    out
}

/// Quantities that this motion does not determine, each with its reason: joints that never move, values not told from
/// zero, inseparable values, and values whose prior deviation is not halved. Values that were in no doubt before are left out of the
/// last: those of no listed cause that are given without a tolerance.
pub(super) fn not_identifiable(
    given: &Given,
    found: &Found,
    spread: &Spread,
    data: &Replayed,
    joints: &[String],
) -> Vec<NotIdentifiable> {
    let effect_of = |p: Parameter| {
        let own = found.decision.set.iter().find(|&&m| {
            found.mechanisms[m]
                .parameters
                .iter()
                .any(|s| s.parameter == p)
        });
        own.map(|&m| found.mechanisms[m].effect.name())
    };
    let place = |p: Parameter| {
        if p.kind.is_common() {
            joints.to_vec()
        } else {
            vec![joints[p.joint].clone()]
        }
    };
    let say = |p: Parameter| {
        let (name, _) = named(p.kind, true);
        if p.kind.is_common() {
            name.to_owned()
        } else {
            format!("{name} of {}", joints[p.joint])
        }
    };
    let own = |p: Parameter| Named {
        name: named(p.kind, true).0,
        joint: (!p.kind.is_common()).then(|| joints[p.joint].clone()),
    };
    let mut out = Vec::new();
    // Parameters whose prior deviation is not halved; those of one name are reported together.
    let mut faint: Vec<Parameter> = Vec::new();
    for j in (0..joints.len()).filter(|&j| !data.moves[j]) {
        out.push(NotIdentifiable {
            effect: None,
            joints: vec![joints[j].clone()],
            reason: "it never moves, and no command asks it to".to_owned(),
            finding: Finding::Still,
            values: Vec::new(),
        });
    }
    let has_name = |p: Parameter| !matches!(p.kind, Kind::Unknown(_));
    for (i, f) in found
        .free
        .iter()
        .enumerate()
        .filter(|f| has_name(f.1.parameter))
    {
        let p = f.parameter;
        let bound = p.kind.scale() == Scale::Positive && found.fitted.x[i] <= 0.0;
        if bound && effect_of(p).is_some() {
            out.push(NotIdentifiable {
                effect: effect_of(p),
                joints: place(p),
                reason: format!(
                    "{} is not told from zero; it is below {:.2e}",
                    say(p),
                    2.0 * spread.deviation[i]
                ),
                finding: Finding::Zero,
                values: vec![own(p)],
            });
        } else if spread.deviation[i] > 0.5 * spread.prior[i]
            && (effect_of(p).is_some() || given.doubts(p))
        {
            faint.push(p);
        }
        for (k, other) in found
            .free
            .iter()
            .enumerate()
            .take(i)
            .filter(|f| has_name(f.1.parameter))
        {
            let r = spread.correlation[(i, k)];
            if r.abs() > INSEPARABLE {
                out.push(NotIdentifiable {
                    effect: effect_of(p).or_else(|| effect_of(other.parameter)),
                    joints: place(p),
                    reason: format!(
                        "{} and {} cannot be told apart (correlation {r:.2}): only their combination is known; more of the one with {} \
                         of the other follows the motion as well",
                        say(other.parameter),
                        say(p),
                        if r > 0.0 { "more" } else { "less" }
                    ),
                    finding: Finding::Inseparable,
                    values: vec![own(other.parameter), own(p)],
                });
            }
        }
    }
    while let Some(first) = faint.first().copied() {
        let of_one = |p: &Parameter| p.kind == first.kind && effect_of(*p) == effect_of(first);
        let (same, others): (Vec<Parameter>, Vec<Parameter>) = faint.into_iter().partition(of_one);
        faint = others;
        let values = same.iter().map(|p| own(*p)).collect();
        let joints: Vec<String> = same.iter().flat_map(|p| place(*p)).collect();
        let (name, _) = named(first.kind, true);
        let on = if first.kind.is_common() {
            String::new()
        } else {
            format!(" on {}", joints.join(", "))
        };
        out.push(NotIdentifiable {
            effect: effect_of(first),
            reason: format!(
                "this motion says little of {name}{on}: what was assumed is not halved; move faster, with load and with reversals"
            ),
            joints,
            finding: Finding::Little,
            values,
        });
    }
    out
}
