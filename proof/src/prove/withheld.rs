//! Leave-one-out: the candidate of a case's effect is taken out of the catalogue. The answer must then be that something
//! unknown is there, or a confounder that the catalogue states; a confident wrong name is the failure.

use diagnose::Effect;
use report::{Cell, Column, Table};
use serde_json::Value;

/// Result of a diagnosis whose catalogue lacks the right candidate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Instead {
    /// Answer with the verdict `unknown_effect`.
    Unknown,
    /// Answer whose first structural cause is a stated confounder.
    Confounder,
    /// Answer without a structural cause: parameters absorbed the effect, or it is too small.
    Parameters,
    /// Wrong name, ahead of all others by at least `CLEAR` and without a rival that is a confounder.
    Wrong,
    /// Wrong name that leads by less than `CLEAR`, or with a confounder as rival.
    Doubtful,
}

/// Lead in evidence over other names from which a name counts as stated, nats.
const CLEAR: f64 = 11.0;

/// Result of one case whose effect is out of the catalogue.
#[derive(Clone, Copy, Debug)]
pub struct LeftOut {
    /// Effect that was withheld and taken out.
    pub effect: Effect,
    /// Kind of answer of the diagnosis.
    pub answer: Instead,
}

/// Judges a report against a withheld effect.
pub fn judge(effect: Effect, truth: &Value, report: &Value) -> LeftOut {
    let causes = report["causes"].as_array().map_or(&[][..], Vec::as_slice);
    let first = causes.iter().find(|c| c["kind"] == "structure");
    let stated = effect.info().confounders.iter().map(|e| e.name());
    let fair: Vec<&str> = stated.chain(indistinguishable(truth)).collect();
    let named = |c: &Value| c["effect"].as_str().is_some_and(|e| fair.contains(&e));
    let rivals = |c: &Value| {
        let list = c["ambiguous_with"].as_array();
        list.into_iter()
            .flatten()
            .any(|e| e.as_str().is_some_and(|e| fair.contains(&e)))
    };
    let answer = match first {
        _ if report["verdict"] == "unknown_effect" => Instead::Unknown,
        None => Instead::Parameters,
        Some(c) if named(c) || rivals(c) => Instead::Confounder,
        Some(c) if c["lead"].as_f64().is_none_or(|l| l >= CLEAR) => Instead::Wrong,
        Some(_) => Instead::Doubtful,
    };
    LeftOut { effect, answer }
}

fn indistinguishable(truth: &Value) -> impl Iterator<Item = &str> {
    let effects = truth["effects"].as_array().into_iter().flatten();
    effects
        .flat_map(|e| e["indistinguishable"].as_array().into_iter().flatten())
        .filter_map(Value::as_str)
}

/// Answers by withheld effect, and all together.
pub fn table(cases: &[LeftOut]) -> Table {
    const ANSWERS: [(Instead, &str); 5] = [
        (Instead::Unknown, "unknown"),
        (Instead::Confounder, "confounder"),
        (Instead::Parameters, "parameters"),
        (Instead::Doubtful, "doubtful"),
        (Instead::Wrong, "wrong name"),
    ];
    let mut columns = vec![Column::text("withheld"), Column::number("cases")];
    columns.extend(ANSWERS.map(|(_, name)| Column::number(name)));
    let mut table = Table::new(columns);
    let mut push = |name: &str, of: Vec<&LeftOut>| {
        let count = |a: Instead| of.iter().filter(|c| c.answer == a).count() as f64;
        let mut cells = vec![Cell::text(name), Cell::number(of.len() as f64, 0)];
        cells.extend(ANSWERS.map(|(a, _)| Cell::number(count(a), 0)));
        table.push(cells);
    };
    for effect in Effect::ALL {
        let of: Vec<&LeftOut> = cases.iter().filter(|c| c.effect == effect).collect();
        if !of.is_empty() {
            push(effect.name(), of);
        }
    }
    push("all", cases.iter().collect());
    table.emphasise_last()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_confident_wrong_name_is_the_failure() {
        let truth = json!({"effects": [{"indistinguishable": []}]});
        let report = |verdict: &str, effect: &str, lead: f64| {
            json!({"verdict": verdict, "causes": [
                {"effect": "friction_parameters", "kind": "parameter", "lead": null},
                {"effect": effect, "kind": "structure", "lead": lead, "ambiguous_with": []}]})
        };
        let answer = |r: &Value| judge(Effect::Backlash, &truth, r).answer;
        assert_eq!(
            answer(&report("unknown_effect", "payload", 99.0)),
            Instead::Unknown
        );
        assert_eq!(
            answer(&report("explained", "joint_elasticity", 99.0)),
            Instead::Confounder
        );
        assert_eq!(
            answer(&report("explained", "payload", 20.0)),
            Instead::Wrong
        );
        assert_eq!(
            answer(&report("explained", "payload", 3.0)),
            Instead::Doubtful
        );
        assert_eq!(
            answer(&json!({"verdict": "no_gap", "causes": []})),
            Instead::Parameters
        );
    }
}
