//! The headline is guarded: verdict, names and joints of some sealed cases are what they were when somebody last looked.
//!
//! The cases are those of the first plain ones of a seed whose arms have few joints, and some of larger arms, so that the whole is done
//! in a minute or two. Where a change of the search changes an answer on purpose, `RESIDYN_ACCEPT=1 cargo test --release --workspace
//! --test whole headline` writes the file anew; what that changes is read like any other change. `diagnose thresholds --off all
//! --headline proof/tests/whole/headline.json` says which special rules it notices.

use diagnose::Options;
use diagnose::settings::Rule;
use proof::prove::Stored;
use std::path::PathBuf;

/// Rules of which each, switched off alone, changes an answer.
const NOTICED: [Rule; 5] = [
    Rule::PartByEffect,
    Rule::GainByEffect,
    Rule::Leftovers,
    Rule::LastLink,
    Rule::Barred,
];

fn path() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/whole/headline.json")
}

fn fast() -> Options {
    Options {
        surrogates: 0,
        ..Options::default()
    }
}

/// Answers that are others, each as it was and as it is.
fn changed(stored: &Stored, found: &Stored) -> Vec<String> {
    let pairs = stored.cases.iter().zip(&found.cases);
    let others = pairs.filter(|(was, is)| was != is);
    others
        .map(|(was, is)| format!("was {was:?}\n is {is:?}"))
        .collect()
}

#[test]
fn the_headline_is_what_it_was() {
    let stored = Stored::read(&path()).unwrap();
    let found = stored.diagnosed(&fast()).unwrap();
    if std::env::var_os("RESIDYN_ACCEPT").is_some() {
        let text = serde_json::to_string_pretty(&found).unwrap() + "\n";
        std::fs::write(path(), text).unwrap();
        return;
    }
    let changed = changed(&stored, &found);
    assert!(changed.is_empty(), "{}", changed.join("\n"));
}

#[test]
#[ignore = "long: by hand, with --ignored"]
fn a_rule_that_is_switched_off_is_noticed() {
    let stored = Stored::read(&path()).unwrap();
    for rule in NOTICED {
        let off = Options {
            settings: Options::default().settings.without(rule),
            ..fast()
        };
        let changed = changed(&stored, &stored.diagnosed(&off).unwrap());
        println!("{}: {}", rule.name(), changed.len());
        assert!(!changed.is_empty(), "{}", rule.name());
    }
}
