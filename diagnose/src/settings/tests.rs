//! The table in the documentation says what the code does.

use super::*;

const DOCUMENT: &str = include_str!("../../../docs/diagnosis-proof.md");

/// Every group with its place among the settings.
const GROUPS: [(&str, &[[&str; 4]]); 13] = [
    ("motion", MotionSettings::FIELDS),
    ("input", InputSettings::FIELDS),
    ("traces.contact", ContactSettings::FIELDS),
    ("traces.blows", BlowSettings::FIELDS),
    ("traces.structure", StructureSettings::FIELDS),
    ("search", SearchSettings::FIELDS),
    ("ladder", LadderSettings::FIELDS),
    ("measure.verdict", VerdictSettings::FIELDS),
    ("measure.confidence", ConfidenceSettings::FIELDS),
    ("measure.resonance", ResonanceSettings::FIELDS),
    ("measure.said", SaidSettings::FIELDS),
    ("measure.other_day", OtherDaySettings::FIELDS),
    ("advice", AdviceSettings::FIELDS),
];

/// Rows of the table as the code has them: source, row.
fn rows() -> Vec<(&'static str, String)> {
    let of = |&(group, fields): &(&'static str, &'static [[&'static str; 4]])| {
        fields.iter().map(move |[name, default, source, meaning]| {
            let meaning = meaning.trim().trim_end_matches('.');
            let row = format!("| `{group}.{name}` | {default} | {meaning} | {source} |");
            (*source, row)
        })
    };
    GROUPS.iter().flat_map(of).collect()
}

#[test]
fn the_documented_thresholds_are_the_codes_and_no_contract_is_missing() {
    let rows = rows();
    let (_, section) = DOCUMENT.split_once("\n## Thresholds\n").unwrap();
    let section = section.split("\n## ").next().unwrap();
    let documented: Vec<&str> = section.lines().filter(|l| l.starts_with("| `")).collect();
    for row in &documented {
        assert!(
            rows.iter().any(|(_, r)| r == row),
            "not what the code says: {row}"
        );
    }
    for (_, row) in rows.iter().filter(|(source, _)| *source == "contract") {
        assert!(documented.contains(&row.as_str()), "not documented: {row}");
    }
}

#[test]
fn every_number_can_be_scaled_by_its_name() {
    let settings = Settings::default();
    for (group, fields) in GROUPS {
        for [name, ..] in fields {
            assert!(
                settings.scaled(&format!("{group}.{name}"), 2.0).is_some(),
                "{group}.{name}"
            );
        }
    }
    let halved = settings.scaled("search.enough", 0.5).unwrap();
    assert_eq!(halved.search.enough, 0.5 * settings.search.enough);
    assert_eq!(halved.search.cost, settings.search.cost);
    assert!(settings.scaled("search.nothing", 2.0).is_none());
}
