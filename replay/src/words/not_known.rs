//! What the motion does not determine, in words: pairs of values that share a value are one group.

use crate::schema::{Finding, Named, NotIdentifiable};

/// Lines on what the motion does not determine. Values of which only combinations are known are one line, at the place of the
/// group's first pair.
pub fn not_known(items: &[NotIdentifiable]) -> Vec<String> {
    let mut groups: Vec<Vec<&Named>> = Vec::new();
    let pairs = items.iter().filter(|i| i.finding == Finding::Inseparable);
    for pair in pairs {
        // Groups that the pair joins become one, at the place of the first.
        let (joined, rest): (Vec<_>, Vec<_>) = groups
            .into_iter()
            .partition(|group| pair.values.iter().any(|v| group.contains(&v)));
        let mut group: Vec<&Named> = joined.into_iter().flatten().collect();
        for value in &pair.values {
            if !group.contains(&value) {
                group.push(value);
            }
        }
        groups = rest;
        groups.push(group);
    }
    let mut out = Vec::new();
    for item in items {
        let own = item.values.first();
        let at = groups
            .iter()
            .position(|group| own.is_some_and(|v| group.contains(&v)));
        match at {
            _ if item.finding != Finding::Inseparable => out.push(item.reason.clone()),
            // A pair has words of its own, which say in what direction the two trade.
            Some(at) if groups[at].len() <= 2 => out.push(item.reason.clone()),
            Some(at) => out.push(combination(&groups.remove(at))),
            // Said with the group's first pair.
            None => {}
        }
    }
    out
}

/// Sentence on values of which only combinations are known; those of one joint stand together.
fn combination(group: &[&Named]) -> String {
    let mut by_joint: Vec<(Option<&str>, Vec<&str>)> = Vec::new();
    for value in group {
        let joint = value.joint.as_deref();
        match by_joint.iter_mut().find(|(of, _)| *of == joint) {
            Some((_, names)) => names.push(value.name),
            None => by_joint.push((joint, vec![value.name])),
        }
    }
    let each = by_joint.iter().map(|(joint, names)| {
        let names = listed(names);
        joint.map_or(names.clone(), |j| format!("{names} on {j}"))
    });
    let each: Vec<String> = each.collect();
    format!(
        "{} cannot be told apart: only combinations of them are known",
        each.join("; ")
    )
}

/// Words as a list: "a, b and c".
fn listed(words: &[&str]) -> String {
    match words {
        [rest @ .., last] if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
        _ => words.concat(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn item(finding: Finding, reason: &str, values: &[(&'static str, &str)]) -> NotIdentifiable {
        let named = |&(name, joint): &(&'static str, &str)| Named {
            name,
            joint: (!joint.is_empty()).then(|| joint.to_owned()),
        };
        NotIdentifiable {
            effect: None,
            joints: Vec::new(),
            reason: reason.to_owned(),
            finding,
            values: values.iter().map(named).collect(),
        }
    }

    #[test]
    fn pairs_that_share_a_value_are_one_line() {
        use Finding::{Inseparable, Little};
        let (kp, mass, com) = (("kp", "j2"), ("mass", ""), ("com_x", ""));
        let said = not_known(&[
            item(Inseparable, "kp and mass", &[kp, mass]),
            item(Little, "little of damping", &[("damping", "j2")]),
            item(
                Inseparable,
                "kd and damping",
                &[("kd", "j1"), ("damping", "j1")],
            ),
            item(Inseparable, "mass and com_x", &[mass, com]),
            item(Inseparable, "kp and com_x", &[kp, com]),
        ]);
        assert_eq!(
            said,
            [
                "kp on j2; mass and com_x cannot be told apart: only combinations of them are known",
                "little of damping",
                "kd and damping",
            ]
        );
    }

    #[test]
    fn a_pair_may_join_two_groups() {
        let pair = |a, b| item(Finding::Inseparable, "", &[(a, "j1"), (b, "j1")]);
        let said = not_known(&[pair("a", "b"), pair("c", "d"), pair("b", "c")]);
        assert_eq!(
            said,
            ["a, b, c and d on j1 cannot be told apart: only combinations of them are known"]
        );
    }
}
