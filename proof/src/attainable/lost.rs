//! Where a first name is lost that can be known: by the diagnosis's order, its search, its thresholds, or the form of its columns.

use super::tables::Pair;
use crate::prove::missed::Missed;
use crate::prove::{Draw, ProveError, judge, report_of, single, specs};
use diagnose::{Choice, Effect, Options};
use rayon::prelude::*;
use report::{Cell, Column, Table};
use trials::cases::generate_with;

/// Step of the diagnosis that loses a name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lost {
    /// Order: the effect is named, but not first.
    Order,
    /// Search: the effect is named where the catalogue has no other but parameters.
    Search,
    /// Rule: the effect is named where, besides, no threshold is above zero.
    Rule,
    /// Form: the effect is named in neither case.
    Form,
}

const ALL: [(Lost, &str); 4] = [
    (Lost::Order, "order: named, not first"),
    (
        Lost::Search,
        "search: named where the catalogue has no other effect",
    ),
    (
        Lost::Rule,
        "rule: named where, besides, no threshold is above zero",
    ),
    (Lost::Form, "form: named in neither case"),
];

/// Options of a diagnosis whose catalogue has one effect, with the thresholds of acceptance at zero if they are not `kept`.
fn alone(effect: Effect, kept: bool, options: &Options) -> Options {
    let mut options = Options {
        effects: Choice::Only(effect),
        ..options.clone()
    };
    if !kept {
        let search = &mut options.settings.search;
        for threshold in [
            &mut search.enough,
            &mut search.leftover,
            &mut search.leftover_same,
            &mut search.visible,
            &mut search.share,
            &mut search.plainly,
            &mut search.late_part,
            &mut search.late_alone,
            &mut search.narrow_part,
        ] {
            *threshold = 0.0;
        }
    }
    options
}

/// Kind of each case with a single effect that the observer names first and the diagnosis does not, and where it is lost. `pairs` are of
/// the cases of the draw, in order.
///
/// # Errors
/// The first case that fails.
pub fn lost(
    wanted: &Draw,
    options: &Options,
    pairs: &[Pair],
    done: impl Fn() + Sync,
) -> Result<Vec<(String, Lost)>, ProveError> {
    let cases: Vec<_> = specs(wanted)?.into_iter().zip(pairs).collect();
    let found = cases.into_par_iter().map(|(spec, (ours, known))| {
        done();
        let (Some(missed), true) = (ours.missed, known.score.top1 == Some(1.0)) else {
            return Ok(None);
        };
        let Some(effect) = single(spec.kind) else {
            return Ok(None);
        };
        let named = |kept: bool| {
            let case = generate_with(&spec, wanted.seed, wanted.sensors)?;
            let found = report_of(&case, &alone(effect, kept, options))?;
            let truth =
                serde_json::to_value(&case.truth).expect("fields with names, numbers and strings");
            Ok::<_, ProveError>(judge(&truth, &found).found == Some(1.0))
        };
        let lost = match missed {
            Missed::InNoLine | Missed::Absorbed | Missed::Alike => match named(true)? {
                true => Lost::Search,
                false if named(false)? => Lost::Rule,
                false => Lost::Form,
            },
            _ => Lost::Order,
        };
        Ok(Some((ours.kind.clone(), lost)))
    });
    let found: Result<Vec<_>, ProveError> = found.collect();
    Ok(found?.into_iter().flatten().collect())
}

/// Names that can be known and are lost, by the step that loses them; none where none is.
pub fn table(lost: &[(String, Lost)]) -> Option<Table> {
    let mut table = Table::new([
        Column::text("lost by"),
        Column::number("cases"),
        Column::text("of them"),
    ]);
    for (step, name) in ALL {
        let mut kinds: Vec<&str> = lost
            .iter()
            .filter(|l| l.1 == step)
            .map(|l| &l.0[..])
            .collect();
        let count = kinds.len();
        kinds.sort_unstable();
        let mut alike: Vec<&[&str]> = kinds.chunk_by(|a, b| a == b).collect();
        alike.sort_by_key(|same| std::cmp::Reverse(same.len()));
        let told = alike
            .iter()
            .map(|same| format!("{} {}", same.len(), same[0]));
        let told: Vec<String> = told.collect();
        table.push([
            Cell::text(name),
            Cell::number(count as f64, 0),
            Cell::text(told.join(", ")),
        ]);
    }
    (!lost.is_empty()).then_some(table)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_counted_by_the_step_that_loses_them() {
        let lost = [
            ("backlash".to_owned(), Lost::Form),
            ("payload".to_owned(), Lost::Form),
            ("backlash".to_owned(), Lost::Form),
            ("payload".to_owned(), Lost::Order),
        ];
        let text = table(&lost).unwrap().to_text();
        let form = text.lines().find(|l| l.starts_with("form")).unwrap();
        assert!(form.contains("2 backlash, 1 payload"), "{text}");
        assert!(table(&[]).is_none());
    }

    #[test]
    fn without_thresholds_other_settings_stay() {
        let options = Options::default();
        let effect = Effect::ALL[0];
        let [kept, none] = [true, false].map(|kept| alone(effect, kept, &options));
        assert_eq!(kept.effects, Choice::Only(effect));
        assert_eq!(kept.settings.search.enough, options.settings.search.enough);
        assert_eq!(
            (none.settings.search.enough, none.settings.search.visible),
            (0.0, 0.0)
        );
        assert_eq!(none.settings.search.cost, options.settings.search.cost);
    }
}
