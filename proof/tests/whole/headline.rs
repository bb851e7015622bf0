//! The headline is guarded: verdict, names and joints of some sealed cases are what they were when somebody last looked.
//!
//! The cases are from the ablation of the special rules (docs/diagnosis-proof.md): arms of three and four joints, six cases hard, so
//! chosen that each of the strongest rules changes an answer when it is switched off. They guard against change and are no measure of
//! accuracy. Where a change of the search changes an answer on purpose, `RESIDYN_ACCEPT=1 cargo test --release --workspace
//! --test whole headline` writes the file anew; what that changes is read like any other change. `diagnose thresholds --off all
//! --headline proof/tests/whole/headline.json` says which special rules it notices.

use diagnose::Options;
use proof::prove::Stored;
use std::path::PathBuf;

fn path() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/whole/headline.json")
}

#[test]
fn the_headline_is_what_it_was() {
    let stored = Stored::read(&path()).unwrap();
    let fast = Options {
        surrogates: 0,
        ..Options::default()
    };
    let found = stored.diagnosed(&fast).unwrap();
    if std::env::var_os("RESIDYN_ACCEPT").is_some() {
        let text = serde_json::to_string_pretty(&found).unwrap() + "\n";
        std::fs::write(path(), text).unwrap();
        return;
    }
    let pairs = stored.cases.iter().zip(&found.cases);
    let changed = pairs.filter(|(was, is)| was != is);
    let changed: Vec<String> = changed
        .map(|(was, is)| format!("was {was:?}\n is {is:?}"))
        .collect();
    assert!(changed.is_empty(), "{}", changed.join("\n"));
}
